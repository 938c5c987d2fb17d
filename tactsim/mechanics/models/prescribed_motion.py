"""Motions of nodes that are prescribed: straight, or about an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError

SAME = 1e-12
"""Difference of two prescribed displacements, over the size of the body, that is round-off."""


class PrescribedMotion(Protocol):
    """Displacements of some unknowns that follow from one factor."""

    @property
    def name(self) -> str:
        """How messages call it."""

    @property
    def unknowns(self) -> Array:
        """Numbers (k,) of the unknowns."""

    def values(self, factor: float) -> Array:
        """Displacements (k,) in m at a factor."""


@dataclass(frozen=True)
class Translation:
    """The ``unknowns`` (k,) all move by ``distance`` in m times the factor."""

    name: str
    unknowns: Array
    distance: float

    def values(self, factor: float) -> Array:
        """Displacements (k,) in m."""
        return np.full(len(self.unknowns), factor * self.distance)


@dataclass(frozen=True)
class Rotation:
    """Nodes at ``arms`` (n, 2) in m from an axis along z turn about it by ``angle`` in rad times the factor.

    ``along_x`` (n,) are the numbers of their unknowns along x; those along y follow each.
    """

    name: str
    along_x: Array
    arms: Array
    angle: float

    @property
    def unknowns(self) -> Array:
        """Those of x, then those of y."""
        return np.concatenate([self.along_x, self.along_x + 1])

    def values(self, factor: float) -> Array:
        """Displacements (2 n,) in m, x before y: exact for any angle."""
        x, y = self.arms.T
        cosine, sine = np.cos(factor * self.angle), np.sin(factor * self.angle)
        return np.concatenate([(cosine - 1) * x - sine * y, sine * x + (cosine - 1) * y])


class PrescribedMotions:
    """Several motions of one body, each with its factor; ``unknowns`` (m,) are all that they prescribe.

    Parameters
    ----------
    motions : in the order of their factors
    size : of the body in m

    Raises
    ------
    InputError
        If two motions prescribe different displacements of one unknown.
    """

    def __init__(self, motions: Sequence[PrescribedMotion], size: float):
        self._motions, self._size = tuple(motions), size
        every = [motion.unknowns for motion in motions]
        self.unknowns = np.unique(np.concatenate(every)).astype(np.int64) if every else np.zeros(0, np.int64)
        self._places = [np.searchsorted(self.unknowns, unknowns) for unknowns in every]
        self.values((1.0,) * len(self._motions))

    def values(self, factors: Sequence[float]) -> Array:
        """Displacements (m,) in m of the unknowns.

        Raises
        ------
        InputError
            If two motions disagree.
        """
        values, owner = np.zeros(len(self.unknowns)), np.full(len(self.unknowns), -1)
        for number, (motion, places, factor) in enumerate(zip(self._motions, self._places, factors, strict=True)):
            new = motion.values(factor)
            apart = (owner[places] >= 0) & (np.abs(new - values[places]) > SAME * self._size)
            if apart.any():
                other = self._motions[int(owner[places][apart][0])].name
                raise InputError(f"{motion.name} and {other} prescribe different displacements of one node; free one of them")
            values[places], owner[places] = new, number
        return values
