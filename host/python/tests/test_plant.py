"""The plant as a value: kept, restored, copied, sent to another process, and many of them at once."""

import copy
import pickle
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import pneudrive
from pneudrive import Command, Controller, Plant, Rig, Sample

# What a plant remembers: noise, lagged sensors and tubes, bristles, a converter that reads in turn, a dead time.
REMEMBERING = {
    "sensors.noise_counts": 1.0,
    "sensors.pressure_lag_s": 0.004,
    "sensors.channel_skew_s": 2e-5,
    "tubing.lag_s": 0.003,
    "load.friction": "lugre",
}


@pytest.fixture(params=[*pneudrive.builtin_rigs(), "remembering"])
def any_rig(request: pytest.FixtureRequest) -> Rig:
    return Rig("servo-b-tuned").with_(REMEMBERING) if request.param == "remembering" else Rig(request.param)


def commands(seed: int, rig: Rig, n: int) -> Iterator[Command]:
    """Commands that change now and then."""
    random, is_stepper = np.random.default_rng(seed), rig.operator.model == "stepper"
    counts = np.repeat(random.integers(-30 if is_stepper else -900, 30 if is_stepper else 900, n), 7)[:n]
    for k in range(n):
        yield Command(counts[k], int(random.integers(-1, 2)) if is_stepper else 0)


def course(plant: Plant, seed: int, n: int = 60) -> list[tuple[Sample, dict[str, float]]]:
    """What is seen of a plant that goes on."""
    return [(plant.advance(command), plant.state) for command in commands(seed, plant.rig, n)]


def test_a_restored_plant_goes_on_in_every_bit(any_rig: Rig) -> None:
    plant = Plant(any_rig, seed=3)
    course(plant, 1)
    kept, copies = plant.copy(), [copy.copy(plant), copy.deepcopy(plant), pickle.loads(pickle.dumps(plant))]
    expected = course(plant, 2)
    assert [course(other, 2) for other in copies] == [expected] * 3
    plant.restore(kept)
    assert course(plant, 2) == expected
    other = Plant(any_rig)
    other.restore(kept)
    assert course(other, 2) == expected


def test_a_reset_plant_is_a_new_one(any_rig: Rig) -> None:
    plant = Plant(any_rig, seed=3)
    first, begun = course(plant, 1), Plant(any_rig, seed=3).sample()
    assert plant.reset() == begun
    assert course(plant, 1) == first
    assert plant.reset(seed=4) == Plant(any_rig, seed=4).sample()


def test_looking_at_a_plant_changes_nothing(any_rig: Rig) -> None:
    seen, unseen = Plant(any_rig, seed=3), Plant(any_rig, seed=3)
    for command in commands(1, any_rig, 60):
        before = seen.sample()
        assert (seen.sample(), seen.copy().state) == (before, seen.state)
        assert seen.advance(command) == unseen.advance(command)
    assert seen.state == unseen.state


def test_many_samples_at_once_are_those_of_one_by_one(any_rig: Rig) -> None:
    at_once, one_by_one = Plant(any_rig, seed=3), Plant(any_rig, seed=3)
    command = Command(20)
    rows = at_once.advance(command, 50)
    seen = [(one_by_one.advance(command), one_by_one.state) for _ in range(50)]
    for name in one_by_one.state:
        assert np.array_equal(rows[name], [state[name] for _, state in seen]), name
    readings = ("position_counts", "pressure_1_raw", "pressure_2_raw", "spool_raw")
    samples = [(sample.position, sample.pressure_1, sample.pressure_2, sample.spool) for sample, _ in seen]
    assert np.array_equal(np.column_stack([rows[name] for name in readings]), samples)
    assert at_once.state == one_by_one.state


def test_plants_side_by_side_go_as_each_alone() -> None:
    rigs = [Rig("servo-b-tuned"), Rig("servo-b-tuned", load__mass_kg=3), Rig("servo-a-tuned")]
    counts = np.random.default_rng(1).integers(-40, 41, (3, 30))
    pulses = np.sign(counts)
    together, alone = [Plant(rig) for rig in rigs], [Plant(rig) for rig in rigs]
    columns = pneudrive.advance(together, counts, steps=pulses)
    for i, plant in enumerate(alone):
        for k in range(30):
            plant.advance(Command(counts[i, k], pulses[i, k]))
            for name, value in plant.state.items():
                assert columns[name][i, k] == value, (name, i, k)
    assert columns["position_counts"].shape == (3, 30)
    assert [plant.state for plant in together] == [plant.state for plant in alone]
    assert pneudrive.advance([], [])["time_s"].shape == (0, 0)


def test_what_no_plant_can_do_is_refused(rig: Rig) -> None:
    plants = [Plant(rig), Plant(rig)]
    with pytest.raises(ValueError, match="a row for each of 2 plants"):
        pneudrive.advance(plants, [[1, 2]])
    with pytest.raises(ValueError, match="all of one length"):
        pneudrive.advance(plants, [[1, 2], [3]])
    with pytest.raises(ValueError, match="all of one length"):
        pneudrive.advance(plants, [[1, 2], [3, 4]], steps=[[0, 0], [0]])
    with pytest.raises(ValueError, match="counts must be between -2048 and 2048"):
        pneudrive.advance(plants, [[1], [2049]])
    with pytest.raises(TypeError):
        pneudrive.advance(plants, np.zeros((2, 3)))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="plant 1 is there twice"):
        pneudrive.advance([plants[0], plants[0]], [[1], [2]])
    with pytest.raises(ValueError, match="of the same rig, tolerance and method"):
        plants[0].restore(Plant(rig, tolerance=1e-8))
    with pytest.raises(ValueError, match="of the same rig, tolerance and method"):
        plants[0].restore(Plant(rig.with_(load__mass_kg=5)))
    assert [plant.state["time_s"] for plant in plants] == [0, 0]


def _advanced(plant: Plant) -> tuple[Sample, dict[str, float]]:
    return plant.advance(Command(100)), plant.state


def test_a_plant_goes_on_in_another_process(rig: Rig) -> None:
    plant, controller = Plant(rig), Controller(rig)
    sample = plant.sample()
    for _ in range(100):
        sample = plant.advance(controller.step(sample))
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        assert pool.submit(_advanced, plant).result() == _advanced(plant)


def test_a_plant_of_another_version_is_refused(rig: Rig) -> None:
    make, (*parts, sample) = Plant(rig).__reduce__()
    assert make(*parts, sample).sample() == sample
    with pytest.raises(ValueError, match="by another version of pneudrive"):
        make(*parts, Sample(sample.position + 1))
