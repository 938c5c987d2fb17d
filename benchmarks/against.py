"""This commit against an earlier one: whole commands, by turns, in one run; medians and their ratios.

python benchmarks/against.py [--base COMMIT] [--repeats 5] [NAME ...]
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from data_sets import STANDARD, samples_done

ROOT = Path(__file__).parents[1]
BASE = "26a5475"
REPEATS = 5
STANDARD_OPTIONS = tuple(part for value in STANDARD for part in ("--set", value))
"""Friction and closing of the figure that is asked for, each lump once; the sweep itself varies them."""


@dataclass(frozen=True)
class Job:
    """A command and what is asked: seconds for a run, whole or without its figures, or for a sweep of ``samples``, if there are
    any, how many are done per hour."""

    arguments: tuple[str, ...]
    asked: float
    samples: int = 0
    without_figures: bool = False
    most_repeats: int = REPEATS

    @property
    def is_sweep(self) -> bool:
        """Whether it makes a data set."""
        return self.samples > 0


def _run(case: str) -> tuple[str, ...]:
    return ("run", f"cases/{case}.yaml", "--quiet")


def _sweep(case: str, samples: int, asked: float, options: tuple[str, ...] = (), most_repeats: int = REPEATS) -> Job:
    arguments = ("sweep", f"cases/{case}.yaml", "--quiet", "--samples", str(samples), *options)
    return Job(arguments, asked, samples, most_repeats=most_repeats)


JOBS = {
    "annulus_icf": Job(_run("annulus_icf"), 5.0),
    "grasp_lump_icf": Job(_run("grasp_lump_icf"), 5.0, without_figures=True),
    "atrial_annulus": Job(_run("atrial_annulus"), 15.0),
    # So many that the seconds in which processes begin hardly count.
    "sweep_lumps": _sweep("sweep_lumps", 40, 4000.0, STANDARD_OPTIONS),
    # At the base many of its meshes are tetrahedra, and a turn takes many minutes.
    "sweep_classes": _sweep("sweep_classes", 20, 1000.0, most_repeats=1),
}


@dataclass(frozen=True)
class Spent:
    """What a command took in s: by the clock, and of processors.

    Attributes
    ----------
    case_seconds : from the case to the last state, if its result tells: without Python's start before it and the figures after it
    solving_seconds : those of them after the model was set up
    done : samples of a sweep that have a result
    """

    seconds: float
    processor_seconds: float
    case_seconds: float | None = None
    solving_seconds: float | None = None
    done: int | None = None

    @property
    def figure(self) -> float:
        """Seconds, or samples done per hour."""
        return self.seconds if self.done is None else 3600 * self.done / self.seconds


def measure(names: Sequence[str] = tuple(JOBS), base: str = BASE, repeats: int = REPEATS) -> dict[str, dict[str, float]]:
    """Medians of each job here and at the base, which take turns, after a run of each that compiles and makes its meshes."""
    figures: dict[str, dict[str, float]] = {}
    with _checkout(base) as earlier, tempfile.TemporaryDirectory() as work:
        for name in names:
            job = JOBS[name]
            taken: dict[str, list[Spent]] = {"base": [], "here": []}
            for turn in range(min(repeats, job.most_repeats) + 1):
                for side, place in (("base", earlier), ("here", ROOT)):
                    spent = _spent(job, place, Path(work) / side, f"{name}_{turn}")
                    if turn:
                        taken[side].append(spent)
            figures[name] = _summed_up(taken)
    return figures


def _summed_up(taken: dict[str, list[Spent]]) -> dict[str, float]:
    """Medians of both sides, and how many times as fast this commit is."""
    figures: dict[str, float] = {}
    for side, runs in taken.items():
        figures |= {side: median(spent.figure for spent in runs), f"{side}_seconds": median(spent.seconds for spent in runs)}
        figures[f"{side}_processor_seconds"] = median(spent.processor_seconds for spent in runs)
        for name in ("case_seconds", "solving_seconds", "done"):
            values = [getattr(spent, name) for spent in runs]
            if None not in values:
                figures[f"{side}_{name}"] = float(median(values))
    faster = figures["base"] / figures["here"]
    figures["ratio"] = 1 / faster if "here_done" in figures else faster
    return figures


@contextmanager
def _checkout(commit: str) -> Iterator[Path]:
    """The files of a commit in a folder of their own, which is removed at the end."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "base"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", str(place), commit], check=True)
        try:
            yield place
        finally:
            subprocess.run([*git, "remove", "--force", str(place)], check=True)


def _spent(job: Job, place: Path, work: Path, name: str) -> Spent:
    """One run of a job with the package of a place; its caches are its own."""
    work.mkdir(exist_ok=True)
    environment = {
        **os.environ,
        "PYTHONPATH": str(place),
        "NUMBA_CACHE_DIR": str(work / "compiled"),
        "XDG_CACHE_HOME": str(work / "cache"),
    }
    out = work / name
    command = [sys.executable, "-m", "tactsim.cli", *job.arguments, "--out", str(out)]
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(command, cwd=place, env=environment, check=False, capture_output=True, text=True)
    seconds, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in ((0, 3) if job.is_sweep else (0,)):  # samples that failed are counted in the store
        raise RuntimeError(f"{' '.join(command)} in {place} ended with {done.returncode}: {done.stderr[-500:]}")
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if job.is_sweep:
        return Spent(seconds, used, done=samples_done(out))
    timing = json.loads((out / "result.json").read_text())["timing"]
    return Spent(seconds, used, timing["total"], timing["total"] - timing["setup"])


def rows(figures: dict[str, dict[str, float]]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured here and at the base."""
    return [_row(name, JOBS[name], taken) for name, taken in figures.items()]


def _row(name: str, job: Job, taken: dict[str, float]) -> tuple[str, str, str]:
    if job.is_sweep:
        what = f"`{name}.yaml` by turns, {taken['here_done']:.0f} of {job.samples} samples done"
        rates = [f"{taken[side]:.0f} per hour" for side in ("here", "base")]
        return what, f"{job.asked:.0f} per hour", f"{rates[0]}, {taken['ratio']:.1f} times as many as {BASE} ({rates[1]})"
    what, kind = ("to the last state", "_case") if job.without_figures else ("whole command", "")
    here, base = (taken[f"{side}{kind}_seconds"] for side in ("here", "base"))
    solving = " and ".join(f"{taken[f'{side}_solving_seconds']:.1f}" for side in ("here", "base"))
    faster = f"{base / here:.1f} times as fast as {BASE} ({base:.1f} s); {solving} s of them solving"
    whole = f", {taken['here_seconds']:.1f} s with all figures" if job.without_figures else ""
    return f"`{name}.yaml`, {what}", f"{job.asked:g} s", f"{here:.2f} s, {faster}{whole}"


def main() -> None:
    """Print figures as JSON and as a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", metavar="NAME", nargs="*", default=list(JOBS), help=f"of {', '.join(JOBS)}; all by default")
    parser.add_argument("--base", default=BASE, help="commit to compare with; default: %(default)s")
    parser.add_argument("--repeats", type=int, default=REPEATS, help="runs of each at most; default: %(default)s")
    arguments = parser.parse_args()
    figures = measure(arguments.names, arguments.base, arguments.repeats)
    table = "\n".join(f"| {' | '.join(row)} |" for row in rows(figures))
    sys.stdout.write(f"{json.dumps(figures, indent=2)}\n\n{table}\n")


if __name__ == "__main__":
    main()
