"""Overlays, evaluations, sweeps, fits and tunings."""

from pathlib import Path

import numpy as np
import pytest

import pneudrive
from conftest import ROOT
from pneudrive import Rig, Run, Target, Transient

SWEEP = ROOT / "docs" / "examples" / "sweep-load.toml"


def test_a_record_has_the_columns_of_its_file(fixtures: Path, target: Target) -> None:
    lines = (fixtures / "TARGET-1.DAT").read_text().splitlines()
    header = [line for line in lines if line.startswith("#")]
    data = np.array([line.split(",") for line in lines[len(header) + 1 :]], dtype=int)
    assert len(target.header) == len(header)
    file_order = ["index", "position_counts", "pressure_1_raw", "pressure_2_raw", "command_counts", "error_counts", "spool_raw"]
    assert sorted(target) == sorted(file_order)
    for column, name in enumerate(file_order):
        assert target[name].dtype == np.int32
        assert np.array_equal(target[name], data[:, column]), name
    mm = float(target.header["mm_per_count"])
    assert target.transient()["position_mm"] == pytest.approx(target["position_counts"] * mm)


@pytest.mark.parametrize("name", ["TARGET-1.DAT", "STREAM-1.txt"])
def test_files_of_version_1_are_read(fixtures: Path, name: str) -> None:
    assert len(Target.read(fixtures / name)["index"]) > 0
    assert len(Transient.read(fixtures / name)["time_s"]) > 0


def test_a_damaged_file_is_refused(fixtures: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "TARGET01.DAT"
    text = (fixtures / "TARGET-1.DAT").read_text()
    damaged.write_text(text[:-20])
    with pytest.raises(pneudrive.PneudriveError, match="TARGET01.DAT"):
        Target.read(damaged)
    with pytest.raises(FileNotFoundError, match="cannot read .*TARGET99.DAT"):
        Target.read(tmp_path / "TARGET99.DAT")
    with pytest.raises(TypeError):
        Target.read(7)  # type: ignore[arg-type]


def test_a_record_is_kept_under_the_next_number(target: Target, tmp_path: Path) -> None:
    assert [target.save_next(tmp_path).name for _ in range(2)] == ["TARGET01.DAT", "TARGET02.DAT"]
    assert np.array_equal(Target.read(tmp_path / "TARGET02.DAT")["index"], target["index"])


def test_an_overlay_tells_the_deviation_of_each_channel(run: Run, rig: Rig) -> None:
    heavy = rig.with_(load__mass_kg=2).simulate(ensemble=1)
    found = pneudrive.overlay(heavy, run)
    [deviations] = found.deviations
    position = next(one for one in deviations if one.channel == "position")
    difference = run.transient()["position_mm"] - heavy.transient()["position_mm"]
    assert position.mean == pytest.approx(difference.mean())
    assert position.largest == pytest.approx(np.abs(difference).max())
    assert position.inside_band is not None
    assert found.shifts_s == [0.0]
    assert "position" in str(found)
    shifted = pneudrive.overlay(heavy, run, align="correlation")
    assert shifted.shifts_s[0] != 0.0


def test_the_error_of_a_finer_encoder_is_compared_in_counts_of_the_reference(run: Run, rig: Rig) -> None:
    fine = rig.with_(
        encoder__mm_per_count=rig.encoder.mm_per_count / 2,
        test__moves=[[time, 2 * count] for time, count in rig.test.moves],
    )
    found = pneudrive.overlay(run, fine.simulate(ensemble=1, check_convergence=False))
    largest = np.abs(run.transient()["error_counts"]).max()
    finer = np.abs(found.transients[1]["error_counts"]).max()
    assert 0.9 * largest < finer < 1.1 * largest, "the same step, in the same counts"


def test_what_cannot_be_overlaid_is_refused(run: Run, target: Target) -> None:
    with pytest.raises(TypeError, match="there is nothing to compare"):
        pneudrive.overlay(run)
    with pytest.raises(ValueError, match='align must be "start", "move" or "correlation", is "end"'):
        pneudrive.overlay(run, target, align="end")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="a transient is a Run, a Target, a Transient or a path, not int"):
        pneudrive.overlay(run, 7)  # type: ignore[arg-type]


def test_an_evaluation_of_a_run_is_that_of_its_moves(run: Run) -> None:
    found = pneudrive.evaluate(run)
    assert found.runs == run.ensemble
    assert [one.to_dict() for one in found.moves] == [one.to_dict() for one in run.moves]
    assert found.moves[-1].settled_s.value is None
    wide = pneudrive.evaluate(run, tolerance_mm=100)
    assert wide.moves[-1].settled_s.value == pytest.approx(0, abs=0.01)
    assert "within 100 mm" in str(wide)
    with pytest.raises(ValueError, match="tolerance_mm must be more than 0, is NaN"):
        pneudrive.evaluate(run, tolerance_mm=float("nan"))
    with pytest.raises(pneudrive.PneudriveError, match="fewer than two samples there"):
        pneudrive.evaluate(run, from_s=10)


def test_an_evaluation_of_a_record_rests_on_the_record_alone(target: Target, fixtures: Path) -> None:
    found = pneudrive.evaluate(target)
    assert found.runs == 1
    assert found.moves[0].ends_at_mm.least is None
    of_file = pneudrive.evaluate(fixtures / "TARGET-1.DAT")
    assert [one.to_dict() for one in of_file.moves] == [one.to_dict() for one in found.moves]
    other = Rig("servo-b-tuned", encoder__mm_per_count=0.0125)
    with pytest.raises(pneudrive.PneudriveError, match="its encoder has 0.01205 mm per count, not 0.0125"):
        pneudrive.evaluate(target, rig=other)


def test_a_sweep_of_a_file_is_the_same_on_any_number_of_threads() -> None:
    one, two = (pneudrive.sweep(SWEEP, threads=threads) for threads in (1, 2))
    assert one.to_csv() == two.to_csv()
    assert one.to_csv().splitlines()[0] == ",".join(one.keys())
    assert len(one["point"]) == 24
    assert one["load.mass_kg"].dtype == np.float64
    assert one.best is None or one.allowed[one.best]


def test_a_sweep_of_a_rig_varies_what_it_is_told() -> None:
    rig = Rig("servo-b-tuned", test__moves=[(0.0, 8192), (0.1, 13171)], test__duration_s=0.8, load__mass_kg=9)
    told: list[tuple[int, int]] = []
    found = pneudrive.sweep(
        rig,
        vary={"load.mass_kg": np.array([1.0, 2.0]), "tubing.model": ["analytical", "none"]},
        metrics={"speed": "top_speed_mm_s", "overshoot": {"figure": "overshoot_mm", "move": 2}},
        objective={"maximise": "speed"},
        ensemble=2,
        progress=lambda done, all_: told.append((done, all_)),
    )
    assert told[-1] == (4, 4)
    assert list(found["load.mass_kg"]) == [1.0, 1.0, 2.0, 2.0]
    assert found["tubing.model"] == ["\"analytical\"", "\"none\""] * 2 or found["tubing.model"] == ["analytical", "none"] * 2
    assert np.all(found["speed_least"] <= found["speed"]) and np.all(found["speed"] <= found["speed_most"])
    assert set(found["converged"]) <= {"yes", "no"}
    assert found.best == int(np.argmax(found["speed_least"]))
    assert found.rig(2).load.mass_kg == 2.0
    alone = found.rig(2).simulate(ensemble=2)
    assert alone.moves[-1].top_speed_mm_s.value == found["speed"][2]
    with pytest.raises(IndexError, match="there is no point 4; there are 4"):
        found.rig(4)


def test_a_sweep_is_saved_as_the_command_saves_it(tmp_path: Path) -> None:
    found = pneudrive.sweep("servo-b-tuned", vary={"load.mass_kg": [1.0]}, metrics={"rise": "rise_s"})
    found.save(tmp_path)
    assert (tmp_path / "sweep.csv").read_text() == found.to_csv()
    assert (tmp_path / "sweep.html").exists()


@pytest.mark.parametrize(
    ("parts", "exception", "message"),
    [
        ({"vary": {"load.mas_kg": [1]}, "metrics": {"a": "rise_s"}}, ValueError, "values: .*load.mas_kg"),
        ({"vary": {"load.mass_kg": [-1]}, "metrics": {"a": "rise_s"}}, ValueError, "load.mass_kg"),
        ({"vary": {"load.mass_kg": [1]}, "metrics": {"a": "rise"}}, ValueError, 'there is no figure "rise"'),
        ({"vary": {"load.mass_kg": [1]}}, ValueError, "nothing is collected"),
        ({"vary": {"load.mass_kg": [object()]}, "metrics": {"a": "rise_s"}}, TypeError, "load.mass_kg"),
        ({"varies": {}}, TypeError, "a sweep has no varies; it has vary, metrics"),
    ],
)
def test_a_wrong_sweep_is_refused(parts: dict[str, object], exception: type[Exception], message: str) -> None:
    with pytest.raises(exception, match=message):
        pneudrive.sweep("servo-b-tuned", **parts)  # type: ignore[arg-type]


def test_a_fit_of_what_the_data_do_not_show_is_refused(fixtures: Path) -> None:
    with pytest.raises(pneudrive.PneudriveError, match="the drive must move in them"):
        pneudrive.identify("servo-b-tuned", [fixtures / "TARGET-1.DAT"], fit=["load.mass_kg"])
    with pytest.raises(pneudrive.PneudriveError, match="load.mas_kg"):
        pneudrive.identify("servo-b-tuned", [fixtures / "TARGET-1.DAT"], fit=["load.mas_kg"])
    with pytest.raises(pneudrive.PneudriveError, match="a fit needs"):
        pneudrive.identify("servo-b-tuned", [])


def test_gains_are_judged_on_draws() -> None:
    rig = Rig("servo-b-tuned")
    found = pneudrive.tune(rig, generations=0, draws=4, tolerance_mm=1.0, time_s=0.8)
    assert (found.met.of, found.settings) == (4, [])
    low, high = found.met.interval
    assert 0 <= low <= found.met.met / 4 <= high <= 1
    assert found.rig.controller.velocity_gain == rig.controller.velocity_gain
    assert "fresh draws" in found.notes[0]
    again = pneudrive.tune(rig, generations=0, draws=4, tolerance_mm=1.0, time_s=0.8)
    assert found.met.met == again.met.met


@pytest.mark.parametrize(
    ("numbers", "exception", "message"),
    [
        ({"draws": 0}, ValueError, "draws must be between 1 and 10000, is 0"),
        ({"step_mm": float("nan")}, ValueError, "step_mm must be between .* is NaN"),
        ({"load": "30%"}, TypeError, "load cannot be 30%"),
        ({"steps": 1}, TypeError, "a tuning has no steps; it has step_mm"),
        ({"fix": ["load.mass_kg"]}, pneudrive.PneudriveError, "load.mass_kg"),
    ],
)
def test_a_wrong_tuning_is_refused(numbers: dict[str, object], exception: type[Exception], message: str) -> None:
    with pytest.raises(exception, match=message):
        pneudrive.tune("servo-b-tuned", **numbers)  # type: ignore[arg-type]


def test_a_sweep_becomes_a_dataset_over_its_axes() -> None:
    found = pneudrive.sweep(
        Rig("servo-b-tuned", test__moves=[(0.0, 8192), (0.1, 13171)], test__duration_s=0.6),
        vary={"load.mass_kg": [1.0, 2.0, 3.0], "controller.velocity_gain": [1500, 2000]},
        metrics={"rise": "rise_s"},
    )
    assert found.axes == ["load.mass_kg", "controller.velocity_gain"]
    data = found.to_xarray()
    assert dict(data.sizes) == {"load.mass_kg": 3, "controller.velocity_gain": 2}
    for point in range(6):
        at = {axis: found[axis][point] for axis in found.axes}
        assert data["point"].sel(at) == point
        assert np.array_equal(data["rise"].sel(at), found["rise"][point], equal_nan=True)


def test_the_draws_of_a_sweep_are_a_dimension() -> None:
    found = pneudrive.sweep(SWEEP)
    data = found.to_xarray()
    assert list(data.sizes) == [*found.axes, "draw"]
    assert data["point"].size == len(found["point"])
    assert np.array_equal(np.sort(data["point"].values.ravel()), found["point"])
