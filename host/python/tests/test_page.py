"""The first steps of docs/howto/python.md, as they stand there."""

import re
from pathlib import Path
from typing import Any

import matplotlib
import pytest

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "python.md"

matplotlib.use("agg")


def test_the_first_steps_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    block = re.search(r"```python\n(import pneudrive\n.*?)```", PAGE.read_text(), re.DOTALL)
    assert block is not None
    names: dict[str, Any] = {}
    exec(block[1], names)
    assert (tmp_path / "run.png").stat().st_size > 0
    shown = re.search(r"settled_s +# (<.*>):", block[1])
    assert shown is not None and shown[1] == repr(names["run"].moves[1].settled_s)
    assert len(names["found"]["settling_s"]) == 3
