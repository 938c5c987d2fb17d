"""numba's cache is told of changes in files that a loop takes in."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest

from tactsim.outside.compiled_loops import forget_stale

INNER = "import numba\n\nSTEP = 1\n\n@numba.njit(cache=True)\ndef stepped(x):\n    return x + STEP\n"
OUTER = "import numba\nfrom inner import stepped\n\n@numba.njit(cache=True)\ndef twice(x):\n    return stepped(stepped(x))\n"


@pytest.fixture
def loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], tuple[ModuleType, ModuleType]]]:
    """Loads both modules as a process would that starts anew."""
    (tmp_path / "inner.py").write_text(INNER, encoding="utf-8")
    (tmp_path / "outer.py").write_text(OUTER, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def load() -> tuple[ModuleType, ModuleType]:
        for name in ("inner", "outer"):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        return importlib.import_module("inner"), importlib.import_module("outer")

    yield load
    for name in ("inner", "outer"):
        sys.modules.pop(name, None)


def test_a_loop_is_compiled_anew_if_one_that_it_calls_was_changed(
    tmp_path: Path, loaded: Callable[[], tuple[ModuleType, ModuleType]]
) -> None:
    inner, outer = loaded()
    forget_stale(outer.twice, inner)
    assert outer.twice(1) == 3
    inner, outer = loaded()
    forget_stale(outer.twice, inner)
    assert outer.twice(1) == 3
    assert sum(outer.twice.stats.cache_hits.values()) == 1, "what is as old as its source is kept"
    (tmp_path / "inner.py").write_text(INNER.replace("STEP = 1", "STEP = 5"), encoding="utf-8")
    later = (tmp_path / "inner.py").stat().st_mtime + 10
    os.utime(tmp_path / "inner.py", (later, later))
    inner, outer = loaded()
    forget_stale(outer.twice, inner)
    assert outer.twice(1) == 11
