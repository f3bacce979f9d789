"""Graphs with matplotlib, which is imported when the first one is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .frames import _needs

if TYPE_CHECKING:
    from ._pneudrive import Channels, Characteristic, Run, Transient

# The axes of a graph: their label, and the channels on them.
PANELS = {
    "position, mm": ("setpoint_mm", "position_mm"),
    "pressure, kPa": ("pressure_1_kpa", "pressure_2_kpa"),
    "spool, mm": ("spool_mm",),
    "command, counts": ("command_counts",),
}

# Channels that have a band, with its column and what turns that into the channel's unit.
BANDS = {
    "position_mm": ("position_m", 1e3),
    "pressure_1_kpa": ("pressure_1_pa", 1e-3),
    "pressure_2_kpa": ("pressure_2_pa", 1e-3),
    "spool_mm": ("spool_mm", 1.0),
    "command_counts": ("command_counts", 1.0),
    "error_counts": ("error_counts", 1.0),
}


def run(run: Run, channels: Sequence[str] | None = None) -> Any:
    """Draws a run, with the band that it and its perturbed runs cover."""
    figure = transients([run.transient()], channels)
    band = run.band
    for axes in figure.axes:
        for line in axes.get_lines():
            column, scale = BANDS.get(line.get_gid(), (None, 1.0))
            if column in band:
                low, high = band[column]
                axes.fill_between(run["time_s"], low * scale, high * scale, color=line.get_color(), alpha=0.25)
    return figure


def transients(transients: Sequence[Transient], channels: Sequence[str] | None = None) -> Any:
    """Draws transients on the same axes and returns a matplotlib figure."""
    panels = _panels(transients[0], channels)
    pyplot = _needs("matplotlib.pyplot", "plot")
    figure, grid = pyplot.subplots(
        len(panels), sharex=True, squeeze=False, layout="constrained", figsize=(8, 1 + 2 * len(panels))
    )
    for axes, (label, names) in zip(grid[:, 0], panels.items(), strict=True):
        for transient in transients:
            for name in names:
                text = name if len(transients) == 1 else f"{transient.name}: {name}"
                axes.plot(transient["time_s"], transient[name], label=text, gid=name, linewidth=1)
        axes.set_ylabel(label)
        axes.legend(loc="best", fontsize="small")
        axes.grid(alpha=0.3)
    grid[-1, 0].set_xlabel("time, s")
    return figure


def characteristic(found: Characteristic) -> Any:
    """Draws the curves of a bench test, one graph per y axis, and returns a matplotlib figure."""
    graphs = list(dict.fromkeys(curve.graph for curve in found.curves))
    pyplot = _needs("matplotlib.pyplot", "plot")
    figure, grid = pyplot.subplots(
        len(graphs), sharex=True, squeeze=False, layout="constrained", figsize=(8, 1 + 2 * len(graphs))
    )
    for axes, graph in zip(grid[:, 0], graphs, strict=True):
        for curve in found.curves:
            if curve.graph == graph:
                axes.plot(curve.x, curve.y, label=curve.name, linewidth=1)
        axes.set_ylabel(graph)
        axes.legend(loc="best", fontsize="small")
        axes.grid(alpha=0.3)
    if found.logarithmic:
        grid[-1, 0].set_xscale("log")
    grid[-1, 0].set_xlabel(found.across)
    return figure


def _panels(first: Channels, channels: Sequence[str] | None) -> Mapping[str, Sequence[str]]:
    if channels is None:
        return PANELS
    for name in channels:
        first[name]
    return {name: (name,) for name in channels}
