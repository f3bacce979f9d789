"""What the tests share: the command, FMUs that it writes, and FMUs as FMPy runs them."""

import csv
import os
import subprocess
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi3 import FMU3Slave

PERIOD_S = 0.0013


def pneudrive(*arguments, folder):
    """Runs the command, which must succeed."""
    call = [os.environ["PNEUDRIVE"], *map(str, arguments)]
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def work(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(scope="session")
def fmu(work):
    """Writes a part of a rig, once."""

    def write(rig: str, part: str, fmi: str = "3.0") -> Path:
        path = work / f"{rig}-{part}-{fmi}.fmu"
        if not path.exists():
            pneudrive("fmu", rig, f"--{part}", "--fmi", fmi, "--out", path, folder=work)
        return path

    return write


@pytest.fixture(scope="session")
def trace(work):
    """The rows of a rig's simulated test, one a sample."""

    def simulate(rig: str) -> list[dict[str, float]]:
        folder = work / f"{rig}-run"
        pneudrive("simulate", rig, "--out", folder, "--ensemble", 1, "--no-report", folder=work)
        with open(folder / "trace.csv") as file:
            rows = csv.DictReader(line for line in file if not line.startswith("#"))
            return [{name: float(value) for name, value in row.items()} for row in rows]

    return simulate


class Instance:
    """An instance with its variables by name. What it logs is kept in `log`."""

    def __init__(self, path: Path, parameters=None):
        self.description = fmpy.read_model_description(str(path))
        self.variables = {one.name: one for one in self.description.modelVariables}
        self.log = []
        self.slave = FMU3Slave(
            guid=self.description.instantiationToken,
            unzipDirectory=fmpy.extract(str(path)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.slave.instantiate(logMessage=lambda _env, _status, _category, text: self.log.append(text.decode()))
        for name, value in (parameters or {}).items():
            self[name] = value

    def start(self):
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        return self

    def __getitem__(self, name):
        one = self.variables[name]
        return getattr(self.slave, f"get{one.type}")([one.valueReference])[0]

    def __setitem__(self, name, value):
        one = self.variables[name]
        getattr(self.slave, f"set{one.type}")([one.valueReference], [value])

    def step(self, k, samples=1):
        self.slave.doStep(k * PERIOD_S, samples * PERIOD_S)


@pytest.fixture
def instance(fmu):
    """A part of a rig that FMPy has loaded; all are freed behind the test."""
    made = []

    def make(rig, part, **parameters) -> Instance:
        names = {name.replace("__", "."): value for name, value in parameters.items()}
        made.append(Instance(fmu(rig, part), names))
        return made[-1]

    yield make
    for one in made:
        one.slave.freeInstance()
