"""The confusion table of an estimator on a data set of grasps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tactsim.dataset.loading import load
from tactsim.errors import InputError
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.source import SAME_CLOSING, readings_of, stored_grasp
from tactsim.interfaces import Estimator
from tactsim.interfaces.readings import ROUNDING_NOISE
from tactsim.localization.confusion import ConfusionTable, class_of, estimated_class
from tactsim.localization.lump_response import LumpResponse

Array = np.ndarray


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
        If the store or the reference cannot be read.
    InputError
        If no sample is done, it has no inclusions, or another matrix or closing than the reference.
    """
    data = load(store, split=split)
    if not data.sizes["sample"]:
        raise InputError(f"{Path(store).name} has no sample that is done; run the sweep first")
    missing = [name for name in ("taxel_force", "inclusion_kind", "inclusion_count", "closing") if name not in data]
    if missing:
        raise InputError(f"{Path(store).name} has no {missing[0]}; needed: a data set of grasps with taxels")
    plain = readings_of(stored_grasp(reference), noise=noise)
    forces = np.asarray(data["taxel_force"].values, dtype=float)[:, -1]
    if forces.shape[1:] != plain.forces.shape:
        raise InputError(f"the samples have (jaw, row, column) = {forces.shape[1:]}, the reference {plain.forces.shape}")
    _check_closings(data["closing"].values, plain.closing)
    if estimator.needs_response and response is None:
        response = stored_response(reference)
    names = str(data["inclusion_kind"].attrs["flag_meanings"]).split()
    table, others = ConfusionTable(), 0
    for number, change in zip(data["sample"].values, forces, strict=True):
        sample = data.sel(sample=number)
        kinds = sample["inclusion_kind"].values[: int(sample["inclusion_count"].values)]
        true = class_of([names[int(kind)] for kind in kinds])
        if true is None:
            others += 1
            continue
        added = noise * np.random.default_rng([seed, int(number)]).standard_normal((2, *change.shape))
        readings = replace(plain, forces=change + added[0], reference=plain.forces + added[1], response=response)
        table.add(true, estimated_class(estimator.estimate(readings)))
    return table, others


def _check_closings(closings: Array, reference: float | None) -> None:
    """Refuse samples that close by more or less than the reference."""
    if reference is None or not np.isfinite(closings).all():
        raise InputError("the samples or the reference do not tell their closing; needed: a prescribed displacement of the jaws")
    away = float(np.abs(closings - reference).max())
    if away > SAME_CLOSING * reference:
        raise InputError(
            f"the samples close by {closings.min():g} to {closings.max():g} m, the reference by {reference:g} m; needed: the same"
        )
