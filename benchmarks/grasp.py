"""The default grasp as a user runs it: seconds from the case file to the taxels, peak memory, Newton iterations.

python benchmarks/grasp.py [CASE ...]
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
MEBIBYTE = 1024
"""Kibibytes, the unit of the peak memory of a child."""
WATCH = """
import os, subprocess, sys
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
_, status, used = os.wait4(child.pid, 0)
child.returncode = os.waitstatus_to_exitcode(status)
print(child.returncode, used.ru_maxrss)
"""
"""A process between: the peak of a child begins with what its parent holds, and other parts of the report have held much."""


def measure(case: str = "grasp_lump_icf") -> dict[str, float]:
    """Seconds of the whole command and of its parts, peak memory in MB of the process, unknowns and iterations."""
    with tempfile.TemporaryDirectory() as place:
        command = ["run", str(ROOT / "cases" / f"{case}.yaml"), "--quiet", "--out", f"{place}/out"]
        begin = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", WATCH, sys.executable, "-m", "tactsim.cli", *command],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        seconds = time.perf_counter() - begin
        exit_code, peak = map(int, done.stdout.split())
        result = json.loads((Path(place) / "out" / "result.json").read_text())
    return {
        "seconds": seconds,
        "exit_code": exit_code,
        "peak_megabytes": peak / MEBIBYTE,
        "unknowns": result["quantities"]["unknowns"]["value"],
        "steps": len(result["steps"]),
        "iterations": sum(step["newton_iterations"] for step in result["steps"]),
        **{f"{name}_seconds": value for name, value in result["timing"].items()},
    }


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """The row of the performance table: what, what is asked, what was measured; its seconds are a row of ``against.py``."""
    unknowns = f"{taken['unknowns']:,.0f}".replace(",", " ")
    return [(f"memory of `grasp_lump_icf.yaml`, {unknowns} unknowns", "2 GB", f"{taken['peak_megabytes'] / 1000:.2f} GB")]


if __name__ == "__main__":
    sys.stdout.write(json.dumps({case: measure(case) for case in sys.argv[1:] or ["grasp_lump_icf"]}, indent=2) + "\n")
