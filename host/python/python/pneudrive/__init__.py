"""The twin of a servo-pneumatic drive, and the drive itself.

    rig = pneudrive.Rig("servo-b-tuned")
    run = rig.with_(load__mass_kg=2).simulate()
    run["position_m"], run.moves[1].settled_s, run.plot()
"""

from __future__ import annotations

from . import errors, tables
from ._pneudrive import (
    Channels,
    Command,
    Controller,
    Decided,
    Deviation,
    Estimate,
    Evaluation,
    Figure,
    Identification,
    Move,
    Overlay,
    Plant,
    Rig,
    Run,
    Sample,
    Share,
    SweepResult,
    Target,
    Transient,
    Trip,
    Tuned,
    builtin_rigs,
    evaluate,
    explain,
    identify,
    keys,
    overlay,
    sweep,
    tune,
)
from .errors import (
    InternalError,
    Interrupted,
    NoAnswer,
    NotBorneOut,
    NotThere,
    PneudriveError,
    Problem,
    Refused,
    RigError,
    SimulationError,
    Tripped,
    Unwritten,
)
