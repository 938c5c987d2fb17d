"""Runs the benchmarks, prints them as JSON and as a table, and writes the README's performance table.

python benchmarks/report.py [PART ...] [--all] [--readme] [--history] [--kept FILE]

Without names all parts but the long ones are measured; with ``--all``, which ``--readme`` implies, those too.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import against
import assembly
import commands
import data_sets
import figures
import grasp
import history
import localization
import peers
import scale
import sensor_chain
import stretch
import taxels
import validate
import viscoelasticity

README = Path(__file__).parents[1] / "README.md"
START = "<!-- performance table: written by `python benchmarks/report.py --readme` -->"
END = "<!-- end of performance table -->"
PARTS = {
    part.__name__: part
    for part in (
        commands,
        against,
        grasp,
        taxels,
        assembly,
        viscoelasticity,
        sensor_chain,
        localization,
        figures,
        data_sets,
        validate,
        scale,
        stretch,
        peers,
    )
}
"""Modules with ``measure`` and ``rows``, in the order of the table."""
LONG = ("validate", "scale", "peers")
"""Eight minutes, half an hour, and one to two hours with every other program installed."""
Figures = dict[str, dict[str, Any]]


def table(measured: Figures) -> str:
    """Markdown table of what is asked and what was measured, with the machine, the day and the commit."""
    rows = [row for name, part in PARTS.items() if name in measured for row in part.rows(measured[name])]
    lines = ["| what | asked | measured |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows)]
    return "\n".join([*lines, "", f"On {history.machine()}; {history.today()}, commit {history.commit()}."])


def measure(names: Sequence[str], kept: Path | None = None) -> Figures:
    """The figures of each part by its name; hours of figures outlive a part that fails.

    Figures of another machine or of another state of the package do not stand beside those of this run.
    """
    origin = {"machine": history.machine(), "package": history.package()}
    before = json.loads(kept.read_text()) if kept is not None and kept.exists() else {"of": origin, "parts": {}}
    if before["of"] != origin:
        raise SystemExit(f"{kept} was measured on {before['of']}, this is {origin}")
    parts: Figures = before["parts"]
    for name in names:
        if name not in parts:
            sys.stderr.write(f"{name}\n")
            parts[name] = PARTS[name].measure()
            if kept is not None:
                kept.write_text(json.dumps({"of": origin, "parts": parts}, indent=2) + "\n")
    return {name: parts[name] for name in names}


def with_table(readme: str, text: str) -> str:
    """The README with another table."""
    before, rest = readme.split(START)
    return f"{before}{START}\n{text}\n{END}{rest.split(END)[1]}"


def main() -> None:
    """Measure, print, and on request rewrite the table of the README."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", metavar="PART", nargs="*", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--all", action="store_true", help=f"also {', '.join(LONG)}")
    parser.add_argument("--readme", action="store_true", help="write the table of all parts into README.md")
    parser.add_argument("--history", action="store_true", help=f"add the figures to {history.HISTORY.name}")
    parser.add_argument(
        "--kept", type=Path, metavar="FILE", help="keep the figures of each part here, and take those that stand here"
    )
    arguments = parser.parse_args()
    unknown = set(arguments.parts) - set(PARTS)
    if unknown or (arguments.readme and arguments.parts):
        parser.error(f"no such part: {', '.join(unknown)}" if unknown else "--readme writes the table of all parts")
    every = arguments.all or arguments.readme
    names = [name for name in PARTS if name in arguments.parts or (not arguments.parts and (every or name not in LONG))]
    measured = measure(names, arguments.kept)
    text = table(measured)
    sys.stdout.write(f"{json.dumps(measured, indent=2)}\n\n{text}\n")
    if arguments.readme:
        README.write_text(with_table(README.read_text(), text))
    if arguments.history:
        history.append(measured)


if __name__ == "__main__":
    main()
