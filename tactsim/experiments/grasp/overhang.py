"""How much of each taxel faces the undeformed block."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.contact.jaw import Jaw
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout

COVERED = 1 - 1e-9
"""Part of a taxel that is all of it up to round-off."""


def covered_areas(jaw: Jaw, middle: Array, size: Array, layout: TaxelLayout) -> Array:
    """Area (rows, columns) in m^2 of each taxel that lies over the face of a block of ``size`` (2,) from the origin, in m.

    ``middle`` (2,) is the place of the middle of the jaw's face. A tilted jaw is seen along z.
    """
    turn, whole = jaw.rotation[:2, :2], layout.area
    columns, rows = (layout.borders(along)[:, [0, 1, 1, 0] if along == "x" else [0, 0, 1, 1]] for along in "xy")
    corners = np.stack(np.broadcast_arrays(columns[None], rows[:, None]), axis=-1) @ turn.T + middle
    areas = np.full(corners.shape[:2], whole)
    for row, column in np.argwhere(((corners < 0) | (corners > size)).any(axis=(2, 3))):
        areas[row, column] = _area(_clipped(corners[row, column], size)) / abs(np.linalg.det(turn))
    return areas


def overhang_warnings(grasp: GraspSetup) -> list[str]:
    """Warnings about taxels that reach beyond the block, jaw by jaw."""
    size, layout, warnings = np.array(grasp.block.size[:2]), grasp.matrix, []
    for side in JAWS:
        areas = covered_areas(grasp.jaw(side), getattr(grasp, side).middle(size), size, layout)
        beyond = areas < COVERED * layout.area
        if beyond.any():
            row, column = np.unravel_index((areas / layout.area).round(9).argmin(), areas.shape)
            covered, whole, least = 1e6 * areas[beyond].sum(), 1e6 * layout.area * beyond.sum(), 1e6 * areas.min()
            warnings.append(
                f"{beyond.sum()} of {areas.size} taxels of the {side} jaw reach beyond the block: {covered:.4g} mm^2 of their "
                f"{whole:.4g} mm^2 ({100 * covered / whole:.1f} %) face it, least row {row + 1}, column {column + 1} with "
                f"{least:.4g} mm^2 ({100 * areas.min() / layout.area:.1f} %); their pressures are forces over whole taxels"
            )
    return warnings


def _clipped(corners: Array, size: Array) -> Array:
    """The part of a convex polygon (n, 2) that lies between the origin and ``size`` (Sutherland & Hodgman 1974)."""
    for axis in (0, 1):
        corners = _cut(corners, corners[:, axis])
        corners = _cut(corners, size[axis] - corners[:, axis])
    return corners


def _cut(corners: Array, inside: Array) -> Array:
    """The part of a polygon (n, 2) where the distances ``inside`` (n,) of its corners from a line are not negative."""
    kept: list[Array] = []
    for k in range(len(corners)):
        before, now = inside[k - 1], inside[k]
        if (before < 0) != (now < 0):
            kept.append(corners[k - 1] + before / (before - now) * (corners[k] - corners[k - 1]))
        if now >= 0:
            kept.append(corners[k])
    return np.array(kept).reshape(-1, 2)


def _area(corners: Array) -> float:
    """Area of a polygon (n, 2), 0 without corners."""
    x, y = corners.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)
