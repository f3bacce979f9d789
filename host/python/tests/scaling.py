"""How much faster a sweep of 1,000 runs is on workers and on threads: `python scaling.py MAX TRIALS`.

Each trial runs the sweep on 1, 2, 4, ... up to MAX threads and on as many workers of a Dask cluster on this machine, which are
started before. Printed are medians of the wall-clock time.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from distributed import Client, LocalCluster

import pneudrive
from test_cluster import THOUSAND


def seconds(run: Callable[[], object]) -> float:
    begun = time.perf_counter()
    run()
    return time.perf_counter() - begun


def on_workers(sweep: Path, workers: int, trials: int) -> list[float]:
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        client.wait_for_workers(workers)
        return [seconds(lambda: pneudrive.sweep(sweep, client=client)) for _ in range(trials)]


def main() -> None:
    most, trials = int(sys.argv[1]), int(sys.argv[2])
    print(f"{os.cpu_count()} processors, medians of {trials} trials")
    with TemporaryDirectory() as folder:
        sweep = Path(folder) / "sweep.toml"
        sweep.write_text(THOUSAND)
        count = 1
        while count <= most:
            on_threads = [seconds(lambda: pneudrive.sweep(sweep, threads=count)) for _ in range(trials)]
            print(f"{count}: threads {median(on_threads):.2f} s, workers {median(on_workers(sweep, count, trials)):.2f} s")
            count *= 2


if __name__ == "__main__":
    main()
