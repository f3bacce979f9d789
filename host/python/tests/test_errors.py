"""What is promised of every exception, and of what lies behind the border."""

import inspect
import logging
import multiprocessing
import pickle
import subprocess
import sys

import pytest

import pneudrive
from pneudrive import Rig, errors


def test_every_exception_is_one_of_the_package_and_documented() -> None:
    for name in errors.__all__:
        kind = getattr(errors, name)
        assert inspect.getdoc(kind)
        assert getattr(pneudrive, name) is kind
        if name not in {"Problem", "PneudriveError"}:
            assert issubclass(kind, pneudrive.PneudriveError)


def test_every_class_and_function_is_documented() -> None:
    for name in pneudrive.__all__:
        one = getattr(pneudrive, name)
        assert inspect.getdoc(one), name
        if inspect.isclass(one):
            for member in vars(one):
                if not member.startswith("_"):
                    assert inspect.getdoc(getattr(one, member)), f"{name}.{member}"


def test_exceptions_go_to_other_processes() -> None:
    with pytest.raises(pneudrive.RigError) as raised:
        Rig({"load.mass_kg": -1})
    copy = pickle.loads(pickle.dumps(raised.value))
    assert (type(copy), str(copy), copy.problems) == (type(raised.value), str(raised.value), raised.value.problems)


def _mass(rig: Rig) -> float:
    return float(rig.simulate(ensemble=2)["position_m"][-1])


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_runs_work_in_processes_that_were_forked_or_spawned(rig: Rig, method: str) -> None:
    short = rig.with_(test__duration_s=0.2)
    here = _mass(short)
    with multiprocessing.get_context(method).Pool(1) as pool:
        assert pool.apply_async(_mass, (short,)).get(timeout=60) == here


def test_a_panic_is_an_exception_and_the_interpreter_goes_on() -> None:
    with pytest.raises(pneudrive.InternalError, match="a defect of pneudrive; please report it: on purpose"):
        pneudrive._pneudrive._panic()
    assert Rig({}).load.mass_kg == 1.6


def test_notes_go_to_the_logger(caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig("servo-b-tuned", test__duration_s=0.1)
    with pneudrive.VirtualRig(rig) as virtual, pneudrive.Drive(virtual.port) as drive, caplog.at_level(logging.INFO, "pneudrive"):
        drive.run(rig.with_(controller__velocity_gain=1000))
    assert "controller.velocity_gain" in caplog.text


def test_importing_the_package_imports_no_library_but_numpy() -> None:
    code = "import sys, pneudrive; print(*{'pandas', 'polars', 'pyarrow', 'matplotlib', 'tqdm', 'IPython'} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
