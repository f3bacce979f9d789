"""The notebooks run from their first cell to their last, and keep the types of the package."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

PACKAGE = Path(__file__).parents[1]
NOTEBOOKS = sorted((PACKAGE / "notebooks").glob("*.ipynb"))


def read(path: Path) -> Any:
    return nbformat.reads(path.read_text(), as_version=4)  # type: ignore[no-untyped-call]


def test_there_are_notebooks() -> None:
    assert [notebook.stem for notebook in NOTEBOOKS] == ["identify", "lqr", "own-drive", "sweep"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path, tmp_path: Path) -> None:
    notebook = read(path)
    assert all(not cell.get("outputs") for cell in notebook.cells), "clear its outputs before it is committed"
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    printed = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any(output["output_type"] == "execute_result" for output in printed)
    assert [output["text"] for output in printed if output.get("name") == "stderr"] == []


def test_notebooks_keep_the_types(tmp_path: Path) -> None:
    for path in NOTEBOOKS:
        cells = [cell.source for cell in read(path).cells if cell.cell_type == "code"]
        (tmp_path / f"{path.stem.replace('-', '_')}.py").write_text("\n".join(cells))
    mypy = [sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", str(tmp_path)]
    checked = subprocess.run(mypy, cwd=PACKAGE, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout
