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
    Evaluation,
    Figure,
    Move,
    Overlay,
    Plant,
    Rig,
    Run,
    Sample,
    Target,
    Transient,
    Trip,
    builtin_rigs,
    evaluate,
    explain,
    keys,
    overlay,
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
