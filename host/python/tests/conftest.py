"""What several tests use."""

import os
from pathlib import Path

import pytest

import pneudrive

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def fixtures() -> Path:
    """Files of every version that users may have."""
    return ROOT / "host" / "tests" / "fixtures"


@pytest.fixture(scope="session")
def rig() -> pneudrive.Rig:
    """A closed loop of half a second."""
    return pneudrive.Rig("servo-b-tuned", test__duration_s=0.5)


@pytest.fixture(scope="session")
def run(rig: pneudrive.Rig) -> pneudrive.Run:
    return rig.simulate()


@pytest.fixture(scope="session")
def target(fixtures: Path) -> pneudrive.Target:
    return pneudrive.Target.read(fixtures / "TARGET-1.DAT")


@pytest.fixture(scope="session")
def command() -> Path:
    """The program `pneudrive`, which `cargo xtask test python` builds."""
    program = os.environ.get("PNEUDRIVE_COMMAND")
    assert program is not None, "PNEUDRIVE_COMMAND must name the program: cargo build -p pneudrive makes target/debug/pneudrive"
    return Path(program)
