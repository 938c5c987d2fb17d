"""What takes time and cannot say how far it is shows the time that it has taken, to whoever watches."""

from __future__ import annotations

import time

import pytest

from tactsim import progress
from tactsim.progress import elapsed_time, quiet


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "is_watched", lambda: True)
    monkeypatch.setattr(progress, "TICK", 0.01)


def shown(capsys: pytest.CaptureFixture[str]) -> list[str]:
    with elapsed_time("meshing"):
        time.sleep(0.25)
    return [line for line in capsys.readouterr().err.split("\r") if "meshing" in line]


@pytest.mark.usefixtures("watched")
def test_the_time_goes_on_while_the_block_runs(capsys: pytest.CaptureFixture[str]) -> None:
    lines = shown(capsys)
    assert len(lines) > 1  # more than at its beginning
    assert lines[0].startswith("meshing [00:00]")


@pytest.mark.usefixtures("watched")
def test_a_quiet_run_shows_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with quiet():
        assert shown(capsys) == []
        with quiet(silent=False):
            assert shown(capsys)
    assert shown(capsys)


def test_nobody_watches_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    assert shown(capsys) == []


@pytest.mark.usefixtures("watched")
def test_the_clock_ends_with_an_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="no mesh"), elapsed_time("meshing"):
        raise ValueError("no mesh")
    capsys.readouterr()
    time.sleep(0.05)
    assert capsys.readouterr().err == ""
