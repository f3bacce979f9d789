"""Sweeps on a cluster of Dask, and on a batch system: the same bytes as `pneudrive sweep`, whatever becomes of a worker."""

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import pytest
from distributed import Client, LocalCluster

import pneudrive
from conftest import ROOT

# A thousand draws of a drive whose runs take some milliseconds each.
THOUSAND = """
rig = "servo-b-tuned"
[set]
test.moves = [[0.0, 8192], [0.05, 13171]]
test.duration_s = 0.4
[vary]
controller.velocity_gain = [1500, 2000]
load.mass_kg = { uniform = [1.12, 2.08] }
supply.pressure_pa = { normal = [589e3, 15e3] }
[draw]
count = 500
[metrics]
end_mm = { figure = "end_mm", move = 2 }
top_speed_mm_s = "top_speed_mm_s"
"""


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    """Two worker processes of one thread each."""
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.fixture
def sweep(tmp_path: Path) -> Path:
    path = tmp_path / "sweep.toml"
    path.write_text(THOUSAND)
    return path


def test_a_thousand_runs_have_the_bytes_of_the_command_though_a_worker_is_killed(
    client: Client, sweep: Path, command: Path
) -> None:
    before = set(client.run(os.getpid).values())
    told: list[tuple[int, int]] = []
    killed: list[int] = []

    def kill_on_the_way(done: int, all_: int) -> None:
        told.append((done, all_))
        if not killed and done >= 200:
            killed.append(before.copy().pop())
            os.kill(killed[0], signal.SIGKILL)

    found = pneudrive.sweep(sweep, client=client, progress=kill_on_the_way)
    assert killed
    assert told[0] == (0, 1000) and told[-1] == (1000, 1000) and told == sorted(told)
    client.wait_for_workers(2, timeout=30)
    assert killed[0] not in client.run(os.getpid).values()
    subprocess.run([command, "sweep", sweep, "--out", sweep.parent / "out", "--yes"], check=True, capture_output=True)
    written = (sweep.parent / "out" / "sweep.csv").read_bytes()
    assert written.count(b"\n") == 1001
    assert found.to_csv().encode() == written
    assert all(failure == "" for failure in found["failure"])


def test_a_sweep_of_a_rig_and_its_result_are_those_of_threads(client: Client) -> None:
    rig = pneudrive.Rig("servo-b-tuned", test__duration_s=0.6, load__mass_kg=2)
    parts: dict[str, Any] = {"vary": {"supply.pressure_pa": [5e5, 6e5, 7e5]}, "metrics": {"speed": "top_speed_mm_s"}, "ensemble": 2}
    one, other = pneudrive.sweep(rig, client=client, **parts), pneudrive.sweep(rig, **parts)
    assert one.to_csv() == other.to_csv()
    assert list(one) == list(other)
    assert one.rig(2) == other.rig(2)


def test_points_that_cannot_be_run_are_told_as_without_a_cluster(client: Client) -> None:
    parts: dict[str, Any] = {"vary": {"load.coulomb_extend_n": [1e9]}, "metrics": {"speed": "top_speed_mm_s"}}
    with pytest.raises(pneudrive.PneudriveError) as here:
        pneudrive.sweep("servo-b-tuned", **parts)
    with pytest.raises(pneudrive.PneudriveError) as there:
        pneudrive.sweep("servo-b-tuned", client=client, **parts)
    assert str(here.value) == str(there.value)


def test_a_worker_with_another_version_is_named(client: Client, sweep: Path) -> None:
    client.wait_for_workers(2, timeout=30)
    worker = sorted(client.run(os.getpid))[1]
    set_version = "import pneudrive.cluster as c; c.__version__ = '{}'".format
    client.run(exec, set_version("0.0.9"), workers=[worker])
    try:
        with pytest.raises(pneudrive.PneudriveError) as refused:
            pneudrive.sweep(sweep, client=client)
    finally:
        client.run(exec, set_version(pneudrive.__version__), workers=[worker])
    says = f"worker {worker}: it has pneudrive 0.0.9, the client has {pneudrive.__version__}; install the same on both"
    assert str(refused.value) == says


def test_a_worker_without_pneudrive_is_named(client: Client, sweep: Path) -> None:
    client.wait_for_workers(2, timeout=30)
    worker = sorted(client.run(os.getpid))[0]
    client.run(exec, "import sys; sys.modules['pneudrive.cluster'] = None", workers=[worker])
    try:
        with pytest.raises(pneudrive.PneudriveError, match=f"worker {worker}: .*; install pneudrive .* there"):
            pneudrive.sweep(sweep, client=client)
    finally:
        client.run(exec, "import sys; del sys.modules['pneudrive.cluster']", workers=[worker])


def test_a_cluster_that_has_no_worker_any_more_is_given_up(sweep: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pneudrive.cluster.PATIENCE_S", 2.0)
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):

        def let_go(done: int, all_: int) -> None:
            if done >= 100 and cluster.workers:
                cluster.scale(0)

        with pytest.raises(pneudrive.NoAnswer, match=r"has had no worker for 2 s, \d+ of 1000 points are done"):
            pneudrive.sweep(sweep, client=client, progress=let_go)


def test_a_cluster_that_is_closed_on_the_way_is_told(sweep: Path) -> None:
    cluster = LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0")
    with Client(cluster) as client:
        begun = [False]

        def close(done: int, all_: int) -> None:
            if done >= 100 and not begun[0]:
                begun[0] = True
                cluster.close(timeout=10)

        with pytest.raises(pneudrive.NoAnswer, match="the cluster does not answer any more, .* points are done"):
            pneudrive.sweep(sweep, client=client, progress=close)


def test_points_that_kill_their_workers_are_named(sweep: Path) -> None:
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        workers = set(client.run(os.getpid).values())

        def kill(done: int, all_: int) -> None:
            if done >= 100 and workers:
                os.kill(workers.pop(), signal.SIGKILL)

        with pytest.raises(pneudrive.PneudriveError, match=r"points? \d+.* killed every worker that ran them"):
            pneudrive.sweep(sweep, client=client, progress=kill)


def test_an_exception_of_the_progress_ends_the_sweep_and_leaves_the_cluster(client: Client, sweep: Path) -> None:
    class Enough(Exception):
        pass

    def refuse(done: int, all_: int) -> None:
        if done:
            raise Enough

    with pytest.raises(Enough):
        pneudrive.sweep(sweep, client=client, progress=refuse)
    assert client.submit(sum, [1, 2]).result(timeout=30) == 3


def test_what_is_no_client_is_refused(client: Client, sweep: Path) -> None:
    with pytest.raises(TypeError, match="client must be a dask.distributed.Client that is not asynchronous, not 'local'"):
        pneudrive.sweep(sweep, client="local")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="threads are those of the client's workers"):
        pneudrive.sweep(sweep, client=client, threads=2)


def test_a_job_array_runs_the_shards_of_a_sweep_and_merges_them(tmp_path: Path, command: Path) -> None:
    """The batch file as Slurm runs it: once for each task of the array, then the job that waits for all of them."""
    batch = ROOT / "docs" / "examples" / "sweep.sbatch"
    (tmp_path / "sweep.toml").write_text(THOUSAND.replace("count = 500", "count = 5"))
    environment = os.environ | {"PATH": f"{command.parent}:{os.environ['PATH']}", "SLURM_CPUS_PER_TASK": "1"}
    array = {"SLURM_ARRAY_TASK_COUNT": "2"}
    for task in ("1", "2"):
        run = ["bash", str(batch), "sweep.toml", "out"]
        subprocess.run(run, cwd=tmp_path, env=environment | array | {"SLURM_ARRAY_TASK_ID": task}, check=True)
    subprocess.run(["bash", str(batch), "sweep.toml", "out"], cwd=tmp_path, env=environment, check=True)
    alone = [str(command), "sweep", "sweep.toml", "--out", "alone"]
    subprocess.run(alone, cwd=tmp_path, check=True)
    merged, whole = ((tmp_path / folder / "sweep.csv").read_bytes() for folder in ("out", "alone"))
    assert merged == whole
    assert merged.count(b"\n") == 11
