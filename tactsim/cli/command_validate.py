"""``tactsim validate``: how the software stands against the thesis."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tactsim.cli import console
from tactsim.errors import NOT_AS_RECORDED, InputError
from tactsim.outside.text import counted
from tactsim.shipped import PROGRAM

if TYPE_CHECKING:
    from tactsim.results.folder import OutputFolder
    from tactsim.validation import LoadedTables, StudyRunner, Validation

NAME = "validate"
SUMMARY = "compare with the tables of the thesis and with published problems"
DESCRIPTION = """\
Computes every number that the tables (cases/thesis, cases/published) record, and states for each
row how it ends: reproduced (after an erratum), confirmed, inside a range, outside by a factor,
contradicted, transcribed, regression, not testable, or repeated, if another row says the same.
A known deviation does not fail; a row that leaves its class, or is absent, does. Simulations are
taken from a cache unless --fresh is given.
The report is one HTML file that opens from disk, with the same as Markdown and JSON beside it;
it takes the place of an earlier report, and of nothing else.
"""
EXAMPLES = """\
examples:
  tactsim validate
  tactsim validate published
  tactsim validate table_3_1 table_3_3 --out results/chapter_3
  tactsim validate table_3_2 --fresh --workers 4
"""
NOT_WRITTEN = "no report is written; simulations that ended are kept, and the same command without --fresh goes on from there"
REPORT = "validation.json"
"""What every report holds."""
GROUPS = (Path("cases", "thesis"), Path("cases", "published"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("tables", metavar="TABLE", nargs="*", help="names of tables, or thesis or published; all by default")
    parser.add_argument("--out", metavar="DIR", type=Path, default=Path("results", "validation"), help="default: %(default)s")
    parser.add_argument("--fresh", action="store_true", help="compute again what earlier validations computed")
    parser.add_argument("--workers", metavar="N", type=int, help="processes for simulations; default: one a core")
    parser.add_argument("--progress", action="store_true", help="report every simulation that ends even where nobody watches")
    parser.add_argument(
        "--from", dest="folder", metavar="DIR", type=Path, help="folder of the tables; default: those that come with tactsim"
    )


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    TactsimError
        Whatever ends the command with an exit code of its own, such as options that do not go together.
    """
    from tactsim.outside.environment import usable_cores
    from tactsim.results.folder import claimed, refuse_others
    from tactsim.validation import StudyRunner, load_groups, summary_text

    if arguments.workers is not None and arguments.workers < 1:
        raise InputError(f"--workers {arguments.workers} is out of range; must be at least 1")
    folders = [arguments.folder] if arguments.folder else shipped_folders()
    groups = load_groups(folders, arguments.tables)
    runner = StudyRunner(workers=arguments.workers or usable_cores(), fresh=arguments.fresh)
    with claimed(arguments.out, replace=True) as folder:  # a place that is refused is refused before minutes of computing
        refuse_others(arguments.out, REPORT, "validation report")
        try:
            validations = [_validated(loaded, runner, arguments.progress) for loaded in groups]
        except KeyboardInterrupt:
            raise KeyboardInterrupt(NOT_WRITTEN) from None
        for validation in validations:
            console.out(summary_text(validation))
        _write(validations, folder)
    if origin := _origin(runner):
        console.out(origin)
    wrong = [name for validation in validations for name in validation.wrong]
    state = f"left their class: {', '.join(wrong)}" if wrong else "every row ended as recorded"
    console.out(f"{state}; report {arguments.out / 'validation.html'}")
    return NOT_AS_RECORDED if wrong else 0


def _write(validations: Sequence[Validation], folder: OutputFolder) -> None:
    """Writes the report in its three forms, with its figures."""
    from tactsim.results.writing import publish_files
    from tactsim.validation import html_report, json_report, markdown_report

    figures, troubles = _figures(validations)
    names = {table: list(drawn) for table, drawn in figures.items()}
    reports = {
        "validation.html": html_report(validations, figures).encode(),
        REPORT: json_report(validations).encode(),
        "validation.md": markdown_report(validations, names).encode(),
    }
    drawings = {f"figures/{name}": content for drawn in figures.values() for name, content in drawn.items()}
    publish_files(reports | drawings, folder)
    for trouble in troubles:
        console.note(f"warning: {trouble}")


def _origin(runner: StudyRunner) -> str:
    """How many simulations were computed, and how many an earlier validation left; nothing if there was none."""
    computed, kept = len(runner.computed), len(runner.from_cache)
    if not kept:
        return ""
    are, them = ("is", "it") if kept == 1 else ("are", "them")
    whole = "the only simulation" if kept == 1 else f"all {kept} simulations"
    were = f"{counted(computed, 'simulation')} {'was' if computed == 1 else 'were'} computed, {kept}"
    return f"{were if computed else f'{whole} of the studies'} {are} from the cache; --fresh computes {them} again"


def _validated(loaded: LoadedTables, runner: StudyRunner, progress: bool) -> Validation:
    """The tables of a group computed and compared; each is printed when it is complete. ``progress`` reports also unwatched."""
    from tactsim.validation import Validation, compare, table_text

    report = _report if progress or console.notes_are_watched() else _say_nothing
    wanted = {name: table.studies for name, table in loaded.tables.items()}
    ended = {}
    for name, studies in runner.outcomes(wanted, loaded.folder, report):
        ended[name] = compare(name, loaded.tables[name], loaded.folder, studies)
        console.out(table_text(ended[name]))
    return Validation(loaded, tuple(ended[name] for name in loaded.tables))


def _report(line: str) -> None:
    console.note(f"  {line}")


def _say_nothing(line: str) -> None:
    """Nobody watches."""


def shipped_folders() -> list[Path]:
    """The tables of the folder one works in, else those that come with tactsim.

    Raises
    ------
    InputError
        If there are none.
    """
    for root in (Path(), PROGRAM):
        if folders := [root / group for group in GROUPS if (root / group).is_dir()]:
            return folders
    raise InputError(f"there is no folder {GROUPS[0]} here; name one with --from DIR")


def _figures(validations: Sequence[Validation]) -> tuple[dict[str, dict[str, bytes]], list[str]]:
    """Table -> file name -> PNG, with an overview of all, and a warning for each figure that could not be drawn."""
    from tactsim.validation.figures import overview, validation_figure
    from tactsim.validation.html import COLOURS

    rows = [(row, str(outcome.table.chapter)) for each in validations for outcome in each.outcomes for row in outcome.rows]
    drawn: dict[str, dict[str, bytes]] = {}
    if rows:
        drawn["overview"] = {"overview.png": overview([row for row, _ in rows], [chapter for _, chapter in rows], COLOURS)}
    troubles: list[str] = []
    for outcome in (outcome for validation in validations for outcome in validation.outcomes):
        for name, drawing in outcome.table.figures.items():
            try:
                picture = validation_figure(drawing(outcome.inputs))
                drawn.setdefault(outcome.name, {})[f"{outcome.name}_{name}.png"] = picture
            except Exception as error:  # noqa: BLE001  whatever drawing does wrong, the numbers must still be written
                troubles.append(f"figure {name} of {outcome.name}: {type(error).__name__}: {error}")
    return drawn, troubles
