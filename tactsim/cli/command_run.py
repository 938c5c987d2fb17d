"""``tactsim run``: computes a case and writes its result."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tactsim.cli import console
from tactsim.cli.interruption import Interruption, interruptible
from tactsim.errors import INTERRUPTED, InputError, InvalidQuantity, StorageError, shown
from tactsim.outside.text import one_line

if TYPE_CHECKING:
    from tactsim.case import Case
    from tactsim.results import Result, StepRecord
    from tactsim.results.folder import OutputFolder

COMPARISON = "comparison"
"""Folder, beside those of several cases, of the table that compares them."""
NAME = "run"
SUMMARY = "compute a case and write its result"
DESCRIPTION = """\
Computes a case and writes result.json, history.csv, provenance.json, fields.pvd with its .vtu
files (for ParaView), figures/ and manifest.json (the checksums of all these) into the output
folder. The folder is complete or absent: it is written beside its place and moved there last.

Without --out the folder is results/<name of the case file>, and an earlier result of tactsim
there is replaced; if the new run does not converge, an earlier result that did is kept beside
it with the ending .earlier. A folder given by --out is replaced only with --force. A folder
with files that tactsim did not write is never replaced.

Several cases are run one after the other, each into a folder of its name below --out (default:
results), and then put into one table and one figure, in the folder "comparison" beside them: see
tactsim compare. With --out none of these folders is replaced without --force either.

On a terminal every accepted step is reported as it happens; elsewhere only the final report
is written, unless --progress asks for more. Ctrl+C stops the computation and writes what was
accepted so far with the status "interrupted"; a second Ctrl+C stops at once. A run that takes
longer than --time-limit ends as a failed one: what was accepted so far is written.
"""
EXAMPLES = """\
examples:
  tactsim run annulus_icf
  tactsim run annulus_icf --out soft --set experiment.specimen.thickness="6 mm"
  tactsim run case.yaml --set experiment.specimen.layers.0.thickness=6mm --quiet
  tactsim run grasp_lump_icf --time-limit "5 min"
  tactsim run grasp_plain grasp_lump_icf --out grasps
  tactsim run annulus_icf --figures pdf
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument(
        "cases",
        metavar="CASE",
        type=Path,
        nargs="+",
        help="case file (YAML), name of a shipped case, or folder of a result, whose case is run again",
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="output folder (default: results/<name of the case file>); of several cases, the folder of their folders",
    )
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="set path.to.key, validated like the file; may be repeated",
    )
    parser.add_argument("--force", action="store_true", help="replace an earlier result in --out")
    parser.add_argument("--time-limit", metavar="TIME", help='end a run that takes longer, such as "5 min" (default: no limit)')
    words = "form of the pictures in figures/ (default: png); none draws nothing and saves their time"
    parser.add_argument("--figures", choices=("none", "png", "svg", "pdf"), default="png", help=words)
    loudness = parser.add_mutually_exclusive_group()
    loudness.add_argument("--quiet", action="store_true", help="write no progress and no report, only errors")
    loudness.add_argument("--progress", action="store_true", help="report every accepted step even where nobody watches")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command; of several cases, that of the first that failed.

    Raises
    ------
    InputError
        If two of several cases have the same name, or one that of the comparison, so that their results would.
    """
    if len(arguments.cases) == 1:
        return _run(arguments.cases[0], arguments.out, arguments)
    names = [path.stem for path in arguments.cases]
    if repeated := [name for name in names if names.count(name) > 1]:
        raise InputError(f"two cases are called {one_line(repeated[0])}; their results would have one folder")
    if COMPARISON in names:
        raise InputError(f"a case is called {COMPARISON}, as is the folder of the table of several cases; rename its file")
    root, codes = arguments.out or Path("results"), []
    _refuse_early(arguments, [root / name for name in (*names, COMPARISON)])
    for number, path in enumerate(arguments.cases):
        if number and not arguments.quiet:
            console.out()
        codes.append(_run(path, root / path.stem, arguments))
        if codes[-1] == INTERRUPTED:
            return INTERRUPTED
    _compare([root / name for name in names], root / COMPARISON, arguments)
    return next((code for code in codes if code), 0)


def _refuse_early(arguments: argparse.Namespace, places: list[Path]) -> None:
    """Refuses a case or a place that is wrong before the first of several cases is computed.

    Files that a case reads are looked for when its turn comes, for a case before it may write them.

    Raises
    ------
    TactsimError
        What the case, or its place, would be refused with.
    """
    from tactsim.case.loading import read_document, validated_case
    from tactsim.cli.command_compare import TABLE_FILE
    from tactsim.outside.library_warnings import collected_warnings
    from tactsim.results.folder import check_replaceable, refuse_others

    for path in arguments.cases:
        with collected_warnings():  # its turn reports them
            validated_case(*read_document(path, arguments.set, option="--set"))
    check_replaceable(places[0], _may_replace(arguments), *places[1:])
    refuse_others(places[-1], TABLE_FILE, "comparison")


def _may_replace(arguments: argparse.Namespace) -> bool:
    """Whether earlier results of tactsim may give way: those of the default folder, or with --force."""
    return arguments.force or arguments.out is None


def _compare(folders: list[Path], place: Path, arguments: argparse.Namespace) -> None:
    """Put the results of several cases into one table and one figure."""
    from tactsim.cli.command_compare import report
    from tactsim.results import read_result

    if not arguments.quiet:
        console.out()
    results = {folder.name: read_result(folder, fields=False).complete for folder in folders}
    report(results, place, form=arguments.figures, warnings=False, quiet=arguments.quiet)  # each stands in the report of its case


def _run(path: Path, out: Path | None, arguments: argparse.Namespace) -> int:
    """Exit code of one case."""
    from tactsim.case.inputs import check_inputs
    from tactsim.case.loading import read_document, validated_case
    from tactsim.case.placing import placed
    from tactsim.interfaces.doubts import doubts_of
    from tactsim.outside.library_warnings import collected_warnings
    from tactsim.progress import noted_by
    from tactsim.results import Status
    from tactsim.results.folder import claimed

    seconds = _time_limit(arguments.time_limit)
    with interruptible() as interruption:
        document, place = read_document(path, arguments.set, option="--set")
        with collected_warnings() as read:
            case = validated_case(document, place)
            listed = check_inputs(case, document, place)
        directory = out or Path("results") / path.stem
        with claimed(directory, replace=_may_replace(arguments)) as folder:
            progress = _progress(case, arguments)
            if progress is not None:
                for doubt in doubts_of(case.experiment):
                    console.note(f"warning: {doubt}")
            with collected_warnings() as raised, noted_by(progress and console.note), placed(case, document, place):
                try:
                    result = case.experiment.run(progress, time_limit=seconds)
                    if result.status is Status.INTERRUPTED and not (result.steps or result.quantities):
                        raise KeyboardInterrupt
                except KeyboardInterrupt:
                    raise KeyboardInterrupt(f"nothing was accepted yet, so {one_line(directory)} is not written") from None
            result = replace(result, warnings=(*result.warnings, *listed, *read.lines(), *raised.lines()))
            result = replace(result, provenance=case.provenance(case_file=path.name, overrides=arguments.set))
            with interruption.deferred():
                return _finish(result, case, folder, interruption, arguments)


def _time_limit(text: str | None) -> float | None:
    """Seconds of an option such as "5 min".

    Raises
    ------
    InvalidQuantity
        If it is no time, or not positive.
    """
    from tactsim.cli.option_values import quantity_of

    if text is None:
        return None
    seconds = quantity_of("--time-limit", text, "s")
    if seconds <= 0:
        raise InvalidQuantity(f"--time-limit {shown(text)} is out of range; must be above 0 s")
    return seconds


def _progress(case: Case, arguments: argparse.Namespace) -> Callable[[StepRecord], None] | None:
    from tactsim.cli.report import step_line
    from tactsim.progress import COMPILATION

    if arguments.quiet or not (arguments.progress or console.notes_are_watched()):
        return None
    units, extent = case.experiment.history_units, case.experiment.extent

    def computing() -> float:
        return time.monotonic() - COMPILATION.seconds

    begin = computing()
    return lambda record: console.note(step_line(record, units, extent, computing() - begin))


def _finish(result: Result, case: Case, folder: OutputFolder, interruption: Interruption, arguments: argparse.Namespace) -> int:
    """Writes the result, reports it, and returns the exit code of its status."""
    from tactsim.cli.figures.result_figures import rendered_figures
    from tactsim.cli.report import last_line, result_report
    from tactsim.results import Status

    result = replace(result, title=case.title)
    figures, warnings = ({}, []) if arguments.figures == "none" else rendered_figures(result, arguments.figures)
    frames = {"all": result.frames, "last": result.frames[-1:], "none": ()}[case.output.fields]
    result = replace(result, warnings=(*result.warnings, *warnings), frames=frames)
    report = result_report(result, _heading(result, len(arguments.cases) > 1))
    try:
        kept = _write(result, case, folder, figures, arguments)
    except StorageError:
        if not arguments.quiet:
            console.out(report)
        raise
    if not arguments.quiet:
        console.out(report)
        if kept:
            console.out(f"  the earlier result, which converged, is kept in {kept}")
        console.out(last_line(result, folder.path, figures))
    elif result.status is Status.FAILED:
        console.error(f"{one_line(result.provenance['case_file'])}: {last_line(result, folder.path, figures)}")
    return INTERRUPTED if interruption.requested else result.status.exit_code


def _heading(result: Result, several: bool) -> str:
    """Whose report it is: the title of the case or the name of its file, of one among several both."""
    name = Path(result.provenance["case_file"]).stem
    return f"{name}: {result.title}" if several and result.title else result.title or name


def _write(
    result: Result, case: Case, folder: OutputFolder, figures: dict[str, bytes], arguments: argparse.Namespace
) -> Path | None:
    """Writes and publishes the folder; returns where an earlier result is kept, if it is."""
    from tactsim.results import Status
    from tactsim.results.writing import fill

    fill(folder, result, case_id=case.case_id, provenance=result.provenance, figures=figures)
    keep = result.status is not Status.CONVERGED and not arguments.force and _converged(folder.path)
    return folder.publish(keep_earlier=keep)


def _converged(directory: Path) -> bool:
    """Whether the folder holds a result that converged."""
    from tactsim.results import Status, read_result

    try:
        return read_result(directory, fields=False).result.status is Status.CONVERGED
    except StorageError:
        return False
