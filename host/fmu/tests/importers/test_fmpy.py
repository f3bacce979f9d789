"""FMUs in FMPy: valid, and the same integers as `pneudrive simulate`."""

import fmpy
import numpy as np
import pytest
from conftest import PERIOD_S
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

PARTS = ["plant", "controller", "drive"]
VERSIONS = ["2.0", "3.0"]
SENSORS = ["position_counts", "pressure_1_raw", "pressure_2_raw", "spool_raw", "home_switch"]
RIGS = ["servo-b-tuned", "servo-a-tuned", "bang-bang"]


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("rig", RIGS)
def test_each_part_is_valid(fmu, rig, part, version):
    assert validate_fmu(str(fmu(rig, part, version))) == []


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("part", PARTS)
def test_each_part_is_simulated_as_it_is(fmu, part, version):
    result = fmpy.simulate_fmu(str(fmu("servo-b-tuned", part, version)))
    # FMPy chooses a step itself, a multiple of the one in the description.
    samples = np.diff(result["time"]) / PERIOD_S
    assert len(samples) > 500 and result["time"][-1] > 3.0
    assert np.abs(samples - np.round(samples)).max() < 1e-6


def test_both_versions_of_the_standard_give_the_same_run(fmu):
    older, newer = (
        fmpy.simulate_fmu(
            str(fmu("servo-b-tuned", "drive", version)),
            start_values={"run_test": True, "load.mass_kg": 8.0},
            output=["position_m", "pressure_1_pa", "command_counts", "velocity_estimate", "running"],
            step_size=PERIOD_S,
            output_interval=PERIOD_S,
            stop_time=1.3,
        )
        for version in VERSIONS
    )
    assert len(newer) > 900
    for name in newer.dtype.names:
        assert (older[name] == newer[name]).all(), name
    assert np.ptp(newer["position_m"]) > 0.05


@pytest.mark.parametrize("rig", RIGS)
def test_controller_and_plant_in_a_loop_equal_the_simulation_in_every_integer(instance, trace, rig):
    plant = instance(rig, "plant").start()
    controller = instance(rig, "controller", run_test=True).start()
    period_s = plant.description.defaultExperiment.stepSize
    rows = trace(rig)
    assert len(rows) > 1000
    for k, row in enumerate(rows):
        assert plant["position_counts"] == row["position_counts"], k
        for name in SENSORS:
            controller[name] = plant[name]
        controller.slave.doStep(k * float(period_s), float(period_s))
        for seen, recorded in [
            ("setpoint_in_force_counts", "setpoint_counts"),
            ("error_counts", "error_counts"),
            ("command_counts", "command_counts"),
        ]:
            assert controller[seen] == row[recorded], (k, seen)
        for name in ["command_counts", "step"]:
            if name in plant.variables:
                plant[name] = controller[name]
        plant.slave.doStep(k * float(period_s), float(period_s))


def test_the_drive_equals_the_simulation_in_its_physical_values(instance, trace):
    drive = instance("servo-b-tuned", "drive", run_test=True).start()
    for k, row in enumerate(trace("servo-b-tuned")):
        # trace.csv rounds to the digits that it shows.
        for name in ["position_m", "velocity_m_s", "pressure_1_pa", "pressure_2_pa", "spool_mm"]:
            assert drive[name] == pytest.approx(row[name], rel=1e-6, abs=1e-9), (k, name)
        drive.step(k)


def test_the_drive_goes_where_its_input_says(instance):
    drive = instance("servo-b-tuned", "drive").start()
    drive["setpoint_m"] = 0.12
    drive.step(0, 1500)
    # The tuned rigs settle within 1 mm (docs/explanation/rigs.md).
    assert drive["position_m"] == pytest.approx(0.12, abs=1e-3)


def test_a_state_that_was_kept_comes_back(instance):
    drive = instance("servo-b-tuned", "drive", run_test=True).start()
    drive.step(0, 200)
    state = drive.slave.getFMUState()
    drive.step(200, 50)
    first = drive["position_m"], drive["command_counts"]
    drive.slave.setFMUState(state)
    assert drive["time"] == 200 * PERIOD_S
    drive.step(200, 50)
    assert (drive["position_m"], drive["command_counts"]) == first
    drive.slave.freeFMUState(state)


def test_what_cannot_be_is_an_exception_with_a_message_and_python_lives_on(instance):
    drive = instance("servo-b-tuned", "drive")
    with pytest.raises(FMICallException):
        drive["position_m"]
    assert "cannot be asked for position_m now" in drive.log[-1]
    for name, value, says in [
        ("load.mass_kg", float("nan"), "load.mass_kg must be a finite number"),
        ("load.mass_kg", -2.0, "load.mass_kg must be between"),
    ]:
        with pytest.raises(FMICallException):
            drive[name] = value
        assert says in drive.log[-1]
    drive.start()
    with pytest.raises(FMICallException):
        drive.slave.doStep(0.0, -0.001)
    assert "a step must last more than 0 s" in drive.log[-1]
    with pytest.raises(FMICallException):
        drive["actuator.bore_m"] = 0.05
    assert "actuator.bore_m is fixed" in drive.log[-1]
    with pytest.raises(FMICallException):
        drive["setpoint_m"] = float("nan")
    with pytest.raises(FMICallException):
        drive.slave.getFloat64([77_777])
    other = instance("servo-b-tuned", "drive").start()
    with pytest.raises(FMICallException):
        other.slave.setFMUState(drive.slave.getFMUState())
    assert "not one that this instance keeps" in other.log[-1]
    drive.step(0)


def test_a_parameter_is_the_key_of_its_name(instance):
    light = instance("servo-b-tuned", "plant", load__mass_kg=1.0).start()
    heavy = instance("servo-b-tuned", "plant", load__mass_kg=40.0).start()
    for plant in (light, heavy):
        plant["command_counts"] = 1000
        plant.step(0, 40)
    assert heavy["velocity_m_s"] < light["velocity_m_s"]
