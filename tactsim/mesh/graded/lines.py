"""Lines of a grid of cells: graded from the faces of a block, and bent around a box of cells about a lump."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import BallImage
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings

EDGE_SHARE = 1 / 3
"""Thickness of the cells at the faces over that of the cells far from them, if none is given."""
ROOM = 0.4
"""Distance of the box of rounded cells from the lump over that of the face from the lump."""
NEAR = 0.8
"""Gaps below which the box reaches to a face that a jaw presses, over the thickness of cells at the faces: two cells in so thin a
gap are too flat for their width."""
REACH = 2.0
"""Half width of the box over that of the lump, at most."""
CORE_ROOM = 0.5
"""Half width of the box over that of the lump, at least where the lines lie away from it."""
LEAST_BETWEEN = 3
"""Least number of cells across the box from jaw to jaw; with two, the volume of a ball is wrong by 0.6 %."""
LEAST_ALONG, LEAST_ALONG_CLOSE, PAIRED = 4, 6, 2
"""Cells across the box along the jaws, at least, and around a lump that is close to a jaw. Their number is even, so that a corner
lies above the pole of the lump: with five the pressure over a hard ball of two thirds of the height, 2 mm from a jaw, is 12 % too
low, with seven 5 %, with four 6 %, with six 2 %."""
CLOSE = 0.5
"""Gap to a jaw over the half width of the lump below which it is close: the peak of pressure between a hard ball and a jaw is
about as wide as the root of twice the product of radius and gap, here as the half width. With four cells instead of six, taxels
over balls of 6 mm are 3.9 % off at 0.47 (12 times the modulus), 2.6 % at 0.52 and 2.3 % at 0.6 and 0.7 (45 times)."""
SMALL, FAR = 1 / 3, 0.9
"""Height over the block's below which, and gap over the half width above which three cells suffice: the lump is felt little."""
GATHER = 0.2
"""How much the lines around a close lump crowd at its centre, where the pressure is largest; 0 is even spacing."""
STEEP = 1.0
"""Rise of a plane of cells across a row, over the distance along it, up to which planes are level through the boxes."""
NEAREST = 0.5
"""Least fraction of a cell that must remain for another cell between a face and the box."""


@dataclass(frozen=True)
class Line:
    """Ascending coordinates in m from face to face, those from number ``first`` on by the ``across`` cells of the box.

    ``near`` (n,) holds beside the box, ``far`` (n,) at the faces along the line. There no first cell is thinner than elsewhere:
    those along the edges of a pressed face would turn inside out when the free faces roll onto the jaw.
    """

    near: Array
    far: Array
    first: int
    across: int

    @property
    def away(self) -> Array:
        """Distance (n,) from the box over that of the face from it: 0 in the box, 1 at the faces that it does not touch."""
        begin, end = self.near[[self.first, self.first + self.across]]
        below = (begin - self.near) / (begin or np.inf)
        above = (self.near - end) / ((self.near[-1] - end) or np.inf)
        return np.maximum(0.0, np.maximum(below, above))


def lines_around(ball: BallImage, bounds: Array, extent: Array, settings: BlockMeshSettings, finer: int) -> list[Line]:
    """For each axis: places graded from a face to the box, through the box to its middle, and on to the other face.

    ``bounds`` (2, 3) in m are those of the lump; ``finer`` counts how often cells across the box were added.

    Raises
    ------
    InputError
        If the cells are too many.
    """
    lines = []
    check_along(np.pi / 2 * ball.longest / settings.inclusion_size, f"mesh.inclusion_size {settings.inclusion_size:.3g} m")
    wanted = round(np.pi / 2 * ball.longest / settings.inclusion_size)
    along = cells_along(bounds, float(extent[2]), wanted, finer)
    for axis, ((low, high), center, length) in enumerate(zip(bounds.T, ball.center, extent, strict=True)):
        half = (high - low) / 2
        gaps = np.array([low, length - high])
        left = np.maximum(np.array([center, length - center]) - REACH * half, room_left(gaps, settings, pressed=axis == 2))
        least = np.minimum(edge_thickness(settings), np.array([center, length - center]) - CORE_ROOM * half)
        across = max(LEAST_BETWEEN, wanted) + finer if axis == 2 else along
        shares = box_shares(across, GATHER if along >= LEAST_ALONG_CLOSE and axis < 2 else 0.0)
        near = _through(left, center, length, shares, settings)
        far = _through(np.where(left > 0, np.maximum(left, least), 0.0), center, length, shares, settings)
        lines.append(Line(near, far, len(spaced(left[0], settings)) - 1, across))
    return lines


def mirrored_line(length: float, settings: BlockMeshSettings) -> Array:
    """Ascending places (n,) in m from face to face, those of one half the mirror image of the others.

    Raises
    ------
    InputError
        If the cells are too many.
    """
    half = spaced(length / 2, settings)
    return np.concatenate([half, length - half[-2::-1]])


def box_shares(across: int, gather: float) -> Array:
    """Ascending relative positions (across + 1,), -1 to 1 from side to side of the box, at which its ``across`` cells end."""
    even = np.linspace(-1, 1, across + 1)
    return (1 - gather) * even + gather * even**3


def _through(left: Array, center: float, length: float, shares: Array, settings: BlockMeshSettings) -> Array:
    """Ascending places in m from face to face: ``left`` (2,) in m before and after a box of cells around a centre."""
    before, after = (spaced(float(span), settings) for span in left)
    within = np.interp(shares, [-1, 0, 1], [left[0], center, length - left[1]])
    return _end_to_end(before, within, length - after)


def _end_to_end(before: Array, within: Array, after: Array) -> Array:
    """Ascending places in m before, within and, given from the last one back, after a box, each of its sides once."""
    return np.concatenate([before[:-1], within, after[-2::-1]])


def room_left(gaps: Array, settings: BlockMeshSettings, *, pressed: bool) -> Array:
    """Distances in m of the box from faces ``gaps`` in m away from the lump, of their shape; zero from a pressed face nearby."""
    near = gaps < NEAR * edge_thickness(settings)
    return np.where(pressed & near, 0.0, (1 - ROOM) * gaps)


def cells_along(bounds: Array, height: float, wanted: int, finer: int) -> int:
    """Number of cells across the box along the jaws around a lump between two corners (2, 3) in m, ``wanted`` at least."""
    gap, half = min(bounds[0, 2], height - bounds[1, 2]), np.diff(bounds[:, :2], axis=0).max() / 2
    if wanted <= LEAST_BETWEEN and gap > FAR * half and bounds[1, 2] - bounds[0, 2] < SMALL * height:
        return LEAST_BETWEEN + finer
    least = LEAST_ALONG_CLOSE if gap < CLOSE * half else LEAST_ALONG
    return PAIRED * (-(-max(least, wanted) // PAIRED) + finer)


def edge_thickness(settings: BlockMeshSettings) -> float:
    """Thickness of cells at the faces in m."""
    return min(settings.edge_size or EDGE_SHARE * settings.size, settings.size)


def spaced(length: float, settings: BlockMeshSettings) -> Array:
    """Ascending places (n,) in m from a face at 0 to ``length``: the first cell ``edge_size`` thick, the others stretched to fit;
    or one cell, if most of a second one would not find room.

    Raises
    ------
    InputError
        If the cells are too many.
    """
    if length <= 0:
        return np.zeros(1)
    thickness = [edge_thickness(settings)]
    while sum(thickness) + NEAREST * (further := min(thickness[-1] * (1 + settings.growth), settings.size)) <= length:
        thickness.append(further)
        check_along(len(thickness), f"mesh.size, mesh.edge_size and mesh.growth ({edge_thickness(settings):.3g} m at the faces)")
    steps = np.array(thickness)
    if len(steps) == 1:
        return np.array([0.0, length])
    return _stretched(steps, length)


def _stretched(steps: Array, length: float) -> Array:
    """Ascending places in m from 0 to ``length`` at the ends of steps of which all but the first are stretched to fit."""
    steps[1:] *= (length - steps[0]) / steps[1:].sum()
    return np.append(np.concatenate([[0.0], np.cumsum(steps[:-1])]), length)


def planes_across(
    centers: Array, bounds: Array, length: float, across: int, settings: BlockMeshSettings, *, pressed: bool
) -> tuple[tuple[list[Array], list[Array]], int]:
    """Ascending places in m from face to face through each of several boxes, and the first plane of the boxes.

    The boxes are those around lumps with middles (n,) and bounds (n, 2) in m; all have as many planes. The first list holds
    beside the boxes, the second one at the faces along the planes; ``pressed`` says whether the planes lie between jaws.
    """
    edge = edge_thickness(settings)
    gaps = np.stack([bounds[:, 0], length - bounds[:, 1]], axis=1)
    touching = (gaps < NEAR * edge).all(axis=0) & pressed
    half = np.diff(bounds, axis=1) / 2
    left = np.where(touching, 0.0, gaps - np.minimum(ROOM * gaps, (REACH - 1) * half))
    far, counts = beside_boxes(left, np.stack([centers, length - centers], axis=1), half, settings)
    shares = box_shares(across, 0.0)
    near, outer = (
        [
            _across(span, float(center), length, shares, counts=counts, settings=settings)
            for span, center in zip(spans, centers, strict=True)
        ]
        for spans in (left, far)
    )
    return (near, outer), counts[0]


def beside_boxes(left: Array, room: Array, half: Array, settings: BlockMeshSettings) -> tuple[Array, list[int]]:
    """Widths (n, 2) in m before and after boxes, at the faces along their planes, and the numbers of cells in them.

    Beside the boxes the widths are ``left`` (n, 2). From the middles of the bodies it is ``room`` (n, 2) to the faces before and
    after, and ``half`` (n, 1) or (n, 2) to their bounds.

    Raises
    ------
    InputError
        If the cells are too many.
    """
    least = np.minimum(edge_thickness(settings), room - CORE_ROOM * half)
    far = np.where(left > 0, np.maximum(left, least), 0.0)
    return far, [round(np.mean([len(spaced(float(span), settings)) - 1 for span in side])) for side in left.T]


def _across(
    span: Array, center: float, length: float, shares: Array, *, counts: Sequence[int], settings: BlockMeshSettings
) -> Array:
    """Ascending places in m from face to face through one box, with given numbers of cells before and after it."""
    before, after = (outer_places(float(s), count, settings) for s, count in zip(span, counts, strict=True))
    within = np.interp(shares, [-1, 0, 1], [span[0], center, length - span[1]])
    return _end_to_end(before, within, length - after)


def outer_places(span: float, count: int, settings: BlockMeshSettings) -> Array:
    """Ascending places (count + 1,) in m from a face at 0 to ``span``, graded from the face, in a given number of cells."""
    thickness = edge_thickness(settings)
    steps = np.minimum(thickness * (1 + settings.growth) ** np.arange(count), settings.size)
    if count < 2 or thickness * count >= span:
        return np.linspace(0.0, span, count + 1)
    return _stretched(steps, span)


def knots_between(along: Array, other: Array, sides: Array, *, length: float) -> tuple[list[float], list[int]]:
    """Places in m along a row between which planes across it lead straight, and the box whose planes hold at each.

    The boxes have their middles at ``along`` (k,), ascending, and at ``other`` (k,) across the row, and their sides at ``sides``
    (k, 2), all in m. Planes are level through the boxes where the rest of the way suffices for a slope of `STEEP`.
    """
    knots, owner = [0.0], [0]
    for k in range(len(along) - 1):
        here, there = (float(place) for place in along[k : k + 2])
        reach = np.array([sides[k, 1] - here, there - sides[k + 1, 0]])
        rise = abs(float(other[k + 1] - other[k]))
        level = np.clip((there - here - rise / STEEP) / reach.sum(), 0.0, 1.0)
        knots += [here + level * float(reach[0]), there - level * float(reach[1])]
        owner += [k, k + 1]
    return [*knots, length], [*owner, len(along) - 1]
