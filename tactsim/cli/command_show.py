"""``tactsim show``: a stored result in words and as a picture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactsim.cli import console
from tactsim.errors import InputError, StorageError, UnknownName
from tactsim.outside.text import aligned, one_line

if TYPE_CHECKING:
    from tactsim.case.loading import Place
    from tactsim.case.yaml_reading import Document
    from tactsim.results import Result

NAME = "show"
SUMMARY = "print a stored result, a data set or a case, save its figure, or open the live page"
DESCRIPTION = """\
Prints the quantities of a stored result, or the counts and variables of a data set, with their units;
--save draws its main figure, in the form that the ending of the file names. Of a case file, or the name
of a shipped case, it prints what would be computed and what looks wrong in it, and --save draws the tissue
at rest with its mesh and what presses on it: seconds, for nothing is solved. Of a sweep file it prints what
varies and what is stored, and --save draws the first sample. --web serves the live page of a grasp or a data set of grasps on
this machine, under an address with a random token, until Ctrl-C. --live shows frames as they come, too.
"""
EXAMPLES = """\
examples:
  tactsim show results/annulus_icf
  tactsim show results/annulus_icf --save annulus.pdf
  tactsim show lumps.zarr --save taxels.png
  tactsim show my_annulus.yaml --save sketch.png
  tactsim show grasp_lump_icf --set experiment.upper.tilt_x="3 deg" --save sketch.png
  tactsim show results/grasp_lump_icf --web --reference results/grasp_plain
  my_sensor | tactsim show --web --live -

frames for --live, one JSON object per line, the description first, here in two lines:
  {"schema": "tactsim/frames/1", "matrix": {"rows": 3, "columns": 3, "pitch": 0.01, "size": 0.009},
   "block_size": [0.04, 0.04, 0.02], "title": "right hand"}
  {"time": 0.033, "taxel_force_upper": [[0.1, 0.2, 0.1], ...], "taxel_force_lower": [[...], ...]}
lengths in m, forces in N, time in s; [row][column], row 1 nearest the front, column 1 the smallest x;
null or "NaN" is a dead taxel. May be left out: title; closing (m); saturated_upper, saturated_lower.
"""
WEB_OPTIONS = ("port", "host", "live", "reference", "noise", "learned", "no_browser")
"""Options that say something about the page only."""

SET_OF_A_CASE = "--set: of a case or a sweep that is shown before it is computed only; a result or a data set stays as it is"
CASE_ENDINGS = (".yaml", ".yml")
NOISE_WORDS = (
    "standard deviation of what a taxel reads, such as '2 mN'; by default that of a stored localization, 0.6 %% of the largest "
    "force for forces of a simulation (what its mesh leaves), and 28.868 mN for any others (a resolution of 0.1 N, the thesis's)"
)
LONGEST_KIND = 60
"""Characters of a foreign kind that a message shows."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    words = "folder that tactsim run or sweep wrote, or a case; may be left out with --live"
    parser.add_argument("result", metavar="RESULT_STORE_OR_CASE", type=Path, nargs="?", help=words)
    parser.add_argument("--save", metavar="FILE", type=Path, help="save the main figure as .png, .svg or .pdf")
    words = "set path.to.key of a case or sweep before it is shown, as tactsim run does; may be repeated"
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help=words)
    parser.add_argument("--web", action="store_true", help="serve the live page and open it in the browser")
    words = "frames: a file that grows, - for standard input (a named pipe: --live - < PIPE), or tcp://127.0.0.1:PORT"
    parser.add_argument("--live", metavar="SOURCE", help=words)
    words = "result of the same grasp without a lump, which most estimators need; several for several closings"
    parser.add_argument("--reference", metavar="FOLDER", action="append", default=[], help=words)
    parser.add_argument("--noise", metavar="FORCE", help=NOISE_WORDS)
    parser.add_argument("--learned", metavar="WEIGHTS.npz", help="offer the learned estimator: the file of tactsim data train")
    parser.add_argument("--port", metavar="N", type=int, help="port of the page; by default any that is free")
    parser.add_argument("--host", metavar="ADDRESS", help="serve on another address than that of this machine alone")
    parser.add_argument("--no-browser", action="store_true", help="print the address only")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    TactsimError
        Whatever ends the command with an exit code of its own, such as options that do not go together.
    """
    if arguments.web:
        if arguments.set:
            raise InputError(SET_OF_A_CASE)
        from tactsim.cli.live_page import run_page

        return run_page(arguments)
    given = [f"--{name.replace('_', '-')}" for name in WEB_OPTIONS if getattr(arguments, name) not in (None, False, [])]
    if given:
        raise InputError(f"{', '.join(given)}: for the live page only; add --web")
    if arguments.result is None:
        raise InputError(
            "RESULT_STORE_OR_CASE is missing; name a folder that tactsim run or sweep wrote, a case, or --web --live SOURCE; "
            "tactsim show --help says more"
        )
    is_store = (arguments.result / "zarr.json").is_file()
    if not is_store and (case := _case_of(arguments.result)) is not None:
        return _show_case(case, arguments)
    if arguments.set:
        raise InputError(SET_OF_A_CASE)
    return _show_data_set(arguments) if is_store else _show_result(arguments)


def _case_of(named: Path) -> Path | None:
    """The case file that an argument names, itself or as a shipped case; None if it names a folder.

    Raises
    ------
    StorageError
        If it is a bare name of neither.
    """
    from tactsim.shipped import case_path

    if named.is_dir():
        return None
    if named.suffix in CASE_ENDINGS:
        return named
    try:
        case = case_path(named)
    except UnknownName as error:
        raise StorageError(f"there is no folder {one_line(named)} here; {error}") from None
    return None if case == named else case


def _show_case(path: Path, arguments: argparse.Namespace) -> int:
    """What a case would compute, in words and as a picture of its bodies at rest."""
    from tactsim.case.loading import SWEEPS, read_document, validated_case
    from tactsim.case.placing import placed
    from tactsim.cli.figures.result_figures import form_of
    from tactsim.results import SolverReport

    save = arguments.save
    form, read = None if save is None else form_of(save), read_document(path, arguments.set, option="--set")
    if str(read[0].value.get("schema")).startswith(SWEEPS):
        return _show_sweep(*read, form, arguments)
    case = validated_case(*read)
    with placed(case, *read):
        result = case.at_rest()
    console.out(one_line(result.title or path.stem))
    console.out(f"  {result.kind}, {result.reason}")
    if isinstance(report := getattr(result.scene, "solver", None), SolverReport):
        console.out(f"  mesh of {report.size_in_words}")
    for line in (*result.assumptions, *(f"warning: {warning}" for warning in result.warnings)):
        console.out(f"  {one_line(line)}")
    if save is None or form is None:
        console.out("  --save sketch.png draws the tissue with its mesh and what presses on it")
    else:
        _save_main_figure(result, save, form)
    return 0


def _show_sweep(written: Document, where: Place, form: str | None, arguments: argparse.Namespace) -> int:
    """How many samples a sweep would compute and what varies in them, and a picture of the first at rest."""
    from tactsim.dataset.sampling.layout import first_case, layout_of
    from tactsim.dataset.sampling.sweep import sweep_of_document
    from tactsim.schema_of_model import value_at

    sweep, save, stem = sweep_of_document(written, where), arguments.save, arguments.result.stem
    layout = layout_of(sweep)  # refuses what the sweep itself would refuse before its first sample
    case, document = first_case(sweep), sweep.document.value
    console.out(one_line(document.get("title") or stem))
    samples = f"{sweep.samples} samples" + (f", {sweep.per_specimen} of each specimen" if sweep.per_specimen > 1 else "")
    console.out(f"  a sweep of {sweep.kind}: {samples}, design {sweep.settings.design}; nothing is computed")
    drawn = [(one.key.removeprefix("experiment."), _distribution_in_words(value_at(document, one.path))) for one in sweep.places]
    for line in aligned(drawn, left=2, indent="  "):
        console.out(line)
    for role in ("label", "reading"):
        names = ", ".join(variable.name for variable in layout.variables if variable.role == role)
        console.out(f"  {role}s: {names or 'none'}")
    if save is not None and form is not None:
        _save_main_figure(case.at_rest(), save, form)
    changes = [word for change in arguments.set for word in ("--set", change)]
    console.out(f"  compute it with: {console.command('sweep', arguments.result, *changes, '--out', f'{stem}.zarr')}")
    return 0


def _distribution_in_words(written: dict[str, Any]) -> str:
    """A distribution as the file has it, in a line."""
    name, entries = next((name, entries) for name, entries in written.items() if isinstance(entries, list) and name != "weights")
    words = [_option_in_words(entry) for entry in entries]
    rest = [f"{other} {', '.join(map(str, value))}" for other, value in written.items() if other != name]
    return one_line("; ".join([f"{name.replace('_', '-')} {', '.join(words)}", *rest]))


def _option_in_words(entry: Any) -> str:
    """A bound or an option; one that is no single word by its kind, or by how many entries it has."""
    if isinstance(entry, dict):
        return str(entry.get("kind", "a mapping"))
    if isinstance(entry, list):
        return f"a list of {len(entry)}" if entry else "an empty list"
    return str(entry)


def _show_result(arguments: argparse.Namespace) -> int:
    from tactsim.cli.figures.result_figures import form_of
    from tactsim.cli.report import result_report
    from tactsim.results.reading import read_result, result_folder

    form = None if arguments.save is None else form_of(arguments.save)
    folder = result_folder(arguments.result)
    stored = read_result(folder, fields=arguments.save is not None)
    console.out(result_report(stored.complete, stored.case_title or folder.resolve().name))
    console.out(f"  case {one_line(stored.case_id)}")
    if form is not None:
        _save_main_figure(stored.result, arguments.save, form)
    return 0


def _save_main_figure(result: Result, save: Path, form: str) -> None:
    from tactsim.cli.figures.result_figures import rendered_figures
    from tactsim.storage.files import replace_file

    figures, warnings = rendered_figures(result, form, main_only=True)
    for warning in warnings:
        console.note(f"warning: {one_line(warning)}")
    if not figures:
        raise InputError(f"a result of kind {one_line(result.kind, LONGEST_KIND)!r} has no figure that can be drawn")
    replace_file(save, next(iter(figures.values())))
    console.out(f"figure {one_line(save)}")


def _show_data_set(arguments: argparse.Namespace) -> int:
    from tactsim.cli.figures.result_figures import form_of
    from tactsim.dataset.use.card import description

    form = None if arguments.save is None else form_of(arguments.save)
    console.out(description(arguments.result))
    if form is not None:
        from tactsim.dataset.figures.card import card_figures
        from tactsim.storage.files import replace_file

        drawings = card_figures(arguments.result)
        if not drawings:
            raise InputError(f"{arguments.result} has no samples that are done and differ, and so no figure")
        replace_file(arguments.save, drawings[list(drawings)[-1]](form))
        console.out(f"figure {arguments.save}")
    return 0
