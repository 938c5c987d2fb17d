"""Whole commands as a user runs them: first run with compilation, later runs, start-up."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[1]
CASES = (
    "annulus_icf",
    "annulus_b1a",
    "annulus_icf_printed",
    "annulus_b1a_printed",
    "atrial_annulus",
    "design_annulus",
    "dma_atrial",
)


def _seconds(arguments: list[str], environment: dict[str, str]) -> tuple[float, int]:
    begin = time.perf_counter()
    done = subprocess.run([sys.executable, "-m", "tactsim.cli", *arguments], env=environment, capture_output=True, check=False)
    return time.perf_counter() - begin, done.returncode


def measure() -> dict[str, float]:
    """Seconds of the first and a later main job, of every other case, and of ``--help`` (median of five)."""
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as place:
        environment = {**os.environ, "NUMBA_CACHE_DIR": f"{place}/compiled"}
        main = ["run", str(ROOT / "cases" / "annulus_icf.yaml"), "--quiet", "--out"]
        seconds["first_run_seconds"], _ = _seconds([*main, f"{place}/first"], environment)
        seconds["later_run_seconds"] = median(_seconds([*main, f"{place}/{k}"], environment)[0] for k in "abc")
        for case in CASES[1:]:
            arguments = ["run", str(ROOT / "cases" / f"{case}.yaml"), "--quiet", "--out", f"{place}/{case}"]
            seconds[f"{case}_seconds"], seconds[f"{case}_exit_code"] = _seconds(arguments, environment)
        seconds["help_seconds"] = median(_seconds(["--help"], environment)[0] for _ in range(5))
    return seconds
