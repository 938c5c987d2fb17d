"""Processor time of pictures and of short commands: what a user waits for beside the computation.

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
DRAWN = {"grasp_lump_icf": 2.5, "annulus_icf": 1.0}
"""Cases, and seconds in which all their pictures are to be drawn."""
DRAWING = """
import resource, sys
from pathlib import Path
from tactsim.cli.figures.result_figures import rendered_figures
from tactsim.results import read_result

def spent():
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))

result, begin = read_result(Path(sys.argv[1])).result, spent()
figures, warnings = rendered_figures(result)
assert figures and not warnings, warnings
print(spent() - begin)
"""
"""The loading of matplotlib included, as a run draws once."""


def commands(place: Path) -> dict[str, tuple[list[str], int, float]]:
    """What is asked of a process, its exit code, and the seconds that it may take, by name."""
    case = lambda name: str(ROOT / "cases" / f"{name}.yaml")  # noqa: E731
    run = lambda name: ["run", case(name), "--quiet", "--force", "--out", str(place / f"run_{name}")]  # noqa: E731
    return {
        "misspelt_case": (["run", case("grasp_plain"), "--set", "experiment.blok=1"], 2, 0.7),
        "closed_form": (run("annulus_dynamic_load"), 0, 2.0),
        "film_test": (run("film_lingstat"), 0, 2.0),
        "material": (["material", "icf_stable"], 0, 1.0),
        "help": (["--help"], 0, 0.15),
        "show": (["show", str(place / "annulus_icf")], 0, 1.0),
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


def _drawing_seconds(result: Path) -> float:
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    arguments = [sys.executable, "-c", DRAWING, str(result)]
    done = subprocess.run(arguments, cwd=ROOT, env=environment, capture_output=True, check=True, text=True)
    return float(done.stdout)


def measure() -> dict[str, float]:
    """Medians of processor seconds, ``..._seconds``, each with what was asked for, ``..._asked``."""
    taken: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        for name, asked in DRAWN.items():
            case = str(ROOT / "cases" / f"{name}.yaml")
            command = ["-m", "tactsim.cli", "run", case, "--quiet", "--figures", "none", "--out", str(place / name)]
            _processor_seconds(command, 0)
            taken[f"{name}_seconds"] = median(_drawing_seconds(place / name) for _ in range(REPEATS))
            taken[f"{name}_asked"] = asked
        for name, (arguments, code, asked) in commands(place).items():
            command = ["-m", "tactsim.cli", *arguments]
            taken[f"{name}_seconds"] = median(_processor_seconds(command, code) for _ in range(REPEATS))
            taken[f"{name}_asked"] = asked
    return taken


WORDS = {
    "grasp_lump_icf": "all pictures of `grasp_lump_icf.yaml`",
    "annulus_icf": "all pictures of `annulus_icf.yaml`",
    "misspelt_case": "a misspelt case, refused",
    "closed_form": "`annulus_dynamic_load.yaml` with its picture",
    "film_test": "`film_lingstat.yaml` with its pictures",
    "material": "`tactsim material icf_stable`",
    "help": "`tactsim --help`",
    "show": "`tactsim show` of a stored result",
}


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the table: what, what was asked, what was measured."""
    return [
        (f"{words}, processor time", f"{taken[f'{name}_asked']:g} s", f"{taken[f'{name}_seconds']:.2f} s")
        for name, words in WORDS.items()
    ]


if __name__ == "__main__":
    figures = measure()
    lines = ["| what | asked | measured |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows(figures))]
    sys.stdout.write(json.dumps(figures, indent=2) + "\n\n" + "\n".join(lines) + "\n")
