"""Programs that may be absent: measured, or reported with the reason; none is imported here."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
LIMIT = 60.0
"""Seconds that none of the programs below needs, but the one that is stopped."""


@pytest.fixture
def peers(monkeypatch) -> ModuleType:
    monkeypatch.syspath_prepend(BENCHMARKS)
    return importlib.import_module("peers")


@pytest.fixture
def runs(peers, monkeypatch, tmp_path) -> ModuleType:
    """The module with a system's Python that has GetFEM, by the name of a module that it does have."""
    monkeypatch.setattr(peers.peer_runs, "PROGRAMS", tmp_path)
    monkeypatch.setattr(peers.peer_runs, "SYSTEM_PYTHON", sys.executable)
    monkeypatch.setattr(peers.peer_runs, "MODULES", {"getfem": "json"})
    return peers.peer_runs


def outcome(runs: ModuleType, place: Path, text: str, limit: float = LIMIT) -> object:
    """What comes of a program of that text."""
    (place / "getfem_block.py").write_text(text)
    return runs.optional(place, "getfem", place / "problem.npz", limit)


def test_program_that_measures_is_read(runs, tmp_path):
    measured = outcome(runs, tmp_path, "import sys, numpy\nnumpy.savez(sys.argv[-1], unknowns=7)")
    assert measured["unknowns"] == 7


def test_absent_module_is_reported(runs, monkeypatch, tmp_path):
    monkeypatch.setattr(runs, "MODULES", {"getfem": "module_that_nobody_has"})
    assert outcome(runs, tmp_path, "raise SystemExit('must not run')") == "not installed"


@pytest.mark.parametrize("program", ["getfem", "fenicsx"])
def test_absent_system_python_is_reported(peers, monkeypatch, tmp_path, program):
    monkeypatch.setattr(peers.peer_runs, "SYSTEM_PYTHON", str(tmp_path / "python3"))
    assert peers.peer_runs.optional(tmp_path, program, tmp_path / "problem.npz", LIMIT) == "not installed"


def test_absent_command_is_reported(peers, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert peers.peer_runs.optional(tmp_path, "calculix", tmp_path / "problem.npz", LIMIT) == "not installed"


def test_failure_is_reported_with_its_reason_in_a_line_and_whole_beside_it(runs, tmp_path, capsys):
    assert outcome(runs, tmp_path, "raise SystemExit('first\\nno memory left')") == "failed: no memory left"
    assert "first\nno memory left" in capsys.readouterr().err


def test_result_of_an_earlier_run_is_not_taken_for_a_new_one(runs, tmp_path):
    np.savez(tmp_path / "getfem.npz", unknowns=7)
    assert outcome(runs, tmp_path, "pass") == "failed: getfem wrote no result"


def test_halt_is_reported_with_its_limit(runs, tmp_path):
    assert outcome(runs, tmp_path, "import time\ntime.sleep(60)", 0.2) == "stopped after 0.2 s"


def test_table_has_a_row_for_every_program(peers):
    columns = ("seconds", "processor_seconds", "setup_seconds", "iterations", "factorisations", "peak_megabytes")
    figures = {f"9_{program}_{column}": 1.0 for program in ("tactsim", "felupe", "fenicsx") for column in columns}
    figures |= {"9_calculix": "stopped after 5 s", "9_getfem": "not installed", "9_fenicsx_difference_from_felupe": 2e-9}
    figures |= {"9_ratio": 4.0, "agreement_largest_difference": 1e-5, "agreement_unknowns": 9.0}
    text = peers.table(figures | {"load_average_before": 0.0, "load_average_after": 0.0})
    assert "| 9 | calculix | stopped after 5 s |" in text
    assert "| 9 | getfem | not installed |" in text
    assert "| 9 | fenicsx | 1 | 1 | 1 | 1 | 1 | 1 |" in text
    assert "9: fenicsx and FElupe, displacement forms, differ by 2.0e-09" in text
