"""A progress bar for terminals and notebooks."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

# Work that is done before this many seconds shows no bar.
DELAY_S = 0.5


def bar(what: str, wanted: bool | None) -> Callable[[int, int], None] | None:
    """Returns a function that takes the work done and the total; None if no bar is wanted."""
    if wanted is False or (wanted is None and not _somebody_looks()):
        return None
    return _Bar(what)


def _somebody_looks() -> bool:
    return sys.stderr.isatty() or _in_notebook()


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and "IPKernelApp" in shell.config


def _tqdm() -> Any:
    """Returns the class of the bar: a widget if ipywidgets is installed, else a line of text; None without tqdm."""
    try:
        if _in_notebook() and find_spec("ipywidgets") is not None:
            from tqdm.notebook import tqdm
        else:
            from tqdm.std import tqdm
    except ModuleNotFoundError:
        return None
    return tqdm


class _Bar:
    """A bar of tqdm, which appears only if the work takes long; without tqdm, one line per quarter."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._begun = time.monotonic()
        self._show: Callable[[int, int], None] | None = None

    def __call__(self, done: int, all_: int) -> None:
        if self._show is None:
            if done >= all_ or time.monotonic() - self._begun < DELAY_S:
                return
            make = _tqdm()
            self._show = _Lines(self._what) if make is None else _Tqdm(make(desc=self._what, leave=False))
        self._show(done, all_)


class _Tqdm:
    def __init__(self, bar: Any) -> None:
        self._bar = bar

    def __call__(self, done: int, all_: int) -> None:
        self._bar.total = all_
        self._bar.update(done - self._bar.n)
        if done >= all_:
            self._bar.close()


class _Lines:
    def __init__(self, what: str) -> None:
        self._what = what
        self._quarter = 0

    def __call__(self, done: int, all_: int) -> None:
        quarter = 4 * done // max(all_, 1)
        if quarter > self._quarter:
            self._quarter = quarter
            print(f"{self._what}: {done} of {all_}", file=sys.stderr)
