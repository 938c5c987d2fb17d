"""``tactsim show``: a stored result in words and as a picture."""

from __future__ import annotations

import argparse
from pathlib import Path

from tactsim.cli import console
from tactsim.errors import InputError

NAME = "show"
SUMMARY = "print a stored result or data set, or save its figure"
DESCRIPTION = """\
Prints the quantities of a stored result, or the counts and variables of a data set, with their units;
--save draws its main figure.
"""
EXAMPLES = """\
examples:
  tactsim show results/annulus_icf
  tactsim show results/annulus_icf --save annulus.png
  tactsim show lumps.zarr --save taxels.png
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("result", metavar="RESULT_OR_STORE", type=Path, help="folder that tactsim run or sweep wrote")
    parser.add_argument("--save", metavar="FILE.png", type=Path, help="save the main figure")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    from tactsim.cli.report import result_report
    from tactsim.results import read_result

    if (arguments.result / "zarr.json").is_file():
        return _show_data_set(arguments)
    folder = arguments.result.parent if arguments.result.name == "result.json" else arguments.result
    stored = read_result(folder, fields=arguments.save is not None)
    case = stored.provenance.get("case")
    console.out(result_report(stored.result, str(case.get("title", "")) if isinstance(case, dict) else ""))
    console.out(f"  case {stored.case_id}")
    if arguments.save is not None:
        from tactsim.cli.figures import rendered_figures
        from tactsim.results.storage import replace_file

        figures, warnings = rendered_figures(stored.result)
        if not figures:
            raise InputError("; ".join(warnings) or f"a result of kind {stored.result.kind!r} has no figure")
        replace_file(arguments.save, next(iter(figures.values())))
        console.out(f"figure {arguments.save}")
    return 0


def _show_data_set(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.description import description

    console.out(description(arguments.result))
    if arguments.save is not None:
        from tactsim.display.dataset_card import card_figures
        from tactsim.results.storage import replace_file

        drawings = card_figures(arguments.result)
        if not drawings:
            raise InputError(f"{arguments.result} has no sample that is done, and so no figure")
        replace_file(arguments.save, drawings[list(drawings)[-1]]())
        console.out(f"figure {arguments.save}")
    return 0
