"""Exceptions: a kind for each end that a program can do something about.

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
    """Any failure of pneudrive."""


class Problem(NamedTuple):
    """Something wrong with a rig or a sweep."""

    source: str
    """The file, or "values" for what was given in Python."""
    line: int | None
    """Counted from 1; None where there is no line."""
    key: str
    """The key, such as "load.mass_kg"."""
    message: str
    """What is wrong and what to do."""


class RigError(PneudriveError, ValueError):
    """A rig or a sweep is not valid; `problems` has everything that is wrong with it."""

    def __init__(self, text: str, problems: list[tuple[str, int | None, str, str]]) -> None:
        super().__init__(text)
        self.problems = [Problem(*problem) for problem in problems]

    def __reduce__(self) -> tuple[type[RigError], tuple[str, list[Problem]]]:
        return type(self), (str(self), self.problems)


class SimulationError(PneudriveError, ArithmeticError):
    """The integration cannot go on."""


class NotThere(PneudriveError, FileNotFoundError):
    """There is no such rig, file or folder."""


class Unwritten(PneudriveError, OSError):
    """A file cannot be written."""


class NoAnswer(PneudriveError, ConnectionError):
    """No rig can be reached: the port cannot be opened, nothing answers, or the link broke."""


class Refused(PneudriveError):
    """The rig refuses: its state does not allow the request, or another program commands the drive."""


class Tripped(PneudriveError):
    """The drive tripped."""


class Interrupted(PneudriveError):
    """A run was stopped because that was asked for."""


class NotBorneOut(PneudriveError):
    """The model does not fit, or the data cannot decide."""


class InternalError(PneudriveError):
    """A defect of pneudrive. The interpreter and all other objects are intact; please report it."""
