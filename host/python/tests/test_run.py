"""Runs: their channels, their figures, and what is known of how far they can be trusted."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest

import pneudrive
from pneudrive import Rig, Run


def test_channels_are_read_only_arrays_in_the_memory_of_the_run(run: Run) -> None:
    position = run["position_m"]
    assert position.dtype == np.float64
    assert position is run["position_m"]
    assert not position.flags.owndata
    with pytest.raises(ValueError, match="read-only"):
        position[0] = 0
    assert list(run) == run.keys() == list(dict(run))
    assert len(run) == len(run.values()) == 18
    assert "position_m" in run
    with pytest.raises(KeyError, match="there is no column position; there are time_s, setpoint_counts"):
        run["position"]


def test_columns_are_those_of_trace_csv(run: Run, tmp_path: Path) -> None:
    assert run.save(tmp_path / "run") == 1
    trace = np.genfromtxt(tmp_path / "run" / "trace.csv", delimiter=",", names=True)
    assert trace.dtype.names == tuple(run.keys())
    for name in run:
        assert np.allclose(trace[name], run[name], rtol=1e-11, atol=0), name
    for name in ("run.json", "band.csv", "report.html"):
        assert (tmp_path / "run" / name).exists()


def test_a_run_of_another_rig_is_replaced_only_when_told(run: Run, tmp_path: Path) -> None:
    run.save(tmp_path)
    other = Rig("servo-a", test__duration_s=0.1).simulate(ensemble=1)
    with pytest.raises(pneudrive.PneudriveError, match="servo-b-tuned"):
        other.save(tmp_path)
    assert other.save(tmp_path, overwrite=True) == 2


def test_figures_are_ranges_over_the_run_and_its_perturbed_runs(run: Run) -> None:
    last = run.moves[-1]
    assert (last.number, run.ensemble) == (len(run.moves), 8)
    figure = last.ends_at_mm
    assert figure.least is not None and figure.value is not None and figure.most is not None
    assert figure.least <= figure.value <= figure.most
    assert (figure.runs, figure.runs_without) == (8, 0)
    assert "settled_s" in dir(last)
    assert last.to_dict()["ends_at_mm"] == figure.value
    with pytest.raises(AttributeError, match="a move has no figure settle_s; it has begins_s"):
        last.settle_s
    assert set(run.band) >= {"position_m", "pressure_1_pa"}
    low, high = run.band["position_m"]
    assert np.all(low <= run["position_m"]) and np.all(run["position_m"] <= high)


def test_a_run_says_whether_it_is_converged(run: Run) -> None:
    assert run.convergence is not None
    assert bool(run.convergence) == run.convergence.is_converged
    assert run.convergence.error_m < 1e-5
    assert str(run.convergence) in run.notes


def test_a_run_alone_says_what_it_does_not_know(rig: Rig, run: Run) -> None:
    alone = rig.simulate(ensemble=1, check_convergence=False)
    assert alone.convergence is None
    assert "nobody asked whether it has converged" in alone.notes[1]
    assert alone.band == {}
    figure = alone.moves[-1].ends_at_mm
    assert (figure.runs, figure.least, figure.most) == (1, None, None)
    for name in run:
        assert np.array_equal(alone[name], run[name]), name
    with pytest.raises(ValueError, match="simulate with check_convergence=True"):
        alone.save(Path("nowhere"))


def test_columns_of_the_valve_are_added_when_asked_for(rig: Rig, run: Run) -> None:
    more = rig.simulate(ensemble=1, columns=["port_pressure_1_pa"])
    assert list(more)[-1] == "port_pressure_1_pa"
    assert np.array_equal(more["position_m"], run["position_m"])
    with pytest.raises(ValueError, match="columns: there is no pressure; there are port_pressure_1_pa"):
        rig.simulate(columns=["pressure"])


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"ensemble": 0}, "ensemble must be between 1 and 1000 runs, is 0"),
        ({"tolerance": float("nan")}, "tolerance must be between 1e-13 and 1e-2, is NaN"),
        ({"method": "euler"}, 'method must be "dormand-prince" or "merson", is "euler"'),
    ],
)
def test_a_wrong_keyword_is_refused(rig: Rig, keywords: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        rig.simulate(**keywords)  # type: ignore[arg-type]


def test_other_threads_go_on_while_a_run_lasts() -> None:
    long = Rig("servo-b-tuned", test__duration_s=20.0)
    counted, done = 0, threading.Event()

    def work() -> None:
        long.simulate(ensemble=1, check_convergence=False)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        counted += 1
        time.sleep(0.001)
    thread.join()
    assert counted > 10


def test_progress_is_told_to_its_end_and_its_exception_ends_the_run() -> None:
    long = Rig("servo-b-tuned", test__duration_s=5.0)
    told: list[tuple[int, int]] = []
    long.simulate(ensemble=2, progress=lambda done, all_: told.append((done, all_)))
    assert told == sorted(told)
    assert told[-1][0] == told[-1][1]

    class Enough(Exception):
        pass

    def refuse(done: int, all_: int) -> None:
        raise Enough

    begun = time.monotonic()
    with pytest.raises(Enough):
        long.with_(test__duration_s=600.0).simulate(progress=refuse)
    assert time.monotonic() - begun < 5


def test_control_c_ends_a_long_run() -> None:
    import _thread

    long = Rig("servo-b-tuned", test__duration_s=600.0)
    threading.Timer(0.3, _thread.interrupt_main).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        long.simulate()
    assert time.monotonic() - begun < 10


def test_a_trip_is_told_with_its_meaning() -> None:
    run = Rig({"faults.event": [{"kind": "encoder-jump", "at_s": 0.1}], "test.duration_s": 0.3}).simulate(ensemble=1)
    assert run.trip is not None
    assert run.trip.fault == "encoder-step"
    assert run.trip.sample > 0
    assert run.trip.meaning


def test_a_pressure_that_is_not_measured_is_no_number() -> None:
    with_sensors, without = (
        Rig("servo-b-tuned", sensors__pressure=measured, test__duration_s=1.0).simulate(ensemble=1, check_convergence=False).samples
        for measured in (True, False)
    )
    for name in ("pressure_1_raw", "pressure_2_raw"):
        assert with_sensors[name].dtype == np.int32
        assert len(without[name]) == len(with_sensors[name]) > 0
        assert np.isnan(without[name]).all()
    for name in ("position_counts", "command_counts"):
        assert np.array_equal(without[name], with_sensors[name]), name
