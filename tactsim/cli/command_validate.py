"""``tactsim validate``: how the software stands against the thesis."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tactsim.cli import console
from tactsim.errors import NOT_AS_RECORDED, InputError
from tactsim.shipped import PROGRAM

if TYPE_CHECKING:
    from tactsim.validation import TableOutcome

NAME = "validate"
SUMMARY = "compare with the tables of the thesis"
DESCRIPTION = """\
Computes every number of the thesis that its tables (cases/thesis/*.yaml) record, and states for
each row whether it is reproduced, reproduced after an erratum, outside by a factor, a finding
above or below a limit, or an assumption. A known deviation does not fail; a row that leaves its
recorded state, or is absent, does. Simulations are taken from a cache unless --fresh is given.
"""
EXAMPLES = """\
examples:
  tactsim validate
  tactsim validate table_3_1 table_3_3 --out results/chapter_3
  tactsim validate table_3_2 --fresh --workers 4
"""
TABLES = Path("cases", "thesis")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("tables", metavar="TABLE", nargs="*", help="names of tables; all by default")
    parser.add_argument("--out", metavar="DIR", type=Path, default=Path("results", "validation"), help="default: %(default)s")
    parser.add_argument("--fresh", action="store_true", help="compute again what earlier validations computed")
    parser.add_argument("--workers", metavar="N", type=int, default=2, help="processes for simulations; default: %(default)s")
    parser.add_argument("--from", dest="folder", metavar="DIR", type=Path, help=f"folder of the tables; default: {TABLES}")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    TactsimError
        Whatever ends the command with an exit code of its own, such as options that do not go together.
    """
    from tactsim.results.writing import write_files
    from tactsim.validation import StudyRunner, compare, json_report, load_tables, markdown_report, terminal_report

    if arguments.workers < 1:
        raise InputError(f"--workers {arguments.workers} is out of range; must be at least 1")
    loaded = load_tables(arguments.folder or tables_folder(), arguments.tables)
    runner = StudyRunner(workers=arguments.workers, fresh=arguments.fresh)
    wanted = {name: table.studies for name, table in loaded.tables.items()}
    studies = runner.outcomes(wanted, loaded.folder, _progress)
    outcomes = [compare(name, table, loaded.folder, studies[name]) for name, table in loaded.tables.items()]
    figures, troubles = _figures(outcomes)
    console.out(terminal_report(loaded, outcomes))
    reports = {
        "validation.json": json_report(loaded, outcomes).encode(),
        "validation.md": markdown_report(loaded, outcomes, tuple(figures)).encode(),
    }
    write_files(reports | {f"figures/{name}": content for name, content in figures.items()}, arguments.out)
    for trouble in troubles:
        console.note(f"warning: {trouble}")
    left = [f"{outcome.name}.{row.row.id}" for outcome in outcomes for row in outcome.rows if not row.held]
    wrong = [*left, *(fault.partition(":")[0] for fault in loaded.faults)]
    console.out(f"{'left their recorded state: ' + ', '.join(wrong) if wrong else 'every row holds'}; report {arguments.out}")
    return NOT_AS_RECORDED if wrong else 0


def _progress(line: str) -> None:
    if console.notes_are_watched():
        console.note(f"  {line}")


def tables_folder() -> Path:
    """The tables of the folder one works in, else those that come with tactsim.

    Raises
    ------
    InputError
        If there are none.
    """
    for root in (Path(), PROGRAM):
        if (root / TABLES).is_dir():
            return root / TABLES
    raise InputError(f"there is no folder {TABLES} here; name one with --from DIR")


def _figures(outcomes: Sequence[TableOutcome]) -> tuple[dict[str, bytes], list[str]]:
    """File name -> PNG, and a warning for each figure that could not be drawn."""
    drawn: dict[str, bytes] = {}
    troubles: list[str] = []
    for outcome in outcomes:
        for name, drawing in outcome.table.figures.items():
            try:
                from tactsim.validation.figures import validation_figure

                drawn[f"{outcome.name}_{name}.png"] = validation_figure(drawing(outcome.inputs))
            except Exception as error:  # noqa: BLE001  whatever drawing does wrong, the numbers must still be written
                troubles.append(f"figure {name} of {outcome.name}: {type(error).__name__}: {error}")
    return drawn, troubles
