"""The whole of ``tactsim validate`` from nothing: no kept study, no made mesh; the element loops are compiled. Prints JSON.

python benchmarks/validate.py [TABLE ...]

All tables, the default, take four to six minutes of two idle cores.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
ASKED = 480.0
"""Seconds."""
DIFFERENT = 4
"""Exit code when a row does not end as recorded."""


def measure(tables: Sequence[str] = ()) -> dict[str, float]:
    """Seconds by the clock and of processors, rows, and how many of them did not end as recorded."""
    with tempfile.TemporaryDirectory() as place:
        environment = {**os.environ, "XDG_CACHE_HOME": f"{place}/cache"}
        command = [sys.executable, "-m", "tactsim.cli", "validate", *tables, "--out", f"{place}/out"]
        begin = time.perf_counter()
        child = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        seconds = time.perf_counter() - begin
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in (0, DIFFERENT):
            raise RuntimeError(f"{' '.join(command)} ended with {child.returncode}")
        groups = json.loads(Path(place, "out", "validation.json").read_text(encoding="utf-8"))["groups"].values()
    totals = [group["counts"][-1] for group in groups]
    return {
        "from_nothing_seconds": seconds,
        "from_nothing_processor_seconds": used.ru_utime + used.ru_stime,
        "rows": float(sum(int(total["rows"].split()[0]) for total in totals)),
        "rows_left": float(sum(total["left"] for total in totals)),
    }


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """The row of the performance table: what, what is asked, what was measured."""
    ended = "each as recorded" if taken["rows_left"] == 0 else f"{taken['rows_left']:.0f} not as recorded"
    measured = f"{taken['from_nothing_seconds']:.0f} s, {taken['from_nothing_processor_seconds']:.0f} s of processors"
    return [(f"`tactsim validate`, nothing kept: {taken['rows']:.0f} rows, {ended}", f"{ASKED:g} s", measured)]


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure(sys.argv[1:]), indent=2) + "\n")
