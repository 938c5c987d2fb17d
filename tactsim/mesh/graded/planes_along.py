"""Planes across tubes: graded from the faces, the ends of tubes and a ball beside them, at most a part of a bend apart."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.lines import REACH, ROOM, box_shares, edge_thickness, mirrored_line, spaced
from tactsim.mesh.graded.lump import Lump
from tactsim.mesh.graded.sections import Hollow

MOST_TURN = 0.3
"""Angle in rad by which a tube may turn along a cell, at most: at 0.45 mid-nodes of a wall of a quarter of the bore no longer
find room on its surface, and the volume is wrong by 0.6 %."""
TILT_ROOM = 1.5
"""Thickness of the cells at a flat end that leans, over the way by which its rim stands ahead of its middle."""


def planes_along(
    tubes: Sequence[Hollow], ball: Lump | None, size: Array, settings: BlockMeshSettings, *, axis: int, across: int, thin: Array
) -> tuple[Array, tuple[int, int]]:
    """Ascending places in m from face to face, and the numbers of the first and the last across the box of the ball.

    Cells grow from the places ``thin`` (k,) in m, from the ends of tubes on the way, and from the ball.

    Raises
    ------
    InputError
        If a tube ends beside the ball, or cells are thin there.
    """
    length, edge = float(size[axis]), edge_thickness(settings)
    longest = min([settings.size, *(MOST_TURN * tube.tightest for tube in tubes)])
    settings = settings.model_copy(update={"size": longest, "edge_size": min(edge, longest)})
    knots = {0.0: longest, length: longest} | {float(place): min(edge, longest) for place in thin}
    for tube in tubes:
        for end, parameter in zip(tube.ends(axis, size), np.sort(tube.line.limits), strict=True):
            if 0 < end < length:
                tangent = tube.line.tangents(np.array([parameter]))[0]
                knots[end] = max(settings.inclusion_size, TILT_ROOM * tube.outer * float(np.sqrt(1 - tangent[axis] ** 2)))
    box: Array = np.zeros(0)
    if ball is not None:
        low, high = ball.bounds[:, axis]
        gaps = np.array([low - thin[thin <= low].max(initial=0.0), thin[thin >= high].min(initial=length) - high])
        begin, end = ball.bounds[:, axis] + np.array([-1, 1]) * np.minimum(ROOM * gaps, (REACH - 1) * ball.half[axis])
        if any(begin < place < end for place in knots):
            raise InputError("graded cells serve a lump beside a tube, not beside the end of one or below the edge of a jaw")
        box = np.interp(box_shares(across, 0.0), [-1, 0, 1], [begin, ball.center[axis], end])
        knots |= {float(box[0]): float(box[1] - box[0]), float(box[-1]): float(box[-1] - box[-2])}
    if len(knots) == 2:
        return mirrored_line(length, settings), (0, 0)
    lines = [np.zeros(1)]
    for low, high in itertools.pairwise(sorted(knots)):
        ends = knots[low], knots[high]
        if len(box) and low == box[0]:
            lines.append(box[1:])
        elif low == 0 and low not in thin and high in thin:
            lines.append((high - spaced(high, settings))[-2::-1])
        elif high == length and high not in thin and low in thin:
            lines.append(low + spaced(length - low, settings)[1:])
        elif np.isclose(low + high, length) and np.isclose(*ends):
            lines.append(low + mirrored_line(high - low, settings.model_copy(update={"edge_size": ends[0]}))[1:])
        else:
            lines.append(low + _between(high - low, ends, settings)[1:])
        lines[-1][-1] = high
    places = np.concatenate(lines)
    return places, (int(np.searchsorted(places, box[0])), int(np.searchsorted(places, box[-1]))) if len(box) else (0, 0)


def _between(length: float, thickness: tuple[float, float], settings: BlockMeshSettings) -> Array:
    """Ascending places from 0 to ``length`` in m: cells of given thickness at both ends, growing towards each other."""
    sides: tuple[list[float], list[float]] = ([], [])
    following = list(thickness)
    while sum(sides[0]) + sum(sides[1]) + min(following) / 2 < length:
        k = int(following[1] < following[0])
        sides[k].append(following[k])
        following[k] = max(following[k], min(settings.size, following[k] * (1 + settings.growth)))
        check_along(len(sides[0]) + len(sides[1]), "mesh.size, mesh.edge_size and mesh.growth")
    steps = np.array([*sides[0], *sides[1][::-1]])
    if not len(steps):
        return np.array([0.0, length])
    return np.concatenate([[0.0], np.cumsum(steps)]) * length / steps.sum()
