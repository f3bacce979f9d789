"""Exceptions: one for each outcome that a program can handle.

The kinds are those of the command's exit codes (docs/reference/exit-codes.md), and the texts are the command's.
"""

from __future__ import annotations

__all__ = [
    "InternalError",
    "Interrupted",
    "NoAnswer",
    "NotBorneOut",
    "NotThere",
    "PneudriveError",
    "Problem",
    "Refused",
    "RigError",
    "SimulationError",
    "Tripped",
    "Unwritten",
]

from typing import NamedTuple


class PneudriveError(Exception):
    """The base class of all exceptions of pneudrive."""


class Problem(NamedTuple):
    """A problem of a rig or a sweep."""

    source: str
    """The file, or "values" for values from Python."""
    line: int | None
    """The line, counted from 1; None without one."""
    key: str
    """The key, such as "load.mass_kg"."""
    message: str
    """The problem and its remedy."""


class RigError(PneudriveError, ValueError):
    """A rig or a sweep is not valid; `problems` lists all its problems."""

    def __init__(self, text: str, problems: list[tuple[str, int | None, str, str]]) -> None:
        super().__init__(text)
        self.problems = [Problem(*problem) for problem in problems]

    def __reduce__(self) -> tuple[type[RigError], tuple[str, list[Problem]]]:
        return type(self), (str(self), self.problems)


class SimulationError(PneudriveError, ArithmeticError):
    """The integration cannot continue."""


class NotThere(PneudriveError, FileNotFoundError):
    """There is no such rig, file or folder."""


class Unwritten(PneudriveError, OSError):
    """A file cannot be written."""


class NoAnswer(PneudriveError, ConnectionError):
    """No rig can be reached: the port cannot be opened, nothing answers, or the link broke."""


class Refused(PneudriveError):
    """The rig refused a request: its state does not allow it, or another program commands the drive."""


class Tripped(PneudriveError):
    """The drive tripped."""


class Interrupted(PneudriveError):
    """A run was stopped on request."""


class NotBorneOut(PneudriveError):
    """The model does not fit, or the data cannot decide."""


class InternalError(PneudriveError):
    """A defect of pneudrive. The interpreter and all other objects are intact; please report it."""
