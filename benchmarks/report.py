"""Runs the benchmarks, prints them as JSON and as a table, and writes the README's performance table.

python benchmarks/report.py [PART ...] [--all] [--stale] [--keep]

Without names all parts but the long ones are measured, with ``--all`` those too; ``against:JOB,JOB`` measures some jobs of that
part. ``--keep`` puts the figures of each part into ``measured.json``, which holds the newest of every part, and into
``history.csv``, and writes the README's table from the former.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import accuracy
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
MEASURED = Path(__file__).with_name("measured.json")
"""The newest figures of every part, and of what they are: machine, day, commit and state of the package."""
START = "<!-- performance table: written by `python benchmarks/report.py --keep` -->"
END = "<!-- end of performance table -->"
PARTS = {
    part.__name__: part
    for part in (
        commands,
        against,
        accuracy,
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
LONG = ("accuracy", "validate", "scale", "peers")
"""Four minutes, eight, half an hour, and one to two hours with every other program installed."""
Measurement = dict[str, Any]
"""The ``figures`` of a part, and of what they are."""


def table(measured: dict[str, Measurement]) -> str:
    """Markdown table of what is asked and what was measured at which commit, and the machines below."""
    taken = [(measured[name], part.rows(measured[name]["figures"])) for name, part in PARTS.items() if name in measured]
    rows = [(*row, commit) for part, found in taken for row, commit in zip(found, _commits(part, len(found)), strict=True)]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    machines = "; ".join(dict.fromkeys(part["machine"] for part, _ in taken))
    days = sorted({part["day"] for part, _ in taken})
    period = " to ".join(dict.fromkeys((days[0], days[-1])))
    return "\n".join(["| what | asked | measured | commit |", "|---|---|---|---|", *lines, "", f"On {machines}; {period}."])


def _commits(part: Measurement, rows: int) -> list[str]:
    """The commit of each row of a part: that of the part, or of the job that was measured by itself."""
    own = part.get("commits", {})
    return [own.get(job, part["commit"]) for job in part["figures"]] if own else [part["commit"]] * rows


def measured_parts(names: Sequence[str]) -> Iterator[tuple[str, Measurement]]:
    """Each part as soon as it is measured, so that hours of figures outlive one that fails."""
    for name in names:
        sys.stderr.write(f"{name}\n")
        part, _, jobs = name.partition(":")
        figures = PARTS[part].measure(jobs.split(",")) if jobs else PARTS[part].measure()
        yield name, {**_state(), "day": history.today(), "commit": history.commit(), "figures": figures}


def _state() -> dict[str, str]:
    return {"machine": history.machine(), "package": history.package()}


def kept_parts() -> dict[str, Measurement]:
    """The newest figures of every part that was kept."""
    return json.loads(MEASURED.read_text()) if MEASURED.exists() else {}


def is_stale(part: Measurement | None) -> bool:
    """Whether a part was never measured, or on another machine, or with another state of the package or the cases."""
    return part is None or any(part[name] != value for name, value in _state().items())


def keep(name: str, part: Measurement) -> None:
    """Put a part, or some jobs of it beside the others, into `MEASURED` and the history, and write the README's table anew."""
    name, _, jobs = name.partition(":")
    parts = kept_parts()
    parts[name] = with_jobs(parts[name], part) if jobs and name in parts else part
    MEASURED.write_text(json.dumps(parts, indent=1) + "\n")
    history.append({name: part["figures"]})
    README.write_text(with_table(README.read_text(), table(parts)))


def with_jobs(part: Measurement, newer: Measurement) -> Measurement:
    """A part with the figures of some jobs measured anew, which have a commit of their own."""
    commits = part.get("commits", {}) | dict.fromkeys(newer["figures"], newer["commit"])
    return {**part, "figures": part["figures"] | newer["figures"], "commits": commits}


def with_table(readme: str, text: str) -> str:
    """The README with another table."""
    before, rest = readme.split(START)
    return f"{before}{START}\n{text}\n{END}{rest.split(END)[1]}"


def main() -> None:
    """Measure, print, and on request rewrite the table of the README."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", metavar="PART", nargs="*", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--all", action="store_true", help=f"also {', '.join(LONG)}")
    parser.add_argument("--stale", action="store_true", help="only parts whose kept figures are of another state or machine")
    parser.add_argument("--keep", action="store_true", help="keep the figures, and write the README's table of all kept ones")
    arguments = parser.parse_args()
    unknown = {name.partition(":")[0] for name in arguments.parts} - set(PARTS)
    if unknown:
        parser.error(f"no such part: {', '.join(unknown)}")
    names = arguments.parts or [name for name in PARTS if arguments.all or name not in LONG]
    if arguments.stale:
        before = kept_parts()
        names = [name for name in names if is_stale(before.get(name))]
    measured = {}
    for name, part in measured_parts(names):
        measured[name.partition(":")[0]] = part
        if arguments.keep:
            keep(name, part)
    if measured:
        sys.stdout.write(f"{json.dumps(measured, indent=2)}\n\n{table(measured)}\n")


if __name__ == "__main__":
    main()
