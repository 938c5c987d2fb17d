"""Compiling of loops is followed: said once where it happens, counted, and not where a cache holds them."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from pathlib import Path

import numba
import pytest

import tactsim.fem.compiling
from tactsim import progress
from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.interfaces import run
from tactsim.progress import COMPILING, Compilation, noted_by, quiet

SOURCE = "import numba\n\n@numba.njit(cache=True)\ndef doubled(x):\n    return 2 * x\n"


@pytest.fixture
def compilation(monkeypatch: pytest.MonkeyPatch) -> Compilation:
    fresh = Compilation()
    monkeypatch.setattr(progress, "COMPILATION", fresh)
    monkeypatch.setattr(tactsim.fem.compiling, "COMPILATION", fresh)
    return fresh


def doubled(folder: Path) -> Callable[[int], int]:
    """A loop of a module that numba has not met in this process."""
    described = importlib.util.spec_from_file_location("loops", folder / "loops.py")
    module = importlib.util.module_from_spec(described)
    described.loader.exec_module(module)
    return module.doubled


def test_compiling_is_said_once_and_counted_and_a_cached_loop_is_not(tmp_path: Path, compilation: Compilation) -> None:
    (tmp_path / "loops.py").write_text(SOURCE, encoding="utf-8")
    notes: list[str] = []
    with noted_by(notes.append):
        loop = doubled(tmp_path)
        assert loop(2) == 4
        took = compilation.seconds
        assert took > 0
        assert numba.njit(lambda x: 3 * x)(2) == 6
        assert notes == [COMPILING]
        took = compilation.seconds
        assert doubled(tmp_path)(2) == 4
        assert compilation.seconds == took, "numba's cache held it"


def test_every_run_that_compiles_says_so(compilation: Compilation, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the first grasp after an indentation, whose loops in space took half a minute without a word."""
    monkeypatch.setattr(run, "COMPILATION", compilation)
    notes: list[str] = []
    with noted_by(notes.append):
        for _ in range(2):
            ClosedForm.example().run(None)
            for _ in range(2):
                compilation.begin()
                compilation.end()
    assert notes == [COMPILING, COMPILING]


def test_whom_a_run_does_not_report_to_is_not_told(compilation: Compilation, capsys: pytest.CaptureFixture[str]) -> None:
    with quiet():
        compilation.begin()
        compilation.end()
    assert capsys.readouterr().err == ""
    with noted_by(print):
        compilation.begin()
        compilation.end()
    assert capsys.readouterr().out == f"{COMPILING}\n"


def test_loops_within_loops_count_once(compilation: Compilation, monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([10.0, 14.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(times))
    compilation.begin()
    compilation.begin()
    compilation.end()
    compilation.end()
    assert compilation.seconds == 4.0
