"""Time of pictures, on two cores and of the processors, and of short commands: what a user waits for beside the computation.

python benchmarks/figures.py
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[1]
REPEATS = 5
DRAWN = ("grasp_lump_icf", "annulus_icf")
"""Cases whose pictures are drawn."""
DRAWING = """
import resource, sys, time
from pathlib import Path
from tactsim.cli.figures.result_figures import rendered_figures
from tactsim.results import read_result

def spent():
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))

result, begin, since = read_result(Path(sys.argv[1])).result, spent(), time.perf_counter()
figures, warnings = rendered_figures(result)
assert figures and not warnings, warnings
print(spent() - begin, time.perf_counter() - since)
"""
"""The loading of matplotlib included, as a run draws once. The view in space is rendered beside the other pictures."""


def commands(place: Path) -> dict[str, tuple[list[str], int]]:
    """What a process is to do, and its exit code, by name."""
    case = lambda name: str(ROOT / "cases" / f"{name}.yaml")  # noqa: E731
    run = lambda name: ["run", case(name), "--quiet", "--force", "--out", str(place / f"run_{name}")]  # noqa: E731
    return {
        "misspelt_case": (["run", case("grasp_plain"), "--set", "experiment.blok=1"], 2),
        "closed_form": (run("annulus_dynamic_load"), 0),
        "film_test": (run("film_lingstat"), 0),
        "material": (["material", "icf_stable"], 0),
        "help": (["--help"], 0),
        "show": (["show", str(place / "annulus_icf")], 0),
    }


def _spent() -> float:
    """Seconds of processor time, user and system, of all children that have ended, and of theirs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _processor_seconds(arguments: list[str], code: int) -> float:
    environment, begin = {**os.environ, "OMP_NUM_THREADS": "1"}, _spent()
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, env=environment, capture_output=True, check=False, text=True)
    if done.returncode != code:
        raise RuntimeError(f"{arguments} ended with {done.returncode} instead of {code}: {done.stderr}")
    return _spent() - begin


def _drawing_seconds(result: Path) -> tuple[float, float]:
    """Of the processors, and elapsed."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    arguments = [sys.executable, "-c", DRAWING, str(result)]
    done = subprocess.run(arguments, cwd=ROOT, env=environment, capture_output=True, check=True, text=True)
    spent, elapsed = map(float, done.stdout.split())
    return spent, elapsed


def measure() -> dict[str, float]:
    """Medians of processor seconds, ``..._seconds``; of pictures those that elapsed too, ``..._elapsed_seconds``."""
    taken: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        for name in DRAWN:
            case = str(ROOT / "cases" / f"{name}.yaml")
            command = ["-m", "tactsim.cli", "run", case, "--quiet", "--figures", "none", "--out", str(place / name)]
            _processor_seconds(command, 0)
            both = zip(*(_drawing_seconds(place / name) for _ in range(REPEATS)), strict=True)
            taken[f"{name}_seconds"], taken[f"{name}_elapsed_seconds"] = map(median, both)
        for name, (arguments, code) in commands(place).items():
            command = ["-m", "tactsim.cli", *arguments]
            taken[f"{name}_seconds"] = median(_processor_seconds(command, code) for _ in range(REPEATS))
    return taken


ASKED = {
    "grasp_lump_icf": ("all pictures of `grasp_lump_icf.yaml`", 2.5),
    "annulus_icf": ("all pictures of `annulus_icf.yaml`", 1.0),
    "misspelt_case": ("a misspelt case, refused", 0.7),
    "closed_form": ("`annulus_dynamic_load.yaml` with its picture", 2.0),
    "film_test": ("`film_lingstat.yaml` with its pictures", 2.0),
    "material": ("`tactsim material icf_stable`", 1.0),
    "help": ("`tactsim --help`", 0.15),
    "show": ("`tactsim show` of a stored result", 1.0),
}
"""What is done, and the time in s that is asked: of pictures that which elapses, of the rest that of the processor."""


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured."""
    table = []
    for name, (words, asked) in ASKED.items():
        spent = f"{taken[f'{name}_seconds']:.2f} s"
        if name in DRAWN:
            table.append((words, f"{asked:g} s", f"{taken[f'{name}_elapsed_seconds']:.2f} s, {spent} of processors"))
        else:
            table.append((f"{words}, processor time", f"{asked:g} s", spent))
    return table


if __name__ == "__main__":
    figures = measure()
    lines = ["| what | asked | measured |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows(figures))]
    sys.stdout.write(json.dumps(figures, indent=2) + "\n\n" + "\n".join(lines) + "\n")
