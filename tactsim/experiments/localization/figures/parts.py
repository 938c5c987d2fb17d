"""What the figures of a localization show: the grasp that was read, with the estimated inclusions in bodies and words."""

from __future__ import annotations

from dataclasses import replace
from textwrap import wrap

import numpy as np

from tactsim.experiments.grasp.figures.viewed import ViewedGrasp, viewed
from tactsim.experiments.localization.scene import LocalizedGrasp
from tactsim.interfaces.estimate import NO_ERROR, NO_ERRORS, decimals_of_places
from tactsim.plotting.canvas import with_minus
from tactsim.results import Result

LINE = 70
"""Characters of a line of what was found."""


def localized(result: Result) -> ViewedGrasp:
    """The grasp that was read, with the estimates."""
    grasp, scene = viewed(result), result.scene_as(LocalizedGrasp)
    return replace(
        grasp,
        valid=grasp.valid if scene.valid is None else np.array(scene.valid),
        estimates=tuple(estimate.inclusion() for estimate in scene.estimates),
        findings=(*_findings(scene, result), *_not_taken_off(scene)) if "present" in result.quantities else grasp.findings,
    )


def _not_taken_off(scene: LocalizedGrasp) -> tuple[str, ...]:
    """What was read, if that is not what is drawn."""
    return ("Read off the forces as they are; drawn is their difference from the reference.",) if scene.reference_unused else ()


def _contrast(result: Result) -> str:
    """Whether the strongest inclusion is stiffer or softer than the tissue, as the estimate has it."""
    value, deviation = (
        float(result.quantities[name].value) if name in result.quantities else np.nan
        for name in ("estimated_contrast", "contrast_deviation")
    )
    spread = f" ± {deviation:.2g}" if np.isfinite(deviation) else ""
    words = f"contrast {with_minus(f'{value:+.2g}')}{spread}, 0 is tissue"
    return f"{'Softer' if value < 0 else 'Stiffer'} than the tissue at this closing: {words}"


def _findings(scene: LocalizedGrasp, result: Result) -> tuple[str, ...]:
    """The result in words."""
    quantities = result.quantities
    if not quantities["present"].value:
        return tuple(wrap(f"Nothing found: {result.reason}", LINE))
    digits = decimals_of_places(scene.size)
    places = [f"({', '.join(f'{1e3 * value:.{digits}f}' for value in estimate.center)}) mm" for estimate in scene.estimates]
    lines = [result.reason[:1].upper() + result.reason[1:]] if "class_probabilities" in quantities or len(places) > 1 else []
    lines = [part for line in lines for part in wrap(line, LINE)]
    lines += [f"Estimated at {place}" for place in places]
    if "center_deviation" in quantities:
        deviations = ", ".join(f"{1e3 * value:.{digits}f}" for value in quantities["center_deviation"].numbers)
        lines.append(f"± ({deviations}) mm, one standard deviation" + (", of the first" if len(places) > 1 else ""))
    else:
        lines.append(NO_ERROR if len(places) == 1 else NO_ERRORS)
    if "estimated_contrast" in quantities:
        lines.append(_contrast(result))
    if "lateral_error" in quantities:
        lateral, depth = (1e3 * float(quantities[f"{name}_error"].value) for name in ("lateral", "depth"))
        first = " (the first)" if len(places) > 1 else ""
        off = f"Off by {lateral:.{digits}f} mm in plan, {round(depth, digits) + 0.0:+.{digits}f} mm in height{first}"
        lines.append(with_minus(off))
    return tuple(lines)
