"""Where a lump lies, from the readings of a grasp that was run before."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.eshelby_ball import stiffness_ratio_of
from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.experiments.grasp.scene import GraspScene, grasp_fields
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.scene import EstimatedShape, LocalizedGrasp
from tactsim.experiments.localization.source import (
    away_from_truth,
    jaw_notes,
    readings_of,
    reference_notes,
    stiffness_ratios,
    stored_grasp,
    unfinished_notes,
    with_reference,
)
from tactsim.interfaces import Experiment
from tactsim.interfaces.both_jaws import TAXEL_DIFFERENCE, TAXEL_FORCE, Source
from tactsim.interfaces.estimate import Estimate, inclusion_in_words
from tactsim.interfaces.readings import ROUNDING_NOISE, Readings, pulled_words, silent_taxels, silent_words
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.taxel_layout import JAWS, JawName, TaxelLayout
from tactsim.localization.checked_estimate import estimate_of
from tactsim.localization.estimators.any_estimator import AnyEstimator
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.localization.lump_response import stiffness_words
from tactsim.localization.plain_parts import plain_parts_warning
from tactsim.outside.input_path import InputPath
from tactsim.progress import elapsed_time
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, rows
from tactsim.units import Force, NonNegative, format_quantity

NO_ERROR = 1e-9
"""Error of a place in m that is round-off."""

Taxel = tuple[JawName, Annotated[int, Field(ge=1)], Annotated[int, Field(ge=1)]]


class Localization(Experiment):
    """Estimate from a stored grasp, held against the inclusions that it was computed with.

    Run a grasp first, for example ``tactsim run grasp_lump_icf --out results/grasp_lump_icf``, and the same grasp with
    ``material`` of the inclusion set to that of the tissue as ``reference``. Then::

        experiment:
          kind: localization
          grasp: results/grasp_lump_icf
          reference: results/grasp_plain
          estimator: {kind: thesis, background: reference}

    ``estimator: {kind: model_based}`` computes the response of the plain tissue from the case of the reference, once, and gives
    how uncertain place, radius and contrast are.
    """

    kind: Literal["localization"] = "localization"
    grasp: InputPath
    """Folder of the result of a grasp, beside the case or in the working folder."""
    reference: InputPath | None = None
    """Folder of the same grasp without a lump at the same closing; null if there is none."""
    readings: Source = TAXEL_FORCE
    """Forces of the solution, or what was read through film, electronics and calibration (a grasp with a ``readout``)."""
    noise: NonNegative[Force] = ROUNDING_NOISE
    """Standard deviation of a reading; the default is what rounding to the sensor's resolution of 0.1 N (thesis 6.2) does."""
    dead: tuple[Taxel, ...] = ()
    """Taxels (jaw, row, column) that cannot be trusted; they are interpolated from their neighbours."""
    estimator: AnyEstimator = ThesisEstimator()
    """How the inclusion is sought."""

    history_units: ClassVar[dict[str, str]] = {"total_upper": "N", "total_lower": "N"}

    @model_validator(mode="after")
    def _has_what_the_estimator_needs(self) -> Self:
        if self.reference is None and self.estimator.needs_reference:
            raise ValueError(
                f"reference is missing: the estimator {self.estimator.kind} needs readings of the tissue without a lump; name "
                "the result of such a grasp, or take estimator: {kind: thesis, background: none}"
            )
        return self

    @classmethod
    def example(cls) -> Self:
        """The lump of the shipped result of a grasp, by what it differs from that of plain tissue."""
        estimator = ThesisEstimator(background="reference")
        return cls(grasp="cases/stored/grasp_lump", reference="cases/stored/grasp_plain", noise=1e-3, estimator=estimator)

    def begin(self) -> Course:
        """One step: the last of the grasp.

        Raises
        ------
        StorageError
            If a result is missing or cannot be read.
        InputError
            If one is not that of a grasp with taxels, the reference has another block, matrix or closing, a dead taxel is none of
            the matrix, or the estimator refuses the readings.
        """
        stored = stored_grasp(self.grasp)
        plain = None if self.reference is None else stored_grasp(self.reference)
        readings = self._readings(stored, plain)
        with elapsed_time(f"estimating: {self.estimator.kind.replace('_', ' ')}"):
            estimate = estimate_of(self.estimator, readings)
        scene = stored.scene_as(GraspScene)
        true = [shape.places(readings.block_size) for shape in scene.true_inclusions]
        return Course.computed(
            Findings(
                estimate.reason,
                rows(self.history_units, readings.filled.sum(axis=(1, 2))[:, None]),
                quantities=_taxel_quantities(readings)
                | _estimate_quantities(estimate)
                | _error_quantities(estimate, true)
                | _stiffness_quantities(estimate, stiffness_ratios(self.grasp, readings.closing)),
                assumptions=(f"noise of a reading {format_quantity(self.noise, 'N')} (one standard deviation)",),
                warnings=[*self._warnings(stored, plain, readings), *_of_the_estimate(readings, estimate)],
                scene=self._scene(scene, readings, estimate),
            )
        )

    def _scene(self, grasp: GraspScene, readings: Readings, estimate: Estimate) -> LocalizedGrasp:
        return LocalizedGrasp(
            **grasp_fields(grasp),
            estimates=tuple(map(EstimatedShape.of, estimate.inclusions)),
            estimator=self.estimator.kind,
            noise=self.noise,
            valid=None if readings.valid is None else readings.valid.tolist(),
            words=tuple(map(inclusion_in_words, estimate.inclusions)),
            reference_unused=self._leaves_reference_out(readings),
        )

    def _leaves_reference_out(self, readings: Readings) -> bool:
        return readings.difference is not None and not self.estimator.needs_reference

    def _readings(self, stored: Result, plain: Result | None) -> Readings:
        dead = self._dead(stored.scene_as(GraspScene).matrix)
        readings = readings_of(stored, self.readings, noise=self.noise, dead=dead)
        if self.reference is None or plain is None:
            return readings
        readings = with_reference(readings, readings_of(plain, self.readings, noise=self.noise, dead=None))
        return replace(readings, response=stored_response(self.reference)) if self.estimator.needs_response else readings

    def _dead(self, layout: TaxelLayout) -> Array:
        dead = np.zeros((len(JAWS), layout.rows, layout.columns), bool)
        for side, row, column in self.dead:
            if row > layout.rows or column > layout.columns:
                raise InputError(
                    f"dead: taxel {side}, {row}, {column} of a matrix of {layout.rows} rows and {layout.columns} columns"
                )
            dead[JAWS.index(side), row - 1, column - 1] = True
        return dead

    def _warnings(self, stored: Result, plain: Result | None, readings: Readings) -> list[str]:
        warnings = [*unfinished_notes(stored, self.grasp)]
        if readings.valid is not None:
            warnings.append(f"dead or saturated taxels, interpolated from their neighbours: {int((~readings.valid).sum())}")
        silent = silent_taxels(readings.filled)
        if silent.any():
            warnings.append(f"{silent_words(silent)}; name dead taxels by the key dead")
        if (pulled := pulled_words(readings.filled, self.noise)) is not None:
            warnings.append(pulled)
        if self._leaves_reference_out(readings):
            warnings.append("the reference was not used: this estimator reads the forces as they are; take background: reference")
        if plain is None:
            return warnings
        reference = plain.scene_as(GraspScene)
        return [*warnings, *reference_notes(reference.true_inclusions), *jaw_notes(stored.scene_as(GraspScene), reference)]


def _of_the_estimate(readings: Readings, estimate: Estimate) -> list[str]:
    """What the user must know of an estimate."""
    misfit = plain_parts_warning(readings, estimate)
    return [*_several_places(estimate), *([] if misfit is None else [misfit])]


def _several_places(estimate: Estimate) -> list[str]:
    """The places of an estimator of one inclusion that several explain better; those of classes state their number anyway."""
    if estimate.classes is not None or len(estimate.inclusions) < 2:
        return []
    places = "; ".join(map(inclusion_in_words, estimate.inclusions))
    return [
        f"no one place explains the readings, the quantities are those of the strongest of {len(estimate.inclusions)}: {places}"
    ]


def _taxel_quantities(readings: Readings) -> dict[str, Quantity]:
    quantities = {}
    for jaw, side in enumerate(JAWS):
        of = f"of the {side} jaw; [row][column], row 1 nearest the front, column 1 the smallest x"
        quantities[f"{TAXEL_FORCE}_{side}"] = Quantity(readings.filled[jaw].tolist(), "N", f"force on each taxel {of}")
        if readings.difference is not None:
            text = f"force on each taxel less that of the reference, {of}"
            quantities[f"{TAXEL_DIFFERENCE}_{side}"] = Quantity(readings.difference[jaw].tolist(), "N", text)
    return quantities


def _estimate_quantities(estimate: Estimate) -> dict[str, Quantity]:
    quantities = {"present": Quantity(int(estimate.present), "1", "1 if anything is there, 0 if nothing is")}
    if estimate.probability is not None:
        quantities["probability"] = Quantity(estimate.probability, "1", "that anything is there")
    if estimate.factor is not None:
        text = "readings of plain tissue over those of the reference, from stiffness and gain together"
        quantities["reference_factor"] = Quantity(estimate.factor, "1", text)
    if estimate.classes is not None:
        names = ", ".join(estimate.classes)
        quantities["class_probabilities"] = Quantity(
            list(estimate.classes.values()), "1", f"probability of each [class]: {names}"
        )
    if not estimate.inclusions:
        return quantities
    first = estimate.inclusions[0]
    quantities["estimated_center"] = Quantity(
        list(first.center), "m", "(x, y, z) of the strongest inclusion, in the undeformed block"
    )
    if first.radius is not None:
        quantities["estimated_radius"] = Quantity(first.radius, "m", "radius of the strongest inclusion")
    if first.contrast is not None:
        quantities["estimated_contrast"] = Quantity(
            first.contrast, "1", "contrast of the strongest inclusion at the working strain, 0 for tissue, negative if softer"
        )
    if first.covariance is not None:
        deviations = np.sqrt(np.diag(first.covariance))
        quantities["center_deviation"] = Quantity(deviations[:3].tolist(), "m", "standard deviations (x, y, z)")
        quantities["radius_deviation"] = Quantity(float(deviations[3]), "m", "standard deviation of the radius")
        if first.contrast is not None:
            quantities["contrast_deviation"] = Quantity(float(deviations[4]), "1", "standard deviation of the contrast")
    return quantities


def _stiffness_quantities(estimate: Estimate, true: tuple[tuple[float, float], ...]) -> dict[str, Quantity]:
    """Stiffness over that of the tissue, 1 for tissue: as estimated, and of every true inclusion."""
    quantities = {}
    contrast = estimate.inclusions[0].contrast if estimate.inclusions else None
    if contrast is not None and np.isfinite(stiffness_ratio_of(contrast)):
        text = "stiffness of the strongest inclusion over that of the tissue at the working strain, taken for a small ball"
        if (covariance := estimate.inclusions[0].covariance) is not None:
            text += f"; within a standard deviation {stiffness_words(contrast, float(np.sqrt(covariance[4][4])))}"
        quantities["estimated_stiffness_ratio"] = Quantity(stiffness_ratio_of(contrast), "1", text)
    if true:
        working, rest = ([pair[k] for pair in true] for k in (0, 1))
        text = "stress of each true inclusion over that of the tissue at the working strain, the mean one of plain tissue"
        quantities["true_stiffness_ratio"] = Quantity(working, "1", text)
        quantities["true_stiffness_ratio_at_rest"] = Quantity(
            rest, "1", "the same at small strain: the ratio of the shear moduli"
        )
    return quantities


def _beyond_round_off(error: float) -> float:
    """An error in m; zero where it is round-off, as in a grasp that is its own mirror image."""
    return 0.0 if abs(error) < NO_ERROR else float(error)


def _error_quantities(estimate: Estimate, true: list[Array]) -> dict[str, Quantity]:
    """Errors of the strongest inclusion against the true one nearest to it in plan."""
    if not estimate.inclusions or not true:
        return {}
    nearest, lateral, depth = away_from_truth(np.array(estimate.inclusions[0].center), np.concatenate(true))
    of = "of the strongest inclusion from the nearest true one (its centre, or the centre line of an artery)"
    return {
        "true_center": Quantity(
            nearest.tolist(), "m", "(x, y, z) of the true inclusion nearest in plan, in the undeformed block"
        ),
        "lateral_error": Quantity(_beyond_round_off(lateral), "m", f"distance in plan {of}"),
        "depth_error": Quantity(_beyond_round_off(depth), "m", f"height {of}; positive if estimated too near to the upper jaw"),
    }
