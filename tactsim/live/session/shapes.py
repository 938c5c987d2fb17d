"""The true inclusions as the page draws them: triangles in 3D and outlines in the three views."""

from __future__ import annotations

from typing import Any

import numpy as np
from contourpy import contour_generator

from tactsim.array import Array
from tactsim.errors import InputError, TactsimError
from tactsim.experiments.grasp.figures.viewed import outline
from tactsim.interfaces.solid import Solid
from tactsim.live.sources.scene import PageScene
from tactsim.localization.views import AWAY
from tactsim.mesh.any_inclusion import inclusion_name
from tactsim.outside.text import one_line

ACROSS = 14
"""Triangles along the shortest extent of a body."""
FINEST = 300
"""Triangles along the longest side of the block at most, so that a thin body does not take millions."""
LARGEST = 2
"""Extent over the longest side of the block beyond which a body is not drawn."""
LONGEST_REASON = 200
"""Characters of why an inclusion cannot be drawn."""
DIGITS = 4
"""Decimals in mm: a tenth of a micrometre, far below a pixel."""


def drawn_inclusions(scene: PageScene) -> list[dict[str, Any]]:
    """Name, triangles in mm and outlines by view of every true inclusion; one whose surface file is missing has no shape."""
    shapes = []
    for number, inclusion in enumerate(scene.inclusions or (), 1):
        drawn: dict[str, Any] = {"name": inclusion_name(number, inclusion), "points": [], "triangles": [], "outlines": {}}
        try:
            with np.errstate(all="ignore"):  # of sizes beyond all numbers, which are refused
                body = inclusion.solids(scene.size)[0]
                points, triangles = _clipped(body, scene.size)
                outlines = {view: _outline(body, scene.size, away) for view, away in AWAY.items()}
            drawn |= {"points": _rounded(points), "triangles": triangles.ravel().tolist(), "outlines": outlines}
        except (InputError, ValueError) as error:
            drawn["name"] += f" (cannot be drawn: {one_line(error, LONGEST_REASON)})"
        except (TactsimError, OSError):
            drawn["name"] += " (its surface file is not at hand)"
        shapes.append(drawn)
    return shapes


def _clipped(body: Solid, size: Array) -> tuple[Array, Array]:
    """Points in mm and triangles; what leaves the block is drawn onto its faces."""
    if not (np.ptp(body.bounds(), axis=0) <= LARGEST * size.max()).all():
        raise InputError(f"it is more than {LARGEST} times as large as the block")
    edge = max(float(np.ptp(np.clip(body.bounds(), 0.0, size), axis=0).min()) / ACROSS, float(size.max()) / FINEST)
    points, triangles = body.triangles(edge)
    return 1e3 * np.clip(points, 0.0, size), triangles


def _outline(body: Solid, size: Array, away: int) -> list[list[float]]:
    """Lines in mm, each as x, y, x, y, ... along the two axes of a view in their order."""
    first, second, distance = outline(body, size, away)
    return [_rounded(np.asarray(line)) for line in contour_generator(first, second, distance).lines(0.0)]


def _rounded(points: Array) -> list[float]:
    return np.round(np.asarray(points, dtype=float).ravel(), DIGITS).tolist()
