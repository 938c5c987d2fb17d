"""Lines of a grid of cells: graded from the faces of a block, and bent around a box of cells about a lump."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.inclusions.ellipsoid import EllipsoidSolid

Array = np.ndarray
EDGE_SHARE = 1 / 3
"""Thickness of the cells at the faces over that far away, where none is given."""
ROOM = 0.4
"""How far the box of rounded cells reaches from the lump to the face, as a part of that way."""
NEAR = 0.8
"""Gaps below which the box reaches to a face that a jaw presses, over the thickness of cells at the faces: two cells in so thin a
gap are too flat for their width, and the pressure over a hard lump is wrong by 4 to 11 %; one has an error of 1.5 %."""
REACH = 2.0
"""Half width of the box over that of the lump, at most."""
CORE_ROOM = 0.5
"""Half width of the box over that of the lump, at least where the lines lie away from it."""
LEAST_BETWEEN = 3
"""Cells across the box from jaw to jaw, at least; two miss the volume of a ball by 0.6 %."""
LEAST_ALONG, LEAST_ALONG_LARGE = 4, 5
"""Cells across the box along the jaws, at least, and around a lump that is large or where the box reaches to a jaw. With three no
corner lies above the pole of a ball, and the pressure over a hard one 3 mm from a jaw is 8 to 18 % too low; with four it is
wrong by 4 to 6 % at a jaw, and by up to 8 % above a ball of two thirds of the height."""
SMALL, LARGE = 1 / 3, 0.55
"""Height over the block's below which three cells along the jaws suffice for a lump that is not near: it is felt little; and
above which four do not."""
NEAREST = 0.5
"""Part of a cell that must be left before it is added to those from a face to the box."""


@dataclass(frozen=True)
class Line:
    """Ascending coordinates in m from face to face, those from number ``first`` on by the ``across`` cells of the box.

    ``near`` holds beside the box, ``far`` at the faces along the line. There no first cell is thinner than elsewhere: those along
    the edges of a pressed face would turn inside out when the free faces roll onto the jaw.
    """

    near: Array
    far: Array
    first: int
    across: int

    @property
    def away(self) -> Array:
        """Way from the box, as a part of that from the box to the face: 0 in the box, 1 at the faces that it does not touch."""
        begin, end = self.near[[self.first, self.first + self.across]]
        below = (begin - self.near) / (begin or np.inf)
        above = (self.near - end) / ((self.near[-1] - end) or np.inf)
        return np.maximum(0.0, np.maximum(below, above))


def lines_around(solid: EllipsoidSolid, extent: Array, settings: BlockMeshSettings, finer: int) -> list[Line]:
    """For each axis: places graded from a face to the box, even through the box to its middle, and on to the other face; with
    ``finer`` cells across the box more than needed."""
    lines = []
    wanted = round(np.pi / 2 * float(solid.semi_axes.max()) / settings.inclusion_size)
    along = _least_along(solid.bounds()[:, 2], float(extent[2]), settings)
    for axis, ((low, high), center, length) in enumerate(zip(solid.bounds().T, solid.center, extent, strict=True)):
        half = (high - low) / 2
        gaps = np.array([low, length - high])
        left = np.maximum(np.array([center, length - center]) - REACH * half, _left(gaps, settings, pressed=axis == 2))
        least = np.minimum(_edge(settings), np.array([center, length - center]) - CORE_ROOM * half)
        across = max(LEAST_BETWEEN if axis == 2 else along, wanted) + finer
        near = _through(left, center, length, across, settings)
        far = _through(np.where(left > 0, np.maximum(left, least), 0.0), center, length, across, settings)
        lines.append(Line(near, far, len(_spaced(left[0], settings)) - 1, across))
    return lines


def mirrored_line(length: float, settings: BlockMeshSettings) -> Array:
    """Ascending places in m from face to face, those of one half the mirror image of the others."""
    half = _spaced(length / 2, settings)
    return np.concatenate([half, length - half[-2::-1]])


def _through(left: Array, center: float, length: float, across: int, settings: BlockMeshSettings) -> Array:
    """Ascending places in m from face to face: ``left`` (2,) in m before and after a box of ``across`` cells around a centre."""
    before, after = (_spaced(float(way), settings) for way in left)
    within = np.interp(np.linspace(-1, 1, across + 1), [-1, 0, 1], [left[0], center, length - left[1]])
    return np.concatenate([before[:-1], within, (length - after)[-2::-1]])


def _left(gaps: Array, settings: BlockMeshSettings, *, pressed: bool) -> Array:
    """Ways in m that the box leaves to faces ``gaps`` away from the lump; none to a face that a jaw presses and that is near."""
    return np.where(pressed & _near(gaps, settings), 0.0, (1 - ROOM) * gaps)


def _near(gaps: Array, settings: BlockMeshSettings) -> Array:
    """Whether the box reaches over gaps in m to a face that a jaw presses."""
    return gaps < NEAR * _edge(settings)


def _least_along(heights: Array, height: float, settings: BlockMeshSettings) -> int:
    """Least number of cells across the box along the jaws around a lump between two heights in m."""
    low, high = heights
    if high - low > LARGE * height or _near(min(low, height - high), settings):
        return LEAST_ALONG_LARGE
    return LEAST_BETWEEN if high - low < SMALL * height else LEAST_ALONG


def _edge(settings: BlockMeshSettings) -> float:
    """Thickness of cells at the faces in m."""
    return min(settings.edge_size or EDGE_SHARE * settings.size, settings.size)


def _spaced(length: float, settings: BlockMeshSettings) -> Array:
    """Ascending places in m from a face at 0 to ``length``: the first cell ``edge_size`` thick, the others stretched to fit; or
    one cell, if most of a second one would not find room."""
    if length <= 0:
        return np.zeros(1)
    thickness = [_edge(settings)]
    while sum(thickness) + NEAREST * (further := min(thickness[-1] * (1 + settings.growth), settings.size)) <= length:
        thickness.append(further)
    steps = np.array(thickness)
    if len(steps) == 1:
        return np.array([0.0, length])
    steps[1:] *= (length - steps[0]) / steps[1:].sum()
    return np.append(np.concatenate([[0.0], np.cumsum(steps[:-1])]), length)
