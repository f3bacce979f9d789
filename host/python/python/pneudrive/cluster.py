"""A sweep on the workers of a Dask cluster.

A point of a sweep is a number that means the same rig everywhere, and its row follows from that number alone. Points may
therefore run on any worker, and again on another one after theirs was killed: the result has the bytes that one thread
gives.

Points are sent in chunks of some seconds, by the time that points have taken so far: what the cluster spends on a chunk,
a few milliseconds, then counts for little, and little is lost with a worker. Toward the end chunks become smaller, so that
all workers end at about the same time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import lru_cache
from typing import Any

from ._pneudrive import SweepResult, __version__, _Points
from .errors import NoAnswer, PneudriveError
from .frames import _needs

# A chunk is as many points as take this long.
CHUNK_S = 2.0
# Chunks that are under way for each thread of the workers: one that runs, and one that waits for it.
AHEAD = 2
# Time between two looks at the workers.
LOOK_S = 0.5
# A cluster without workers is given up after this time.
PATIENCE_S = 60.0

_Text = tuple[str, str]


# The points of a sweep, read once in each worker.
_points: Callable[[_Text, _Text], _Points] = lru_cache(maxsize=4)(_Points)


def _run(
    version: str, identity: str, texts: tuple[_Text, _Text], numbers: list[int]
) -> tuple[list[str], float]:
    """Runs points on a worker; returns their rows and the time that they took, s."""
    if version != __version__:
        raise PneudriveError(f"it has pneudrive {__version__}, the client has {version}; install the same on both")
    points = _points(*texts)
    if points.identity != identity:
        raise PneudriveError("its build of pneudrive gives this sweep other rows; install the same on both")
    begun = time.perf_counter()
    rows = points.run(numbers)
    return rows, time.perf_counter() - begun


def sweep(points: _Points, client: Any, progress: Callable[[int, int], object] | None) -> SweepResult:
    """Runs all points on the workers of a `dask.distributed.Client` and returns their result."""
    distributed = _needs("distributed", "dask")
    if not isinstance(client, distributed.Client) or client.asynchronous:
        raise TypeError(f"client must be a dask.distributed.Client that is not asynchronous, not {client!r}")
    return _Sweep(points, client, distributed, progress or (lambda done, all_: None)).run()


class _Sweep:
    """A sweep in progress."""

    def __init__(
        self, points: _Points, client: Any, distributed: Any, progress: Callable[[int, int], object]
    ) -> None:
        self._points = points
        self._what = (__version__, points.identity, points.__reduce__()[1])
        self._client = client
        self._distributed = distributed
        self._progress = progress
        # What a cluster that was closed gives.
        of_client = distributed.client
        self._gone = (distributed.comm.CommClosedError, of_client.CancelledError, of_client.ClosedClientError)
        self._todo = iter(range(len(points)))
        self._unsent = len(points)
        self._rows: dict[int, str] = {}
        self._running: dict[Any, list[int]] = {}
        # Seconds that points have taken, and how many those were.
        self._cost = (0.0, 0)
        self._seen = time.monotonic()

    def run(self) -> SweepResult:
        all_ = len(self._points)
        self._progress(0, all_)
        self._try_out()
        try:
            while len(self._rows) < all_:
                self._send(self._threads())
                self._collect()
                self._progress(len(self._rows), all_)
        except self._gone as error:
            raise NoAnswer(f"the cluster does not answer any more, {self._so_far()}: {error}") from error
        finally:
            with suppress(*self._gone):
                self._client.cancel(list(self._running))
        return self._points.result([self._rows[point] for point in range(all_)])

    def _try_out(self) -> None:
        """Runs the first point on every worker: all rows must agree in every byte. This also measures the cost of a point."""
        found = self._client.run(_run, *self._what, [0], on_error="return")
        rows: dict[str, str] = {}
        for worker, one in found.items():
            if isinstance(one, OSError):  # A worker that has just gone.
                continue
            if isinstance(one, BaseException):
                raise _of_worker(worker, one)
            [rows[worker]], seconds = one
            self._add_cost(seconds, 1)
        differing = next((worker for worker, row in rows.items() if row != next(iter(rows.values()))), None)
        if differing is not None:
            raise PneudriveError(
                f"worker {differing}: its first point differs from that of worker {next(iter(rows))}; "
                "install the same build of pneudrive on all workers"
            )

    def _add_cost(self, seconds: float, count: int) -> None:
        self._cost = (self._cost[0] + seconds, self._cost[1] + count)

    def _threads(self) -> int:
        """Returns the number of threads of all workers."""
        if self._client.scheduler is None:
            raise self._distributed.client.ClosedClientError("its client is closed")
        threads: int = sum(self._client.nthreads().values())
        now = time.monotonic()
        if threads:
            self._seen = now
        elif now - self._seen > PATIENCE_S:
            raise NoAnswer(
                f"the cluster has had no worker for {PATIENCE_S:.0f} s, {self._so_far()}; "
                "start workers, and wait for them (client.wait_for_workers)"
            )
        return threads

    def _so_far(self) -> str:
        return f"{len(self._rows)} of {len(self._points)} points are done"

    def _send(self, threads: int) -> None:
        """Sends chunks until all threads have enough."""
        while self._unsent and len(self._running) < AHEAD * threads:
            numbers = list(self._take(self._chunk(threads)))
            chunk = self._client.submit(_run, *self._what, numbers, pure=False)
            self._running[chunk] = numbers

    def _chunk(self, threads: int) -> int:
        """Returns the number of points of a chunk."""
        seconds, count = self._cost
        of_time = int(CHUNK_S * count / seconds) if seconds > 0 else 1
        share = -(-self._unsent // (AHEAD * threads))
        return max(1, min(of_time, share))

    def _take(self, count: int) -> Iterator[int]:
        for _ in range(min(count, self._unsent)):
            self._unsent -= 1
            yield next(self._todo)

    def _collect(self) -> None:
        """Waits briefly for chunks, and takes the rows of finished ones."""
        if not self._running:
            time.sleep(LOOK_S)
            return
        try:
            done = self._distributed.wait(list(self._running), LOOK_S, "FIRST_COMPLETED").done
        except TimeoutError:
            return
        for chunk in done:
            numbers = self._running.pop(chunk)
            try:
                rows, seconds = chunk.result()
            except self._distributed.KilledWorker as error:
                raise PneudriveError(f"{_named(numbers)} killed every worker that ran them: {error}") from error
            except PneudriveError as error:
                raise PneudriveError(f"a worker that ran {_named(numbers)}: {error}") from error
            self._rows.update(zip(numbers, rows, strict=True))
            self._add_cost(seconds, len(numbers))


def _named(numbers: list[int]) -> str:
    return f"point {numbers[0]}" if len(numbers) == 1 else f"points {numbers[0]} to {numbers[-1]}"


def _of_worker(worker: str, error: BaseException) -> PneudriveError:
    """Returns the reason why a worker cannot run points. For a failed import, the cluster passes on only the text."""
    advice = "" if isinstance(error, PneudriveError) else f"; install pneudrive {__version__} there"
    return PneudriveError(f"worker {worker}: {error}{advice}")
