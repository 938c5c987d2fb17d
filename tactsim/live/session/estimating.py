"""Readings of a frame for an estimator, and its estimate in words with its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.deadline import stopped_by
from tactsim.errors import InputError
from tactsim.experiments.localization.source import away_from_truth, with_reference
from tactsim.interfaces.estimate import NO_ERROR, NO_ERRORS, Estimate, EstimatedInclusion, decimals_of_places
from tactsim.interfaces.readings import Readings, shown_change
from tactsim.live.session.choices import STORED, Choice
from tactsim.live.sources.noise import given_noise
from tactsim.live.sources.reference import Reference
from tactsim.live.sources.scene import Frame, PageScene
from tactsim.live.sources.watch import Watch
from tactsim.localization.checked_estimate import estimate_of
from tactsim.localization.lump_response import stiffness_words
from tactsim.localization.plain_parts import plain_parts_warning
from tactsim.localization.region import shadows
from tactsim.units import format_quantity

DIGITS = 3
"""Decimals in mm of an outline."""
BARE = "From bare forces, in which plain tissue, too, is bright in the middle; a reference removes this effect"
"""Said of an estimate without a reference."""


def frame_readings(
    scene: PageScene, frame: Frame, choice: Choice, reference: Reference | None, noise: float | None = None
) -> Readings:
    """Readings of a frame with what an estimator needs beside its model of the tissue; ``noise`` in N replaces the frame's.

    Raises
    ------
    InputError
        If there is no reference, or it is of another grasp.
    """
    readings = (frame if noise is None else replace(frame, noise=given_noise(noise))).readings(scene)
    if choice.plain is not None and choice.plain.shape == readings.forces.shape:
        return replace(readings, reference=choice.plain)
    if not choice.needs_reference:
        return readings
    if reference is None:
        raise InputError(f"{choice.label}: needs the same grasp without a lump; give its result by --reference FOLDER")
    return with_reference(readings, reference.frame_for(frame).readings(reference.scene))


def shown_signal(readings: Readings) -> tuple[Array, str]:
    """What the views draw, (jaw, row, column) in N, and what it is: the force, or its strongest change from the reference."""
    if readings.difference is None:
        return readings.filled, "force"
    return shown_change(readings.difference)


def estimated(
    scene: PageScene, readings: Readings, choice: Choice, reference: Reference | None, watch: Watch | None = None
) -> dict[str, Any]:
    """The estimate as the page shows it.

    Raises
    ------
    InputError
        If the estimator cannot be used here; it says why.
    ConvergenceError
        If the response of the tissue cannot be computed.
    OutOfTime
        If it is not wanted any more.
    """
    watch = watch or Watch()
    if choice.estimator.needs_response and reference is not None:
        readings = replace(readings, response=reference.response(readings.closing, watch))
    watch.stage = "comparing what could be there with the readings"
    with stopped_by(watch.asked_to_stop):
        estimate = estimate_of(choice.estimator, readings)
    misfit = plain_parts_warning(readings, estimate)
    of_these = choice.name != STORED
    bare = [BARE] if readings.difference is None and estimate.inclusions and of_these else []
    noise = noise_words(readings) if of_these else ""
    return {
        "present": estimate.present,
        "words": [*_words(scene, estimate), *bare, *([] if misfit is None else [f"Warning: {misfit}"])],
        "errors": _errors(scene, estimate),
        "noise": noise,
        "inclusions": [_drawn(one) for one in estimate.inclusions],
    }


def noise_words(readings: Readings) -> str:
    """Which noise of a taxel the estimate rests on, where it comes from, and how another is given."""
    size = format_quantity(float(f"{readings.noise:.3g}"), "N")
    return (
        f"Noise of {size} on each taxel (one standard deviation): {readings.noise_origin}; start with --noise FORCE for another"
    )


def _drawn(one: EstimatedInclusion) -> dict[str, Any]:
    """The shape of an inclusion on the page, in mm: its centre, radius, centre line and, by view, the outlines of its region."""
    regions = {} if one.region is None else shadows(one.region)
    return {
        "center": (1e3 * np.array(one.center)).tolist(),
        "radius": None if one.radius is None else 1e3 * one.radius,
        "line": None if one.line is None else (1e3 * np.array(one.line)).tolist(),
        "region": {view: list(map(_outline, lines)) for view, lines in regions.items()},
    }


def _outline(line: Sequence[Sequence[float]]) -> list[float]:
    """A line (n, 2) in m as x, y, x, y, ... in mm."""
    flat: list[float] = (1e3 * np.array(line)).round(DIGITS).ravel().tolist()
    return flat


def _words(scene: PageScene, estimate: Estimate) -> list[str]:
    reason = estimate.reason[0].upper() + estimate.reason[1:]
    places = estimate.inclusions
    if len(places) > 1 and all(one.covariance is None for one in places):
        return [reason, *(_in_words(scene, one) for one in places), NO_ERRORS]
    return [reason, *(line for one in places for line in (_in_words(scene, one), *_uncertainty(one)))]


def _in_words(scene: PageScene, one: EstimatedInclusion) -> str:
    digits = decimals_of_places(scene.size)
    place = ", ".join(f"{1e3 * value:.{digits}f}" for value in one.center)
    kind = "" if one.kind == "unknown" else f"{one.kind} "
    size = "" if one.radius is None else f", radius {1e3 * one.radius:.{digits}f} mm"
    return f"{kind}at ({place}) mm{size}".capitalize()


def _uncertainty(one: EstimatedInclusion) -> list[str]:
    if one.covariance is None:
        return [NO_ERROR]
    deviations = np.sqrt(np.diag(one.covariance))
    x, y, z, radius = (f"{1e3 * value:.2g}" for value in deviations[:4])
    lines = [f"± ({x}, {y}, {z}) mm, radius ± {radius} mm (one standard deviation)"]
    return lines if one.contrast is None else [*lines, stiffness_words(one.contrast, float(deviations[4])).capitalize()]


def _errors(scene: PageScene, estimate: Estimate) -> list[str]:
    """Errors of the strongest inclusion against the true one nearest to it in plan, where the truth is known."""
    if scene.inclusions is None:
        return []
    if not scene.inclusions:
        return ["False alarm: there is no inclusion" if estimate.present else "True: there is no inclusion"]
    if not estimate.inclusions:
        count = len(scene.inclusions)
        return [f"Missed: there {'is one inclusion' if count == 1 else f'are {count} inclusions'}"]
    points = np.concatenate([shape.places(scene.size) for shape in scene.inclusions])
    _, lateral, depth = away_from_truth(np.array(estimate.inclusions[0].center), points)
    size = _radius_error(scene, estimate.inclusions[0])
    digits = decimals_of_places(scene.size)
    along = f"{round(1e3 * depth, digits) + 0.0:+.{digits}f} mm in height"
    first = " (the first)" if len(estimate.inclusions) > 1 else ""
    return [f"Off by {1e3 * lateral:.{digits}f} mm in plan and {along}{size}{first}"]


def _radius_error(scene: PageScene, one: EstimatedInclusion) -> str:
    true = getattr((scene.inclusions or (None,))[0], "radius", None)
    if one.radius is None or true is None or len(scene.inclusions or ()) != 1:
        return ""
    return f", radius off by {1e3 * (one.radius - true):+.{decimals_of_places(scene.size)}f} mm"
