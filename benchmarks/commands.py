"""Whole commands as a user runs them: the first run with its compilation, and shipped cases that no other part measures.

``annulus_icf`` and ``atrial_annulus`` once compiled are parts of ``against.py``, ``tactsim --help`` is one of ``figures.py``.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
FIRST = "annulus_icf"
CASES = ("annulus_b1a", "annulus_icf_printed", "annulus_b1a_printed", "design_annulus", "dma_atrial")


def _seconds(arguments: list[str], environment: dict[str, str]) -> tuple[float, int]:
    begin = time.perf_counter()
    done = subprocess.run([sys.executable, "-m", "tactsim.cli", *arguments], env=environment, capture_output=True, check=False)
    return time.perf_counter() - begin, done.returncode


def measure() -> dict[str, float]:
    """Seconds of the first main job and then of every other case, with exit codes."""
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as place:
        environment = {**os.environ, "NUMBA_CACHE_DIR": f"{place}/compiled"}
        for case in (FIRST, *CASES):
            arguments = ["run", str(ROOT / "cases" / f"{case}.yaml"), "--quiet", "--out", f"{place}/{case}"]
            name = "first_run" if case == FIRST else case
            seconds[f"{name}_seconds"], seconds[f"{name}_exit_code"] = _seconds(arguments, environment)
    return seconds


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured."""
    first = (f"first run of `{FIRST}.yaml`, compilation included", "60 s", f"{taken['first_run_seconds']:.1f} s")
    others = [
        (f"`{name}.yaml`", "120 s", f"{taken[f'{name}_seconds']:.1f} s (exit {taken[f'{name}_exit_code']:.0f})") for name in CASES
    ]
    return [first, *others]
