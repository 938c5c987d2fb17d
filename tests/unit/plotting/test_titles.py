"""Titles of users stand in figures letter by letter."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.cli import main


def test_a_title_is_drawn_as_it_is_written_not_as_tex(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = Path(__file__).parents[3] / "cases" / "annulus_dynamic_load.yaml"
    assert main(["run", str(case), "--out", str(tmp_path / "r"), "--set", r"title=$x_$ \frac{"]) == 0
    assert list((tmp_path / "r" / "figures").glob("*.png"))
    assert "warning" not in capsys.readouterr().err
