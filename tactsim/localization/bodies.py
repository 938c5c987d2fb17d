"""Where balls and straight level tubes lie in a block, and which of them overlap."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tactsim.array import Array, evenly_spaced

FIRSTS = 64
"""Bodies, each held against all others, from which the share of pairs that do not overlap is taken."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """Where bodies of one kind lie, apart from any readings: what follows from it holds for every change of the forces.

    Attributes
    ----------
    kind : "sphere" or "tube"
    begins, ends : (n, 3) in m, both ends of the centre line of a tube; a ball has its centre as both
    radii : (n,) in m
    """

    kind: str
    begins: Array
    ends: Array
    radii: Array

    @property
    def centers(self) -> Array:
        """Centres (n, 3) in m."""
        return (self.begins + self.ends) / 2

    def __len__(self) -> int:
        return len(self.radii)

    @cached_property
    def apart(self) -> float:
        """Share of the pairs that do not overlap, from evenly spaced first ones: within 1 % for the tubes of a block."""
        firsts = evenly_spaced(len(self), FIRSTS)
        return 1 - sum(np.count_nonzero(self.overlaps(int(first))) for first in firsts) / (len(firsts) * len(self))

    def overlaps(self, one: int | Array) -> Array:
        """Which bodies (n,) overlap the given one and so exclude it; (m, n) for several.

        Balls overlap closer than the sum of their radii, straight level tubes where their centre lines come that close.
        """
        of = one if np.ndim(one) == 0 else np.asarray(one)[:, None]
        reach = self.radii + self.radii[of]
        if self.kind == "sphere":
            away = self.begins - self.begins[of]
            return np.einsum("...k,...k->...", away, away) < reach**2
        above = np.abs(self.begins[:, 2] - self.begins[of, 2])
        firsts, lasts = (np.ascontiguousarray(points[:, :2].T) for points in (self.begins, self.ends))
        return (_plan_distance(firsts, lasts, of) < reach) & (above < reach)


def _plan_distance(firsts: Array, lasts: Array, one: int | Array) -> Array:
    """Distance (n,) in m in plan of every segment (2, n) from one of them, (m, n) from several (m, 1): 0 where they cross."""
    begin, end = firsts[:, one], lasts[:, one]
    ends = [_from_segment(point, firsts, lasts) for point in (begin, end)]
    ends += [_from_segment(points, begin, end) for points in (firsts, lasts)]
    sides = [_side(begin, end, firsts) * _side(begin, end, lasts), _side(firsts, lasts, begin) * _side(firsts, lasts, end)]
    return np.where((sides[0] < 0) & (sides[1] < 0), 0.0, np.sqrt(np.min(ends, axis=0)))


def _from_segment(points: Array, firsts: Array, lasts: Array) -> Array:
    """Squared distance in m^2."""
    (along_x, along_y), (x, y) = _between(firsts, lasts), _between(firsts, points)
    share = np.clip((x * along_x + y * along_y) / (along_x * along_x + along_y * along_y), 0.0, 1.0)
    x, y = x - share * along_x, y - share * along_y
    return x * x + y * y


def _side(firsts: Array, lasts: Array, points: Array) -> Array:
    (along_x, along_y), (x, y) = _between(firsts, lasts), _between(firsts, points)
    return along_x * y - along_y * x


def _between(firsts: Array, lasts: Array) -> tuple[Array, Array]:
    """Both components of the way from the first points to the last."""
    return lasts[0] - firsts[0], lasts[1] - firsts[1]
