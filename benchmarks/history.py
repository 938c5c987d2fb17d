"""The figures of every report in one table, ``history.csv``: commit, machine, figure, value; and a picture of it.

python benchmarks/history.py [--out history.png] [--figures PATTERN]
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from fnmatch import fnmatch
from pathlib import Path

import matplotlib
import pandas as pd

matplotlib.use("agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).parents[1]
HISTORY = Path(__file__).parent / "history.csv"
COLUMNS = ("date", "commit", "machine", "figure", "value")
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


def flat(figures: Mapping[str, object], above: str = "") -> dict[str, float]:
    """Numbers of nested figures, by their names joined with points."""
    numbers: dict[str, float] = {}
    for name, value in figures.items():
        path = f"{above}{name}"
        if isinstance(value, Mapping):
            numbers |= flat(value, f"{path}.")
        elif isinstance(value, (int, float)):
            numbers[path] = float(value)
    return numbers


def append(figures: Mapping[str, object]) -> None:
    """Add the figures of this commit, which is marked with a plus sign if files differ from it."""
    git = lambda *words: subprocess.run(  # noqa: E731
        ["git", "-C", str(ROOT), *words], check=True, capture_output=True, text=True
    ).stdout.strip()
    commit = git("rev-parse", "--short", "HEAD") + (
        "+" if git("status", "--porcelain", "--untracked-files=no", "tactsim") else ""
    )
    day = git("log", "-1", "--format=%cs")
    lines = pd.DataFrame(
        [(day, commit, machine(), name, f"{value:.6g}") for name, value in flat(figures).items()], columns=list(COLUMNS)
    )
    lines.to_csv(HISTORY, mode="a", header=not HISTORY.exists(), index=False)


def draw(out: Path, patterns: tuple[str, ...] = SHOWN) -> None:
    """One panel for each figure that fits a pattern: its value at each commit, a line for each machine."""
    table = pd.read_csv(HISTORY, dtype={"commit": str})
    table = table[[any(fnmatch(name, pattern) for pattern in patterns) for name in table["figure"]]]
    if table.empty:
        raise SystemExit(f"{HISTORY.name} has no figure that fits {', '.join(patterns)}")
    names = list(dict.fromkeys(table["figure"]))
    commits = list(dict.fromkeys(table["commit"]))
    columns = min(3, len(names))
    lines = -(-len(names) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(4.2 * columns, 2.6 * lines), squeeze=False, layout="constrained")
    for ax, name in zip(axes.flat, names, strict=False):
        for machine_name, rows in table[table["figure"] == name].groupby("machine", sort=False):
            ax.plot([commits.index(commit) for commit in rows["commit"]], rows["value"], "o-", label=machine_name)
        ax.set_title(name, fontsize=9)
        ax.set_ylim(bottom=0)
        ax.set_xticks(range(len(commits)), commits, rotation=45, ha="right", fontsize=7)
    for ax in axes.flat[len(names) :]:
        ax.set_axis_off()
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", fontsize=8)
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
