"""A progress bar where somebody looks: at a terminal, and in a notebook."""

from __future__ import annotations

import sys
from collections.abc import Callable

# Work that is done before this many seconds shows no bar.
DELAY_S = 0.5


def bar(what: str, wanted: bool | None) -> Callable[[int, int], None] | None:
    """A function that is told what is done and what is to do; None where no bar is wanted."""
    if wanted is False or (wanted is None and not _somebody_looks()):
        return None
    return _Bar(what)


def _somebody_looks() -> bool:
    return sys.stderr.isatty() or _in_notebook()


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and "IPKernelApp" in shell.config


class _Bar:
    """A bar of tqdm; without tqdm, a line each quarter."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._quarter = 0
        try:
            from tqdm.auto import tqdm
        except ModuleNotFoundError:
            self._tqdm = None
        else:
            self._tqdm = tqdm(desc=what, delay=DELAY_S, leave=False)

    def __call__(self, done: int, all_: int) -> None:
        if self._tqdm is not None:
            self._tqdm.total = all_
            self._tqdm.update(done - self._tqdm.n)
            if done >= all_:
                self._tqdm.close()
            return
        quarter = 4 * done // max(all_, 1)
        if quarter > self._quarter:
            self._quarter = quarter
            print(f"{self._what}: {done} of {all_}", file=sys.stderr)
