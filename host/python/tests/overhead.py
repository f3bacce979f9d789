"""What a run from Python costs more than from Rust: `python overhead.py PROGRAM TRIALS`.

PROGRAM is the example `runs` of pneudrive-sim, the same simulation in a process of its own. Processor time is compared, as other
programs do not disturb it much: in each trial some runs in Rust, then as many in Python. Printed are medians, and the median of the
ratio in a trial with its quartiles.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from statistics import median, quantiles

import pneudrive

RIGS = ("servo-a-tuned", "servo-b-tuned", "servo-c-tuned")
RUNS = 20


def in_rust(program: str, rig: str, runs: int) -> float:
    """Processor time of a program that makes so many runs, s."""
    process = subprocess.Popen([program, rig, str(runs)], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    assert process.stdin is not None
    process.stdin.write("\n")
    process.stdin.close()
    _, status, used = os.wait4(process.pid, 0)
    assert status == 0
    return used.ru_utime + used.ru_stime


def in_python(run: Callable[[], object]) -> float:
    begun = time.process_time()
    for _ in range(RUNS):
        run()
    return (time.process_time() - begun) / RUNS


def main() -> None:
    program, trials = sys.argv[1], int(sys.argv[2])
    for name in RIGS:
        rig = pneudrive.Rig(name)
        plain = lambda: rig.simulate(ensemble=1, check_convergence=False)  # noqa: E731
        looked_at = lambda: rig.simulate(ensemble=1, check_convergence=False)["position_m"]  # noqa: E731
        rows = []
        for _ in range(trials):
            # Without what it takes to start.
            rust = (in_rust(program, name, RUNS + 1) - in_rust(program, name, 1)) / RUNS
            rows.append((rust, in_python(plain), in_python(looked_at)))
        rust, python, channels = (1e3 * median(column) for column in zip(*rows, strict=True))
        print(f"{name}: Rust {rust:.2f} ms, Python {python:.2f} ms, with channels {channels:.2f} ms")
        for what, place in (("Python", 1), ("with channels", 2)):
            low, middle, high = quantiles([row[place] / row[0] for row in rows], n=4)
            print(f"  {what} / Rust: {middle:.3f} ({low:.3f} to {high:.3f}, quartiles of {trials} trials)")


if __name__ == "__main__":
    main()
