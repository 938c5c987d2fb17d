"""Runs the benchmarks, prints them as JSON and as a table, and writes the README's performance table.

python benchmarks/report.py [--readme] [--peers [FILE]] [--history] [--kept FILE]
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from pathlib import Path

import against
import assembly
import commands
import data_sets
import figures as pictures
import grasp
import history
import localization
import peers
import sensor_chain
import stretch
import viscoelasticity

README = Path(__file__).parents[1] / "README.md"
START = "<!-- performance table: written by `python benchmarks/report.py --readme` -->"
END = "<!-- end of performance table -->"
PARTS = (assembly, viscoelasticity, commands, pictures, grasp, sensor_chain, localization, data_sets, against, stretch)


def table(figures: dict[str, dict[str, float]]) -> str:
    """Markdown table of what was asked and what was measured."""
    job, speed, closed = figures["commands"], figures["assembly"], figures["viscoelasticity"]
    rows = [
        ("first run of the main job, compilation included", "under 60 s", f"{job['first_run_seconds']:.1f} s"),
        ("later runs of the main job", "under 20 s", f"{job['later_run_seconds']:.1f} s"),
        ("`tactsim --help`", "under 0.3 s", f"{job['help_seconds']:.2f} s"),
        (
            "assembly, residual and tangent, P2/P1 tetrahedra",
            "80 000 per second",
            f"{round(speed['tetrahedra_per_second'], -3):,.0f} per second".replace(",", " "),
        ),
        (
            "force-displacement pairs of the exact annulus, one core",
            "1 000 000 per second",
            f"{round(closed['pairs_per_second'], -5):,.0f} per second".replace(",", " "),
        ),
        (
            "one step of the atrial model, compiled / from Python",
            "under 5 µs",
            f"{closed['step_compiled_microseconds']:.2f} / {closed['step_from_python_microseconds']:.2f} µs",
        ),
        *(
            (f"`{name}.yaml`", "under 120 s", f"{job[f'{name}_seconds']:.1f} s (exit {job[f'{name}_exit_code']:.0f})")
            for name in commands.CASES[1:]
        ),
        (
            f"`grasp_lump_icf.yaml`, {figures['grasp']['unknowns']:.0f} unknowns",
            "under 30 s, 2 GB",
            f"{figures['grasp']['total_seconds']:.1f} s to the taxels, {figures['grasp']['seconds']:.1f} s with all figures, "
            f"{figures['grasp']['peak_megabytes'] / 1000:.2f} GB",
        ),
        (
            "18 sensors at 1 kHz, conductance to force, in chunks of 10 ms / at once",
            "100 times real time",
            f"{figures['sensor_chain']['stream_real_time_factor']:.0f} / "
            f"{figures['sensor_chain']['record_real_time_factor']:.0f} times",
        ),
        (
            "three views of two 32 x 32 matrices at 60 x 100 pixels",
            "under 1 ms",
            f"{1e3 * figures['localization']['views_32_seconds']:.2f} ms",
        ),
        *pictures.rows(figures["figures"]),
        *_data_sets(figures["data_sets"]),
        *against.rows(figures["against"]),
        *stretch.rows(figures["stretch"]),
        *_against_peers(figures.get("peers")),
    ]
    lines = ["| what | asked | measured |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows)]
    return "\n".join([*lines, "", f"On {os.cpu_count()} cores, Python {platform.python_version()}, {platform.machine()}."])


def _data_sets(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the data sets."""
    return [
        (
            f"samples of `sweep_lumps.yaml` at 1 mm and friction 0.6, {taken['grasps_done']:.0f} of {taken['grasps']:.0f} done",
            "1 500 per hour",
            f"{taken['grasps_per_hour']:.0f} per hour",
        ),
        (f"{taken['fast_samples']:.0f} samples of `sweep_closed_form.yaml`", "under 120 s", f"{taken['fast_seconds']:.0f} s"),
        ("opening that store with xarray", "under 1 s", f"{taken['open_seconds']:.2f} s"),
    ]


def _against_peers(taken: dict[str, float] | None) -> list[tuple[str, str, str]]:
    """Rows of the comparison with FElupe, if it was asked for."""
    if taken is None:
        return []
    rows = [
        (
            f"block of {size} displacement unknowns, faster than FElupe by",
            f"{asked:g} times",
            f"{taken[f'{size}_ratio']:.1f} times",
        )
        for size, asked in peers.TARGETS.items()
    ]
    agreement = taken["agreement_largest_difference"]
    return [*rows, ("reaction and nine pressures, difference from FElupe, both mixed", "0.1 %", f"{100 * agreement:.4f} %")]


def _printed(path: Path) -> dict[str, float]:
    """The figures at the beginning of what ``peers.py`` printed in an earlier run."""
    return json.JSONDecoder().raw_decode(path.read_text())[0]


def _measured(kept: Path | None) -> dict[str, dict]:
    """The figures of every part by its name; half an hour's figures outlive a part that fails."""
    figures: dict[str, dict] = json.loads(kept.read_text()) if kept is not None and kept.exists() else {}
    for part in PARTS:
        if part.__name__ not in figures:
            figures[part.__name__] = part.measure()
            if kept is not None:
                kept.write_text(json.dumps(figures, indent=2) + "\n")
    return figures


def main() -> None:
    """Measure, print, and on request rewrite the table of the README."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readme", action="store_true", help="write the table into README.md")
    parser.add_argument(
        "--peers", nargs="?", const="", help="also solve one block with other programs (minutes), or take what peers.py printed"
    )
    parser.add_argument("--history", action="store_true", help=f"add the figures to {history.HISTORY.name}")
    parser.add_argument(
        "--kept", type=Path, metavar="FILE", help="keep the figures of each part here, and take those that stand here"
    )
    arguments = parser.parse_args()
    figures = _measured(arguments.kept)
    if arguments.peers is not None:
        figures["peers"] = peers.measure() if arguments.peers == "" else _printed(Path(arguments.peers))
    if arguments.history:
        history.append(figures)
    text = table(figures)
    sys.stdout.write(f"{json.dumps(figures, indent=2)}\n\n{text}\n")
    if arguments.readme:
        before, rest = README.read_text().split(START)
        README.write_text(f"{before}{START}\n{text}\n{END}{rest.split(END)[1]}")


if __name__ == "__main__":
    main()
