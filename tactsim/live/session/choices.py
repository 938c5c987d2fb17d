"""The estimators that a page offers: those of the project, a learned one from its weights, and the estimate of a result."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from tactsim.errors import StorageError, TactsimError
from tactsim.experiments.localization.scene import EstimatedShape, LocalizedGrasp
from tactsim.interfaces.estimate import PARAMETERS, Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.live.sources.recorded import DAMAGE
from tactsim.localization.estimators.any_estimator import offered_estimators
from tactsim.localization.estimators.learned import LearnedEstimator
from tactsim.outside.text import one_line
from tactsim.results.reading import read_result
from tactsim.results.result import Quantity


class Finder(Protocol):
    """What finds inclusions: an estimator, or the memory of one."""

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
    estimator: Finder
    needs_reference: bool


def offered_choices() -> tuple[Choice, ...]:
    """Every variant of every registered estimator, the one that needs least first."""
    return tuple(Choice(name, one.title, one, one.needs_reference) for name, one in offered_estimators().items())


@dataclass(frozen=True)
class StoredEstimate:
    """What an estimator found when the result was computed, whatever is read."""

    found: Estimate
    needs_response: bool = False

    def estimate(self, readings: Readings) -> Estimate:
        """The same for all readings."""
        return self.found


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
    try:
        scene = result.scene_as(LocalizedGrasp)
    except TactsimError as error:
        told = f"{one_line(folder)}/result.json is not a complete result of a localization: {one_line(error)}"
        raise StorageError(told) from None
    try:
        inclusions = [_inclusion(one, result.quantities if k == 0 else {}) for k, one in enumerate(scene.estimates)]
        found = Estimate(bool(inclusions), tuple(inclusions), result.reason)
    except DAMAGE as error:
        told = f"{one_line(folder)}/result.json is not a complete result of a localization: {one_line(error)}"
        raise StorageError(f"{told}; run it again") from None
    return Choice("stored", f"As stored: {scene.estimator}"[:60], StoredEstimate(found), False)


def _inclusion(found: EstimatedShape, quantities: dict[str, Quantity]) -> EstimatedInclusion:
    """An estimated inclusion; contrast and deviations are told of the first one, in the quantities."""
    contrast = float(quantities["estimated_contrast"].value) if "estimated_contrast" in quantities else None
    covariance = None
    if "center_deviation" in quantities:
        others = (quantities[f"{name}_deviation"].value for name in PARAMETERS[3:])
        covariance = np.diag(np.array([*quantities["center_deviation"].value, *others], dtype=float) ** 2)
    return EstimatedInclusion(found.kind, found.center, found.radius, contrast, covariance, line=found.line)
