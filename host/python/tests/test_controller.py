"""The controller alone and the plant alone, in a loop written in Python."""

import pickle

import numpy as np
import pytest

import pneudrive
from pneudrive import Command, Controller, Plant, Rig, Sample


@pytest.mark.parametrize("name", pneudrive.builtin_rigs())
def test_a_loop_in_python_repeats_every_integer_of_the_simulation(name: str) -> None:
    rig = Rig(name, test__duration_s=0.4)
    expected = rig.simulate(ensemble=1, check_convergence=False).samples
    controller, plant = Controller(rig), Plant(rig)
    sample, seen = plant.sample(), []
    for _ in expected["index"]:
        command = controller.step(sample)
        seen.append(controller.observation)
        sample = plant.advance(command)
    for column in ("position_counts", "setpoint_counts", "error_counts", "command_counts", "velocity"):
        assert np.array_equal([one[column] for one in seen], expected[column]), column


def test_modes_faults_and_refusals(rig: Rig) -> None:
    controller = Controller(rig, start=False)
    assert (controller.mode, controller.fault) == ("disarmed", None)
    with pytest.raises(pneudrive.Refused, match="not armed"):
        controller.start()
    controller.reference(8192)
    controller.arm()
    with pytest.raises(pneudrive.Refused, match="disarm it first"):
        controller.reference(0)
    controller.start()
    for _ in range(3):
        controller.step(Sample(8192, 1600, 1600, 2048))
    assert controller.mode == "running"
    command = controller.step(Sample(100_000, 1600, 1600, 2048))
    assert (controller.mode, controller.fault) == ("fault", "encoder-step")
    assert command == Command(0, drive_enable=False)
    controller.arm()
    assert controller.mode == "armed"
    controller.stop()
    assert controller.fault == "stop"


@pytest.mark.parametrize("position", [1.5, "8192", None, float("nan"), np.float64(8192)])
def test_a_sample_is_of_whole_numbers(position: object) -> None:
    with pytest.raises(TypeError):
        Sample(position)  # type: ignore[arg-type]


def test_a_number_that_the_hardware_cannot_have_is_refused(rig: Rig) -> None:
    with pytest.raises(OverflowError):
        Sample(2**31)
    with pytest.raises(OverflowError):
        Sample(0, pressure_1=2**15)
    with pytest.raises(ValueError, match="counts must be between -2048 and 2048"):
        Command(2049)
    with pytest.raises(TypeError):
        Controller(rig).step(8192)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="the continuous controller is the simulator's own"):
        Controller(rig.with_(controller__model="continuous"))


def test_numbers_of_numpy_are_whole_numbers() -> None:
    assert Sample(np.int32(8192), np.int16(7)) == Sample(8192, 7)


def test_the_state_of_the_plant_is_that_of_the_run(rig: Rig) -> None:
    rig = rig.with_(test__duration_s=0.1)
    run = rig.simulate(ensemble=1, check_convergence=False)
    controller, plant = Controller(rig), Plant(rig)
    assert plant.state["position_m"] == rig.test.position_m
    sample = plant.sample()
    for _ in run.samples["index"][:-1]:
        sample = plant.advance(controller.step(sample))
    time_s, position = run["time_s"], run["position_m"]
    assert plant.state["position_m"] == pytest.approx(np.interp(plant.state["time_s"], time_s, position), abs=1e-9)


def test_samples_and_commands_are_pickled() -> None:
    for one in (Sample(1, 2, 3, 4, True), Command(5, -1, False)):
        assert pickle.loads(pickle.dumps(one)) == one
