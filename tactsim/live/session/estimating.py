"""Readings of a frame for an estimator, and what it finds, in words with its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.experiments.localization.source import away_from_truth, with_reference
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings, shown_change
from tactsim.live.session.choices import Choice
from tactsim.live.sources.reference import Reference
from tactsim.live.sources.scene import Frame, PageScene
from tactsim.localization.region import shadows

DIGITS = 3
"""Decimals in mm of an outline."""


def frame_readings(
    scene: PageScene, frame: Frame, choice: Choice, reference: Reference | None, noise: float | None = None
) -> Readings:
    """Readings of a frame with what an estimator needs beside its model of the tissue; ``noise`` in N replaces the scene's.

    Raises
    ------
    InputError
        If there is no reference, or it is of another grasp.
    """
    readings = frame.readings(scene if noise is None else replace(scene, noise=noise))
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


def estimated(scene: PageScene, readings: Readings, choice: Choice, reference: Reference | None) -> dict[str, Any]:
    """What an estimator finds, as the page shows it.

    Raises
    ------
    InputError
        If the estimator cannot be used here; it says why.
    ConvergenceError
        If the response of the tissue cannot be computed.
    """
    if choice.estimator.needs_response and reference is not None:
        readings = replace(readings, response=reference.response(readings.closing))
    found = choice.estimator.estimate(readings)
    return {
        "present": found.present,
        "words": _words(found),
        "errors": _errors(scene, found),
        "inclusions": [_drawn(one) for one in found.inclusions],
    }


def _drawn(one: EstimatedInclusion) -> dict[str, Any]:
    """What the page draws of an inclusion, in mm: its centre, radius, centre line and, by view, the outlines of its region."""
    regions = {} if one.region is None else shadows(one.region)
    return {
        "center": (1e3 * np.array(one.center)).tolist(),
        "radius": None if one.radius is None else 1e3 * one.radius,
        "line": None if one.line is None else (1e3 * np.array(one.line)).tolist(),
        "region": {view: list(map(_outline, lines)) for view, lines in regions.items()},
    }


def _outline(line: Sequence[Sequence[float]]) -> list[float]:
    """A line (n, 2) in m as x, y, x, y, ... in mm."""
    found: list[float] = (1e3 * np.array(line)).round(DIGITS).ravel().tolist()
    return found


def _words(found: Estimate) -> list[str]:
    reason = found.reason[0].upper() + found.reason[1:]
    return [reason, *(line for one in found.inclusions for line in (_told(one), *_uncertainty(one)))]


def _told(one: EstimatedInclusion) -> str:
    x, y, z = (1e3 * value for value in one.center)
    kind = "" if one.kind == "unknown" else f"{one.kind} "
    size = "" if one.radius is None else f", radius {1e3 * one.radius:.1f} mm"
    return f"{kind}at ({x:.1f}, {y:.1f}, {z:.1f}) mm{size}".capitalize()


def _uncertainty(one: EstimatedInclusion) -> list[str]:
    if one.covariance is None:
        return []
    deviations = np.sqrt(np.diag(one.covariance))
    x, y, z, radius = (f"{1e3 * value:.2g}" for value in deviations[:4])
    contrast = "" if one.contrast is None else f"; contrast {one.contrast:.2g} ± {deviations[4]:.1g}"
    return [f"± ({x}, {y}, {z}) mm, radius ± {radius} mm{contrast} (one standard deviation)"]


def _errors(scene: PageScene, found: Estimate) -> list[str]:
    """Errors of the strongest inclusion against the true one nearest to it in plan, where the truth is known."""
    if scene.inclusions is None:
        return []
    if not scene.inclusions:
        return ["False alarm: there is no inclusion" if found.present else "True: there is no inclusion"]
    if not found.inclusions:
        count = len(scene.inclusions)
        return [f"Missed: there {'is one inclusion' if count == 1 else f'are {count} inclusions'}"]
    points = np.concatenate([shape.places(scene.size) for shape in scene.inclusions])
    _, lateral, depth = away_from_truth(np.array(found.inclusions[0].center), points)
    size = _radius_error(scene, found.inclusions[0])
    return [f"Off by {1e3 * lateral:.1f} mm in plan and {round(1e3 * depth, 1) + 0.0:+.1f} mm in height{size}"]


def _radius_error(scene: PageScene, one: EstimatedInclusion) -> str:
    true = getattr((scene.inclusions or (None,))[0], "radius", None)
    if one.radius is None or true is None or len(scene.inclusions or ()) != 1:
        return ""
    return f", radius off by {1e3 * (one.radius - true):+.1f} mm"
