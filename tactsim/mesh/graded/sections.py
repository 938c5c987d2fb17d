"""Tubes that lead along a block, seen in planes across it: where each begins and ends, its middle and its section there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.solid import Solid
from tactsim.mesh.inclusions.centre_line import CentreLine
from tactsim.mesh.inclusions.swept import SweptSolid

LEAST_ALONG = 0.7
"""Least cosine of the angle between a tube and the axis along which it leads: its inverse stretches the sections."""
PLACES = 50
"""Planes in which a tube is looked at when an axis is sought for it."""
NEWTON_STEPS = 4


@dataclass(frozen=True)
class Hollow:
    """A tube by its centre line, which is continued beyond the faces that it leaves through, and its radii in m."""

    line: CentreLine
    outer: float
    inner: float

    def moved(self, displacement: Array) -> Hollow:
        """The same, moved by a displacement (3,) in m."""
        return replace(self, line=replace(self.line, points=self.line.points + displacement))

    def ends(self, axis: int, size: Array) -> tuple[float, float]:
        """First and last coordinate in m along an axis of the centre line in a block of size (3,) in m."""
        low, high = np.sort(self.line.derivatives(np.array(self.line.limits))[0][:, axis])
        return max(float(low), 0.0), min(float(high), float(size[axis]))

    def crossing(self, axis: int, places: Array) -> tuple[Array, Array]:
        """Points (n, 3) in m in which planes across an axis cut the centre line, continued straight, and unit tangents (n, 3)."""
        on = self.line.derivatives(self.line.stations)[0][:, axis]
        way = slice(None) if on[-1] > on[0] else slice(None, None, -1)
        parameter = np.interp(places, on[way], self.line.stations[way])
        for _ in range(NEWTON_STEPS):
            points, slopes, _ = self.line.derivatives(parameter)
            parameter = parameter + (places - points[:, axis]) / slopes[:, axis]
        points, tangents = self.line.derivatives(parameter)[0], self.line.tangents(parameter)
        points[:, axis] = places
        return points, tangents

    @property
    def tightest(self) -> float:
        """Least radius in m of its bends, infinite if it is straight."""
        bends = np.linalg.norm(self.line.curvature(self.line.stations), axis=1)
        return float(1 / bends.max()) if bends.max() > 0 else np.inf

    def leads(self, axis: int, size: Array) -> bool:
        """Whether it goes along an axis all the way, its sections between the other faces of a block of size (3,) in m."""
        cosines = self.line.tangents(self.line.stations)[:, axis]
        if np.abs(cosines).min() < LEAST_ALONG or np.ptp(np.sign(cosines)) > 0:
            return False
        points, tangents = self.crossing(axis, np.linspace(*self.ends(axis, size), PLACES))
        across = [(axis + 1) % 3, (axis + 2) % 3]
        reach = self.outer * np.linalg.norm(section_stretches(tangents[:, across]), axis=2)
        return bool((reach < points[:, across]).all() and (points[:, across] + reach < size[across]).all())


def as_hollow(solids: Sequence[Solid]) -> Hollow | None:
    """The tube that an outer and an inner solid are, None if they are none."""
    if len(solids) != 2:
        return None
    outer, inner = solids
    if not isinstance(outer, SweptSolid) or not isinstance(inner, SweptSolid):
        return None
    return Hollow(outer.line, outer.radius, inner.radius)


def leading_axis(tubes: Sequence[Hollow], size: Array) -> int:
    """The axis along which all tubes lead in a block of size (3,) in m.

    Raises
    ------
    InputError
        If there is none.
    """
    for axis in range(3):
        if all(tube.leads(axis, size) for tube in tubes):
            return axis
    raise InputError(
        "graded cells serve tubes that lead along x, y or z, at less than 45 degrees, and leave through no face beside them"
    )


def section_stretches(inside: Array) -> Array:
    r"""Symmetric stretches (..., 2, 2) of the unit circle to the section of a tube of unit radius.

    .. math:: E = (1 - t t^T)^{-1/2} = 1 + \frac{1}{c\,(1 + c)} t t^T, \quad c = \sqrt{1 - |t|^2}

    with the part t (..., 2) of the unit tangent in the plane of the section.

    Source: derived here: the section is where the part of a point across the tangent has unit length.
    """
    cosine = np.sqrt(1 - (inside**2).sum(axis=-1))[..., None, None]
    return np.asarray(np.eye(2) + inside[..., :, None] * inside[..., None, :] / (cosine * (1 + cosine)))


@dataclass(frozen=True)
class Sections:
    """k tubes in n planes across an axis.

    Attributes
    ----------
    axes : that along which the tubes lead, and the two in the planes
    places : (n,) of the planes along the first axis in m
    ends : (k, 2) first and last plane of each tube
    centers, tangents : (n, k, 3) in m and unit vectors, by the order of ``axes``
    radii : (k, 2) outer and inner in m
    """

    axes: tuple[int, int, int]
    places: Array
    ends: Array
    centers: Array
    tangents: Array
    radii: Array

    @property
    def stretches(self) -> Array:
        """Stretches (n, k, 2, 2) of the unit circle to sections of unit radius."""
        return section_stretches(self.tangents[..., 1:])

    @property
    def bounds(self) -> Array:
        """Lowest and highest coordinates (n, k, 2, 2) in m of the outer surfaces along the second and the third axis."""
        reach = np.linalg.norm(self.stretches, axis=3) * self.radii[:, :1]
        return np.stack([self.centers[..., 1:] - reach, self.centers[..., 1:] + reach], axis=-1)

    def turned(self) -> Sections:
        """The same with the second and the third axis exchanged."""
        (a, b, c), order = self.axes, [0, 2, 1]
        return replace(self, axes=(a, c, b), centers=self.centers[..., order], tangents=self.tangents[..., order])

    def taken(self, order: Array) -> Sections:
        """Some of the tubes, by their numbers (m,), in another order."""
        return replace(
            self,
            ends=self.ends[order],
            centers=self.centers[:, order],
            tangents=self.tangents[:, order],
            radii=self.radii[order],
        )


def sections_of(tubes: Sequence[Hollow], axis: int, places: Array, size: Array) -> Sections:
    """Tubes in planes across an axis at places (n,) in m, those of their ends among them; in a block of size (3,) in m."""
    axes = (axis, (axis + 1) % 3, (axis + 2) % 3)
    ends = np.array([[np.abs(places - end).argmin() for end in tube.ends(axis, size)] for tube in tubes])
    crossings = [tube.crossing(axis, places) for tube in tubes]
    centers, tangents = (np.stack([pair[k] for pair in crossings], axis=1)[..., axes] for k in range(2))
    return Sections(axes, places, ends, centers, tangents, np.array([[tube.outer, tube.inner] for tube in tubes]))
