"""Columns in other libraries, and graphs."""

import sys

import matplotlib
import numpy as np
import pytest

from pneudrive import Run, Target

matplotlib.use("agg")


def test_a_run_becomes_a_frame_of_each_library(run: Run) -> None:
    frame = run.to_pandas()
    assert list(frame.columns) == run.keys()
    assert np.array_equal(frame["position_m"], run["position_m"])
    polars = run.to_polars()
    assert polars.columns == run.keys()
    assert np.array_equal(polars["position_m"].to_numpy(), run["position_m"])
    arrow = run.to_arrow()
    assert arrow.column_names == run.keys()
    column = arrow["position_m"].to_numpy()
    assert np.array_equal(column, run["position_m"])


def test_arrow_takes_the_memory_of_the_run(run: Run) -> None:
    [chunk] = run.to_arrow()["position_m"].chunks
    assert chunk.buffers()[1].address == run["position_m"].ctypes.data


def test_a_library_that_is_missing_is_named(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match=r"pandas is not installed; pip install 'pneudrive\[pandas\]'"):
        run.to_pandas()


def test_graphs_show_the_channels_and_the_band(run: Run, target: Target) -> None:
    figure = run.plot()
    assert [axes.get_ylabel() for axes in figure.axes] == ["position, mm", "pressure, kPa", "spool, mm", "command, counts"]
    position = figure.axes[0].get_lines()[1]
    assert np.array_equal(position.get_ydata(), run.transient()["position_mm"])
    assert len(figure.axes[0].collections) == 1
    assert len(target.plot(["position_mm"]).axes) == 1
    with pytest.raises(KeyError, match="there is no column position"):
        run.plot(["position"])


def test_a_column_becomes_the_index_of_a_frame(run: Run) -> None:
    frame = run.to_pandas(index="time_s")
    assert frame.index.name == "time_s"
    assert np.array_equal(frame.index, run["time_s"])
    assert list(frame.columns) == [name for name in run if name != "time_s"]
    with pytest.raises(KeyError, match="time_ms"):
        run.to_pandas(index="time_ms")
