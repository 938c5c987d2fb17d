"""The confusion table of an estimator on a data set of grasps: counted, and written as numbers and as a table to read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.ranking.reference import warn_of_inclusions
from tactsim.dataset.ranking.samples import check_all_same, first_grasp, refuse_reopened
from tactsim.dataset.sampling.stored import stored_sweep
from tactsim.dataset.store.opening import Store
from tactsim.dataset.use.loading import load
from tactsim.errors import InputError
from tactsim.experiments.localization.confusion import ConfusionTable, class_of, estimated_class
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.source import readings_of, same_closing, stored_grasp
from tactsim.interfaces import Estimator
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.interfaces.readings import ROUNDING_NOISE, noise_in_words
from tactsim.localization.checked_estimate import estimate_of
from tactsim.localization.estimators.hypotheses import CLASSES
from tactsim.localization.lump_response import LumpResponse
from tactsim.outside.text import markdown_table

if TYPE_CHECKING:
    import xarray

SCHEMA = "tactsim/confusion/1"


def store_confusion(
    store: str | Path,
    reference: str,
    estimator: Estimator,
    *,
    split: str | None = None,
    noise: float = ROUNDING_NOISE,
    seed: int = 1,
    response: LumpResponse | None = None,
) -> tuple[ConfusionTable, int]:
    """Counts over the samples that are done, and the number of those left out because they belong to no class.

    The forces of the solution are read with seeded Gaussian noise of the standard deviation ``noise`` in N; ``reference`` is the
    folder of a grasp of plain tissue at the closing of all samples; its response is computed unless it is given.

    Raises
    ------
    StorageError
        If the store or the reference cannot be read, or a sample is not what was written.
    InputError
        If no sample is done, it has no inclusions, another block, matrix or closing than the reference, or opens again before
        its end.
    """
    data = _grasps(store, split)
    stored = stored_grasp(reference)
    warn_of_inclusions(stored)
    plain = readings_of(stored, noise=noise)
    sweep = stored_sweep(Store.open(store))
    experiment = first_grasp(sweep, Path(store).name)
    check_all_same(sweep, data, experiment, plain, Path(store).name)
    refuse_reopened(experiment, Path(store).name)
    forces = np.asarray(data[TAXEL_FORCE].values, dtype=float)[:, -1]
    _check_closings(data["closing"].values, plain.closing)
    if estimator.needs_response and response is None:
        response = stored_response(reference)
    table, others = ConfusionTable(), 0
    for number, change, true in zip(data["sample"].values, forces, _true_classes(data), strict=True):
        if true is None:
            others += 1
            continue
        added = noise * np.random.default_rng([seed, int(number)]).standard_normal((2, *change.shape))
        readings = replace(plain, forces=change + added[0], reference=plain.forces + added[1], response=response)
        table.add(true, estimated_class(estimate_of(estimator, readings)))
    return table, others


def _grasps(store: str | Path, split: str | None) -> xarray.Dataset:
    """The grasps of a store that are done, with all that is counted of them."""
    data = load(store, split=split, verified=True)
    if not data.sizes["sample"]:
        raise InputError(f"{Path(store).name} has no sample that is done; run the sweep first")
    missing = [name for name in (TAXEL_FORCE, "inclusion_kind", "inclusion_count", "closing") if name not in data]
    if missing:
        raise InputError(f"{Path(store).name} has no {missing[0]}; needed: a data set of grasps with taxels")
    return data


def _true_classes(data: xarray.Dataset) -> list[str | None]:
    """Class of each sample by its inclusions, None if they are of no class."""
    names = str(data["inclusion_kind"].attrs["flag_meanings"]).split()
    kinds, counts = data["inclusion_kind"].values, data["inclusion_count"].values
    return [class_of([names[int(kind)] for kind in row[: int(count)]]) for row, count in zip(kinds, counts, strict=True)]


def _check_closings(closings: Array, reference: float | None) -> None:
    """Refuse samples that close by more or less than the reference."""
    if reference is None or not np.isfinite(closings).all():
        raise InputError("the samples or the reference do not state their closing; needed: a prescribed displacement of the jaws")
    if not same_closing(closings, reference):
        raise InputError(
            f"the samples close by {closings.min():g} to {closings.max():g} m, the reference by {reference:g} m; needed: the same"
        )


def record(table: ConfusionTable, others: int, about: Mapping[str, Any]) -> dict[str, Any]:
    """All numbers of a table; ``about`` describes the run, with the ``noise`` in N; ``others`` samples belong to no class."""
    return {
        "schema": SCHEMA,
        **about,
        "classes": list(CLASSES),
        "counts": table.counts.tolist(),
        "samples": table.total,
        "of_no_class": others,
        "share_right": table.share_right,
        "recalls": dict(zip(CLASSES, table.recalls, strict=True)),
    }


def verdict(content: Mapping[str, Any]) -> str:
    """How many grasps were classified rightly, as a sentence."""
    right = sum(row[k] for k, row in enumerate(content["counts"]))
    return f"{right} of {content['samples']} grasps named right"


def as_text(content: Mapping[str, Any], figures: Mapping[str, bytes]) -> str:
    """The table in Markdown, true classes down and estimated ones across; a class that does not occur has no row."""
    names = [name.replace("_", " ") for name in content["classes"]]
    rows = [
        [shown, *counts, f"{100 * content['recalls'][name]:.0f} %"]
        for name, shown, counts in zip(content["classes"], names, content["counts"], strict=True)
        if content["recalls"][name] is not None
    ]
    lines = [
        "# Confusion table",
        "",
        f"{verdict(content)} by `{content['estimator']}`, noise of a reading {noise_in_words(content['noise'])}; "
        f"{content['of_no_class']} samples belong to no class.",
        "",
        *markdown_table(["true / estimated", *names, "right"], rows),
    ]
    return "\n".join([*lines, "", *(f"![{name}]({name})" for name in figures), ""])
