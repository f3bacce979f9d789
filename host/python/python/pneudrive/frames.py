"""Columns as data frames of other libraries, each imported on first use."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import Any

Columns = dict[str, Any]


def _needs(module: str, extra: str) -> ModuleType:
    """Returns a module, or raises an error that says what to install."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name != module:
            raise
        text = f"{module} is not installed; pip install 'pneudrive[{extra}]' brings it"
        raise ModuleNotFoundError(text, name=module) from None


def to_pandas(columns: Columns) -> Any:
    return _needs("pandas", "pandas").DataFrame(columns, copy=False)


def to_xarray(columns: Columns, axes: list[str]) -> Any:
    """Returns a dataset over these columns; `draw` numbers the rows of the others."""
    _needs("xarray", "xarray")
    frame = to_pandas(columns)
    if axes[-1] == "draw":
        frame["draw"] = frame.groupby(axes[:-1]).cumcount() if axes[:-1] else range(len(frame))
    return frame.set_index(axes).to_xarray()


def to_polars(columns: Columns) -> Any:
    return _needs("polars", "polars").DataFrame(columns)


def to_arrow(columns: Columns) -> Any:
    return _needs("pyarrow", "arrow").table(columns)
