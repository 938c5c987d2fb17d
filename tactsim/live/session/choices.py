"""The estimators that a page offers: those of the project, a learned one from its weights, and the estimate of a result."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from tactsim.array import Array
from tactsim.errors import StorageError, TactsimError
from tactsim.experiments.localization.scene import EstimatedShape, LocalizedGrasp
from tactsim.interfaces.both_jaws import TAXEL_DIFFERENCE, TAXEL_FORCE, has_taxels, jaws_at_end
from tactsim.interfaces.estimate import PARAMETERS, Estimate, EstimatedInclusion, Region
from tactsim.interfaces.readings import Readings
from tactsim.live.sources.recorded import DAMAGE
from tactsim.localization.estimators.any_estimator import offered_estimators
from tactsim.localization.estimators.learned import LearnedEstimator
from tactsim.localization.region import GaussianRegion
from tactsim.outside.text import one_line
from tactsim.results.quantity import Quantity
from tactsim.results.reading import read_result

STORED = "stored"
"""Name of the choice of a stored estimate, which rests on the readings of its own time."""


class AnyEstimation(Protocol):
    """What estimates inclusions: an estimator, or an estimate that was stored."""

    @property
    def needs_response(self) -> bool:
        """Whether it needs the fast forward model of the tissue."""

    def estimate(self, readings: Readings) -> Estimate:
        """What is there, and where."""


@dataclass(frozen=True)
class Choice:
    """An estimator that the page offers."""

    name: str
    label: str
    estimator: AnyEstimation
    needs_reference: bool
    plain: Array | None = field(default=None, repr=False, compare=False)
    """Forces (jaw, row, column) in N of the reference that the estimate was made with, which are taken off in the views."""


def offered_choices() -> tuple[Choice, ...]:
    """Every variant of every registered estimator, those that need least before the others."""
    return tuple(Choice(name, one.title, one, one.needs_reference) for name, one in offered_estimators().items())


@dataclass(frozen=True)
class StoredEstimate:
    """The estimate that was made when the result was computed, whatever is read."""

    stored: Estimate
    needs_response: bool = False

    def estimate(self, readings: Readings) -> Estimate:
        """The same for all readings."""
        return self.stored


def learned_choice(weights: str) -> Choice:
    """The learned estimator of a file of weights.

    Raises
    ------
    StorageError
        If it cannot be read, or holds no weights of this version.
    """
    learned = LearnedEstimator.checked(weights)
    return Choice(learned.kind, learned.title, learned, learned.needs_reference)


def stored_choice(folder: str | Path) -> Choice | None:
    """The estimate that the result in a folder holds, None if it is no localization.

    Raises
    ------
    StorageError
        If the result is damaged.
    """
    result = read_result(folder, fields=False).result
    if result.kind != LocalizedGrasp.model_fields["kind"].default:
        return None
    incomplete = f"{one_line(folder)}/result.json is not a complete result of a localization"
    try:
        scene = result.scene_as(LocalizedGrasp)
    except TactsimError as error:
        raise StorageError(f"{incomplete}: {one_line(error)}") from None
    try:
        inclusions = [_inclusion(one, result.quantities if k == 0 else {}) for k, one in enumerate(scene.estimates)]
        estimate = Estimate(bool(inclusions), tuple(inclusions), result.reason)
        plain: Array | None = None
        if has_taxels(result, TAXEL_DIFFERENCE):
            plain = jaws_at_end(result, TAXEL_FORCE) - jaws_at_end(result, TAXEL_DIFFERENCE)
    except DAMAGE as error:
        raise StorageError(f"{incomplete}: {one_line(error)}; run it again") from None
    return Choice(STORED, f"As stored: {scene.estimator.replace('_', ' ')}"[:60], StoredEstimate(estimate), False, plain)


def _inclusion(shape: EstimatedShape, quantities: dict[str, Quantity]) -> EstimatedInclusion:
    """An estimated inclusion; contrast and deviations are stated of the first one, in the quantities.

    Its region is the one that was kept; a result of a version that kept none has that of its standard deviations.
    """
    contrast = float(quantities["estimated_contrast"].value) if "estimated_contrast" in quantities else None
    covariance: Array | None = None
    region: Region | None = None
    if "center_deviation" in quantities:
        names = [f"{name}_deviation" for name in PARAMETERS[3:]]
        others = (quantities[name].value for name in names if name in quantities)
        covariance = np.diag(np.array([*quantities["center_deviation"].value, *others], dtype=float) ** 2)
        if (np.diag(covariance)[:3] > 0).all():
            region = GaussianRegion(np.array(shape.center), covariance[:3, :3])
    inclusion = shape.inclusion(contrast, covariance)
    return replace(inclusion, region=inclusion.region or region)
