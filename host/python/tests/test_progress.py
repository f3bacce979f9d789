"""The progress bar: where somebody looks, and without tqdm."""

import sys

import pytest

from pneudrive import Rig, progress


def test_nobody_who_looks_is_shown_nothing(rig: Rig, capsys: pytest.CaptureFixture[str]) -> None:
    assert progress.bar("simulating", None) is None
    assert progress.bar("simulating", False) is None
    rig.simulate(ensemble=1)
    assert capsys.readouterr() == ("", "")


def test_a_bar_shows_what_is_done(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "DELAY_S", 0)
    bar = progress.bar("simulating", True)
    assert bar is not None
    for done in range(5):
        bar(done, 4)
    assert "simulating" in capsys.readouterr().err


def test_short_work_shows_no_bar(capsys: pytest.CaptureFixture[str]) -> None:
    bar = progress.bar("simulating", True)
    assert bar is not None
    for done in range(5):
        bar(done, 4)
    assert capsys.readouterr().err == ""


def test_without_tqdm_a_line_a_quarter_is_shown(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "_tqdm", lambda: None)
    monkeypatch.setattr(progress, "DELAY_S", 0)
    bar = progress.bar("sweeping", True)
    assert bar is not None
    for done in range(9):
        bar(done, 8)
    assert capsys.readouterr().err.splitlines() == [f"sweeping: {done} of 8" for done in (2, 4, 6, 8)]


def test_a_terminal_and_a_notebook_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert progress.bar("simulating", None) is not None
