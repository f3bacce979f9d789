"""A plant about a state as a linear system, against the plant itself."""

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray

from pneudrive import Command, LinearModel, Plant, Rig

PERIOD_S, DELAY_S = 1e-4, 2e-5

# A spool without what no linear model has.
SMOOTH = {
    "operator.dither_mm": 0,
    "operator.hysteresis_percent": 0,
    "operator.static_friction_n": 0,
    "operator.coulomb_friction_n": 0,
    "controller.period_s": PERIOD_S,
    "controller.delay_s": DELAY_S,
}


def moving(model: str) -> Plant:
    """A plant whose load is on its way."""
    plant = Plant(Rig("servo-b-tuned", operator__model=model).with_(SMOOTH), tolerance=1e-12)
    plant.advance(Command(300), 600)
    return plant


def predicted(model: LinearModel, step: float, samples: int) -> NDArray[np.float64]:
    """The outputs some samples after a step of the command, which acts a delay after the first."""
    n = len(model.states)

    def after(input_: float, time_s: float) -> NDArray[np.float64]:
        rates = np.block([[model.A, (model.rates + input_ * model.B[:, 0])[:, None]], [np.zeros((1, n + 1))]])
        return np.asarray(scipy.linalg.expm(time_s * rates))

    state = (after(step, samples * PERIOD_S - DELAY_S) @ after(0, DELAY_S))[:n, n]
    return np.asarray(model.output + model.C @ state + step * model.D[:, 0])


@pytest.mark.parametrize("operator", ["solenoid", "solenoid-empirical"])
def test_the_plant_leaves_its_linear_model_in_third_order_of_the_time(operator: str) -> None:
    """The state goes like x0 + x' t + x'' t^2/2; A and B are in x'', so that it is exact, too. Half of the time leaves an
    eighth of the deviation, or less."""
    plant = moving(operator)
    model = plant.linearise()
    rows = plant.copy().advance(Command(350), 16)
    samples = (16, 8, 4)
    seen = [[rows[name][k - 1] for name in model.outputs] for k in samples]
    deviations = np.abs([predicted(model, 50, k) for k in samples] - np.array(seen))
    of_states = [model.outputs.index(name) for name in model.outputs if name in model.states and name != "spool_mm"]
    assert np.all(deviations[1:, of_states] < deviations[:-1, of_states] / 7)
    # An output is exact in first order.
    assert np.all(deviations[2] <= deviations[0] / 4 + 1e-14)


def test_a_linear_model_is_about_the_present_state() -> None:
    plant = moving("solenoid")
    before, model = plant.state, plant.linearise()
    assert plant.state == before, "looking changes nothing"
    # The flows of a state are slopes of the integration's masses.
    expected = {name: before[name] for name in model.outputs}
    assert dict(zip(model.outputs, model.output)) == pytest.approx(expected, rel=1e-7)
    assert dict(zip(model.states, model.state))["position_m"] == before["position_m"]
    assert model.rates[:2] == pytest.approx([before["velocity_m_s"], before["acceleration_m_s2"]], rel=1e-9)
    assert model.input == [300]


def test_matrices_have_the_shapes_of_the_names() -> None:
    model = moving("solenoid").linearise()
    n, outputs = len(model.states), len(model.outputs)
    A, B, C, D = model
    assert (A.shape, B.shape, C.shape, D.shape) == ((n, n), (n, 1), (outputs, n), (outputs, 1))
    assert all(np.array_equal(one, other) for one, other in zip(model, (model.A, model.B, model.C, model.D)))
    assert C[model.outputs.index("position_m")] == pytest.approx([1, *[0] * (n - 1)], abs=1e-10)
    assert A[0] == pytest.approx([0, 1, *[0] * (n - 2)], abs=1e-10), "position' is velocity"
    assert (model.inputs, model.states[-2:]) == (["command_counts"], ["spool_mm", "spool_velocity_mm_s"])


def test_states_are_those_of_the_rig() -> None:
    def states(rig: Rig) -> list[str]:
        return Plant(rig).linearise().states[6:]

    assert states(Rig("servo-a-tuned")) == []
    lagging = Rig("servo-a-tuned", tubing__lag_s=0.003, sensors__pressure_lag_s=0.004, load__friction="lugre")
    tubes = ["supply_tube_ratio", "tube_1_ratio", "tube_2_ratio"]
    sensors = ["sensed_pressure_1_pa", "sensed_pressure_2_pa"]
    assert states(lagging) == [*tubes, *sensors, "bristle_deflection_m", "film_thickness"]


def test_a_stepper_takes_its_spool_along_at_once() -> None:
    rig = Rig("servo-a-tuned")
    model = Plant(rig).linearise()
    assert model.D[model.outputs.index("spool_mm"), 0] == pytest.approx(rig.operator.mm_per_step)


def test_a_held_load_is_linearised_as_one_that_slips() -> None:
    plant = Plant(Rig("servo-b-tuned"))
    model = plant.linearise()
    assert model.rates[1] == plant.state["acceleration_m_s2"] == 0
    area_m2 = np.pi / 4 * plant.rig.actuator.bore_m**2
    assert model.A[1, 2] == pytest.approx(area_m2 / plant.rig.load.mass_kg, rel=1e-6)


def test_an_on_off_valve_has_no_linear_model() -> None:
    with pytest.raises(ValueError, match="no linear model of a spool that is stuck, or of an on-off valve"):
        Plant(Rig("bang-bang")).linearise()
