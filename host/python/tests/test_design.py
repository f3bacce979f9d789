"""A rig from data sheets, its components on the bench, and its FMU."""

import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest

import pneudrive
from pneudrive import PneudriveError, Rig, RigError



def carry_out(command: Path, folder: Path, *arguments: str) -> None:
    subprocess.run([command, *arguments], cwd=folder, check=True, capture_output=True)


SHEET = {"bore": "32 mm", "rod": "12 mm", "stroke": "250 mm", "mass": "8 kg", "flow": "350 l/min, 6 to 5 bar(g)"}


def test_figures_of_data_sheets_make_the_rig_of_the_command(command: Path, tmp_path: Path) -> None:
    options = [word for name, text in SHEET.items() for word in (f"--{name}", text)]
    carry_out(command, tmp_path, "rig", "new", "own.toml", "--no-questions", *options)
    rig = Rig.new("own", **SHEET)
    assert rig.to_toml() == (tmp_path / "own.toml").read_text()
    assert rig.origin("load.mass_kg")[0] == "given"
    assert rig.with_(load__mass_kg=9).load.mass_kg == 9


def test_a_wrong_figure_is_told_with_figures_that_work() -> None:
    with pytest.raises(RigError, match="bore: needs a unit") as told:
        Rig.new("own", **{**SHEET, "bore": 32})  # type: ignore[arg-type]
    assert [problem.key for problem in told.value.problems] == ["bore"]
    assert 'this works: Rig.new("own", ' in str(told.value)
    with pytest.raises(TypeError, match="diameter is no figure of a drive; there are cylinder, bore"):
        Rig.new("own", diameter="32 mm")  # type: ignore[call-arg]


def test_each_question_has_an_example() -> None:
    asked = {question["name"]: question for question in pneudrive.questions()}
    assert set(SHEET) < set(asked)
    assert all(question["example"] for question in asked.values())


def test_a_component_on_the_bench_shows_what_the_command_writes(command: Path, rig: Rig, tmp_path: Path) -> None:
    rig.save(tmp_path / "own.toml")
    carry_out(command, tmp_path, "characterise", "own.toml", "friction", "--out", ".")
    lines = (tmp_path / "friction.csv").read_text().splitlines()[1:]
    found = rig.characterise("friction")
    values = np.concatenate([curve.y for curve in found.curves])
    written = np.array([float(line.rpartition(",")[2] or "nan") for line in lines])
    assert np.allclose(values, written, rtol=1e-5, atol=1e-9, equal_nan=True)
    assert "Fig. 7.10" in found.about
    assert all(figure.name and figure.within is not None for figure in found.figures if figure.value is not None)
    assert len(found.plot().axes) == len({curve.graph for curve in found.curves})


def test_a_curve_that_there_is_not_is_told_with_those_that_there_are(rig: Rig) -> None:
    with pytest.raises(ValueError, match='there is no curve "creep"; there are nominal-flow'):
        rig.characterise("creep")  # type: ignore[arg-type]
    with pytest.raises(PneudriveError, match="press has no "):
        Rig("press").characterise("land-area")


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_an_fmu_is_that_of_the_command(command: Path, rig: Rig, tmp_path: Path, fmi: str) -> None:
    heavy = rig.with_(load__mass_kg=3)
    heavy.export_fmu(tmp_path / "own.fmu", part="plant", fmi=fmi)  # type: ignore[arg-type]
    heavy.save(tmp_path / "own.toml")
    carry_out(command, tmp_path, "fmu", "own.toml", "--plant", "--fmi", fmi, "--out", "command.fmu")
    names: list[list[str]] = []
    for name in ("own.fmu", "command.fmu"):
        with zipfile.ZipFile(tmp_path / name) as archive:
            names.append(archive.namelist())
            assert b"load.mass_kg" in archive.read("modelDescription.xml")
            assert "mass_kg = 3" in archive.read("resources/rig.toml").decode()
    assert names[0] == names[1]
    with pytest.raises(FileExistsError, match="overwrite=True replaces it"):
        heavy.export_fmu(tmp_path / "own.fmu")
    heavy.export_fmu(tmp_path / "own.fmu", overwrite=True)


def test_what_cannot_be_an_fmu_is_told(rig: Rig, tmp_path: Path) -> None:
    (tmp_path / "no.so").write_bytes(b"no library")
    for wanted, says in (
        ({"part": "valve"}, 'part must be "drive", "plant" or "controller", is "valve"'),
        ({"fmi": "1.0"}, 'fmi must be "3.0" or "2.0", is "1.0"'),
        ({"library": tmp_path / "no.so"}, "no.so is not the library of FMUs"),
    ):
        with pytest.raises(Exception, match=says):
            rig.export_fmu(tmp_path / "own.fmu", **wanted)
    assert not (tmp_path / "own.fmu").exists()
