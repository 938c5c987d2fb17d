"""The figures of every report in one table, ``history.csv``: commit, machine, figure, value; and a picture of it.

A value is a number, or a word where there is none: the version of another program, or that it is not installed. What is asked
stands in the code of the benchmarks.

python benchmarks/history.py [--out history.png] [--figures PATTERN]
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import time
from collections.abc import Mapping
from fnmatch import fnmatch
from pathlib import Path

import matplotlib
import pandas as pd

matplotlib.use("agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

ROOT = Path(__file__).parents[1]
HISTORY = Path(__file__).parent / "history.csv"
COLUMNS = ("date", "commit", "machine", "figure", "value")
MEASURED = ("tactsim", "cases")
"""Folders whose files decide what is measured."""
SHOWN = ("against.*.here_seconds", "stretch.*.seconds", "peers.*_ratio", "data_sets.grasps_per_hour")
"""What the picture shows by default."""


def machine() -> str:
    """Cores, processor and Python, in words that name nobody."""
    model = "unknown processor"
    listing = Path("/proc/cpuinfo")
    if listing.exists():
        names = [line.split(":", 1)[1].strip() for line in listing.read_text().splitlines() if line.startswith("model name")]
        model = names[0] if names else model
    return f"{os.cpu_count()} x {model}, Python {platform.python_version()}"


def today() -> str:
    """The day of a measurement."""
    return time.strftime("%Y-%m-%d")


def commit() -> str:
    """The commit that is measured, marked with a plus sign if the package or a case differs from it."""
    return _git("rev-parse", "--short", "HEAD") + _difference()


def package() -> str:
    """Identity of the package and the cases, which commits of other files leave as it is."""
    return " ".join(_git("rev-parse", "--short", f"HEAD:{folder}") for folder in MEASURED) + _difference()


def _difference() -> str:
    return "+" if _git("status", "--porcelain", "--untracked-files=no", *MEASURED) else ""


def _git(*words: str) -> str:
    done = subprocess.run(["git", "-C", str(ROOT), *words], check=True, capture_output=True, text=True)
    return done.stdout.strip()


def flat(figures: Mapping[str, object], above: str = "") -> dict[str, float | str]:
    """Numbers and words of nested figures, by their names joined with points."""
    values: dict[str, float | str] = {}
    for name, value in figures.items():
        path = f"{above}{name}"
        if isinstance(value, Mapping):
            values |= flat(value, f"{path}.")
        elif isinstance(value, (int, float)):
            values[path] = float(value)
        elif isinstance(value, str):
            values[path] = value
    return values


def append(figures: Mapping[str, object]) -> None:
    """Add the figures of this commit."""
    origin = (_git("log", "-1", "--format=%cs"), commit(), machine())
    lines = [(*origin, name, value if isinstance(value, str) else f"{value:.6g}") for name, value in flat(figures).items()]
    pd.DataFrame(lines, columns=list(COLUMNS)).to_csv(HISTORY, mode="a", header=not HISTORY.exists(), index=False)


def draw(out: Path, patterns: tuple[str, ...] = SHOWN) -> None:
    """One panel for each figure that fits a pattern: its value at each commit, a line for each machine."""
    table = pd.read_csv(HISTORY, dtype={"commit": str, "value": str})
    table = table[[any(fnmatch(name, pattern) for pattern in patterns) for name in table["figure"]]]
    table = table.assign(value=pd.to_numeric(table["value"], errors="coerce")).dropna(subset="value")
    if table.empty:
        raise SystemExit(f"{HISTORY.name} has no figure that fits {', '.join(patterns)}")
    names = list(dict.fromkeys(table["figure"]))
    commits = list(dict.fromkeys(table["commit"]))
    colours = {name: f"C{number}" for number, name in enumerate(dict.fromkeys(table["machine"]))}
    columns = min(3, len(names))
    height = -(-len(names) // columns)
    figure, axes = plt.subplots(height, columns, figsize=(4.2 * columns, 2.6 * height), squeeze=False, layout="constrained")
    for ax, name in zip(axes.flat, names, strict=False):
        for machine_name, rows in table[table["figure"] == name].groupby("machine", sort=False):
            ax.plot([commits.index(name) for name in rows["commit"]], rows["value"], "o-", color=colours[machine_name])
        ax.set_title(name, fontsize=9)
        ax.set_xlim(-0.5, len(commits) - 0.5)
        ax.set_ylim(0, 1.1 * table["value"][table["figure"] == name].max())
        ax.set_xticks(range(len(commits)), commits, rotation=45, ha="right", fontsize=7)
    for ax in axes.flat[len(names) :]:
        ax.set_axis_off()
    lines = [Line2D([], [], color=colour, marker="o", label=name) for name, colour in colours.items()]
    figure.legend(handles=lines, loc="outside lower center", fontsize=8)
    figure.savefig(out, dpi=120)
    plt.close(figure)


def main() -> None:
    """Draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HISTORY.with_suffix(".png"), help="default: %(default)s")
    parser.add_argument("--figures", metavar="PATTERN", nargs="+", default=list(SHOWN), help="default: %(default)s")
    arguments = parser.parse_args()
    draw(arguments.out, tuple(arguments.figures))
    sys.stdout.write(f"{arguments.out}\n")


if __name__ == "__main__":
    main()
