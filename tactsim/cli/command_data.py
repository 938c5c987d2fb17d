"""``tactsim data``: checks, describes and exports a data set, ranks estimators on it and trains one."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactsim.cli import console
from tactsim.cli.data_actions import CONFUSION, RANKING
from tactsim.cli.data_actions import EXAMPLES as EXAMPLES
from tactsim.cli.data_actions import add_arguments as add_arguments
from tactsim.errors import NOT_AS_RECORDED, InputError, StorageError, TactsimError
from tactsim.outside.defect_place import unless_own
from tactsim.outside.text import counted, one_line

if TYPE_CHECKING:
    from tactsim.dataset.ranking.samples import JudgedSamples

NAME = "data"
SUMMARY = "check, describe or export a data set, judge estimators on it"
DESCRIPTION = """\
What is done with a data set that tactsim sweep wrote: tactsim data ACTION --help says what an
action does and what it takes.
"""
MOST_FINDINGS, MOST_NOTES = 100, 10
"""Lines that are printed; the rest of the findings are counted."""
REPORT = ("report.json", "report.md")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    TactsimError
        Whatever ends the command with an exit code of its own, such as options that do not go together.
    """
    actions = {"check": _check, "info": _info, "export": _export, "rank": _rank, "train": _train, CONFUSION: _confusion}
    return actions[arguments.action](arguments)


def _check(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.checking import check

    checked = check(arguments.store)
    for note in checked.notes[:MOST_NOTES]:
        console.note(f"note: {one_line(note)}")
    for finding in checked.findings[:MOST_FINDINGS]:
        console.out(str(finding))
    if len(checked.findings) > MOST_FINDINGS:
        console.out(f"and {len(checked.findings) - MOST_FINDINGS} more")
    counts = ", ".join(f"{count} {name}" for name, count in checked.counts.items())
    verdict = counted(len(checked.findings), "finding") if checked.findings else "nothing found"
    console.out(f"{one_line(arguments.store)}: {counts or 'not read'}; {verdict}")
    return NOT_AS_RECORDED if checked.findings else 0


def _info(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.use.card import description

    console.out(description(arguments.store))
    return 0


def _export(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.use.export import exported

    if arguments.to is None:
        raise InputError("export: --to is missing; name a file ending in .h5, or a folder for Parquet and npz")
    count = exported(arguments.store, arguments.to, split=arguments.split)
    console.out(f"{counted(count, 'sample')} in {arguments.to}")
    return 0


def _rank(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.figures.estimator_ranking import ranking_figures
    from tactsim.dataset.ranking.measures import ranking
    from tactsim.dataset.ranking.report import as_summary, as_text, record
    from tactsim.dataset.ranking.training import seen_in_training
    from tactsim.experiments.localization.response_store import stored_response
    from tactsim.localization.estimators.any_estimator import offered_estimators
    from tactsim.localization.estimators.learned import LearnedEstimator
    from tactsim.localization.networks import read_weights

    folder = arguments.out or Path(RANKING)
    _refuse_place(folder)
    samples = _samples(arguments)
    estimators = offered_estimators()
    if arguments.learned is not None:
        estimators["learned"] = LearnedEstimator.checked(arguments.learned)
    seen = 0 if arguments.learned is None else seen_in_training(read_weights(arguments.learned), samples)
    failed: dict[str, Exception] = {}
    response = stored_response(samples.plain.folder)
    ranked = ranking(estimators, samples, response, seed=arguments.seed, failed=failed.__setitem__)
    if not ranked:
        raise next(iter(failed.values()))
    reasons = {name: _reason(error) for name, error in failed.items()}
    about = {"store": arguments.store.name, "split": arguments.split, "seed": arguments.seed, "seen_in_training": seen}
    content = record(ranked, samples, about | {"failed": reasons})
    drawn = _drawn(lambda: ranking_figures(content))
    text = as_text(ranked, samples, tuple(drawn), seen, failed=reasons)
    _write(folder, content, text, drawn)
    console.out(as_summary(ranked, samples, seen))
    console.out(f"report in {folder}")
    for name, reason in reasons.items():
        console.error(f"{name} failed and is not ranked: {reason}")
    return next((_code(error) for error in failed.values()), 0)


def _reason(error: Exception) -> str:
    """Why an estimator is not ranked."""
    if isinstance(error, TactsimError):
        return one_line(error)
    return f"internal error ({type(error).__name__}: {one_line(error)}); please report it{unless_own(error)}"


def _code(error: Exception) -> int:
    """The exit code of a command that it would have ended."""
    return error.exit_code if isinstance(error, TactsimError) else TactsimError.exit_code


def _confusion(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.ranking.confusion import as_text, record, store_confusion, verdict
    from tactsim.experiments.localization.figures.confusion import confusion_png
    from tactsim.interfaces.readings import ROUNDING_NOISE
    from tactsim.localization.estimators.any_estimator import offered_estimators

    if len(arguments.reference) > 1:
        raise InputError("confusion: takes one --reference")
    folder = arguments.out or Path(CONFUSION)
    _refuse_place(folder)
    classifying = [one for one in offered_estimators().values() if one.gives_classes]
    estimator, given = classifying[0], _noise(arguments)
    noise = ROUNDING_NOISE if given is None else given
    split, seed = arguments.split, arguments.seed
    table, others = store_confusion(arguments.store, _references(arguments)[0], estimator, split=split, noise=noise, seed=seed)
    about = {"store": arguments.store.name, "split": split, "seed": seed, "estimator": estimator.kind, "noise": noise}
    content = record(table, others, about)
    title = f"{arguments.store.name}: {verdict(content)}"
    drawn = _drawn(lambda: {"confusion.png": lambda: confusion_png(content["counts"], content["classes"], title)})
    text = as_text(content, drawn)
    _write(folder, content, text, drawn)
    console.out(text.split("\n![")[0].rstrip())
    console.out(f"report in {folder}")
    return 0


def _drawn(drawings: Callable[[], Mapping[str, Callable[[], bytes]]]) -> dict[str, bytes]:
    """File name -> PNG bytes; a note for what could not be drawn."""
    from tactsim.cli.figures.result_figures import drawn_figures

    drawn, warnings = drawn_figures(drawings)
    for warning in warnings:
        console.note(f"warning: {warning}")
    return drawn


def _write(folder: Path, content: Mapping[str, Any], text: str, figures: Mapping[str, bytes]) -> None:
    """Writes report.json, in which every number is finite, report.md and the figures."""
    from tactsim.storage.files import naming
    from tactsim.storage.own_files import OwnFiles

    with naming(folder):
        folder.mkdir(parents=True, exist_ok=True)
    record, files = (json.dumps(content, indent=1, allow_nan=False) + "\n").encode(), OwnFiles(folder)
    files.refuse_foreign(*REPORT, *figures)
    for name, written in {**dict(zip(REPORT, (record, text.encode()), strict=True)), **figures}.items():
        files.replace(name, written)


def _refuse_place(folder: Path) -> None:
    """Refuses a folder for a report that holds something else, before anything is computed."""
    from tactsim.storage.own_files import OwnFiles

    if os.path.lexists(folder) and not folder.is_dir():
        raise StorageError(f"{one_line(folder)} exists and is not a folder; choose another with --out")
    if os.path.lexists(folder / "zarr.json"):
        raise StorageError(f"{one_line(folder)} is a data set; choose another folder with --out")
    OwnFiles(folder).refuse_foreign(*REPORT)


def _refuse_file(path: Path) -> None:
    """Refuses a place for an estimator at which something else than an estimator stands."""
    from tactsim.localization.estimators.learned import LearnedEstimator

    if not os.path.lexists(path):
        return
    try:
        LearnedEstimator.checked(path)
    except TactsimError as error:
        refusal = f"{one_line(path)} exists and is no estimator that tactsim wrote; choose another with --out ({error})"
        raise StorageError(refusal) from None


def _samples(arguments: argparse.Namespace, split: list[str] | None = None) -> JudgedSamples:
    """The samples that are judged or trained on, as the options say."""
    from tactsim.dataset.ranking.samples import judged_samples

    references, noise = _references(arguments), _noise(arguments)
    chosen, source = arguments.split or split, arguments.readings
    return judged_samples(arguments.store, references, split=chosen, source=source, noise=noise)


def _references(arguments: argparse.Namespace) -> list[str]:
    """Folders of plain grasps, at least one."""
    if not arguments.reference:
        raise InputError(f"{arguments.action}: --reference is missing; give the result of the same grasp without a lump")
    references: list[str] = arguments.reference
    return references


def _noise(arguments: argparse.Namespace) -> float | None:
    """What is added to the readings in N, None if nothing is said of it."""
    from tactsim.cli.option_values import quantity_of

    if arguments.noise is None:
        return None
    noise = quantity_of("--noise", arguments.noise, "N")
    if not 0 <= noise < float("inf"):
        raise InputError(f"--noise {arguments.noise}; allowed: a finite force that is not negative, such as '2 mN'")
    return noise


def _train(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.ranking.training import trained
    from tactsim.experiments.localization.response_store import stored_response
    from tactsim.storage.files import replace_file

    if arguments.out is None or arguments.out.suffix != ".npz":
        given = "--out is missing" if arguments.out is None else f"--out {one_line(arguments.out)} is no place for weights"
        raise InputError(f"train: {given}; name a file ending in .npz")
    _refuse_file(arguments.out)
    samples = _samples(arguments, ["train"])
    learned = trained(samples, stored_response(samples.plain.folder), seed=arguments.seed)
    replace_file(arguments.out, learned.content())
    console.out(f"{learned.summary()}; estimator in {arguments.out}")
    return 0
