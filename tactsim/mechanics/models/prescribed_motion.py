"""Motions of nodes that are prescribed: straight, about an axis, or along the normal of a plane that turns about one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.fem.equilibrium.constraints import Slides

SAME = 1e-12
"""Difference of two prescribed displacements, over the size of the body, that is round-off."""
NO_SLIDES = Slides(np.zeros(0, np.int64), np.zeros((2, 0)), np.zeros(0))
"""Of a motion that holds its nodes along whole axes."""


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

    def slides(self, factor: float) -> Slides:
        """Nodes that it holds along one direction only at a factor; their numbers are those at any other."""


@dataclass(frozen=True)
class Translation:
    """The ``unknowns`` (k,) move by ``distance`` in m, of all or (k,) of each, times the factor."""

    name: str
    unknowns: Array
    distance: float | Array

    def values(self, factor: float) -> Array:
        """Displacements (k,) in m."""
        return np.broadcast_to(factor * self.distance, len(self.unknowns))

    def slides(self, factor: float) -> Slides:
        """None, at any factor."""
        return NO_SLIDES


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
        """Those of x, then those of y (2 n,)."""
        return np.concatenate([self.along_x, self.along_x + 1])

    def values(self, factor: float) -> Array:
        """Displacements (2 n,) in m, x before y: exact for any angle."""
        x, y = self.arms.T
        cosine, sine = np.cos(factor * self.angle), np.sin(factor * self.angle)
        return np.concatenate([(cosine - 1) * x - sine * y, sine * x + (cosine - 1) * y])

    def slides(self, factor: float) -> Slides:
        """None, at any factor."""
        return NO_SLIDES


@dataclass(frozen=True)
class Sliding:
    """Nodes at ``arms`` (n, 2) in m from an axis along z stay on planes that turn about it by ``angle`` in rad times the factor.

    ``along_x`` (n,) are the numbers of their unknowns along x, those along y follow each; ``normals`` (n, 2) are the unit
    normals of the planes before they turn, along which alone the nodes are held.
    """

    name: str
    along_x: Array
    arms: Array
    normals: Array
    angle: float

    @property
    def unknowns(self) -> Array:
        """None (0,), as the displacement of no unknown follows from the factor alone."""
        return np.zeros(0, np.int64)

    def values(self, factor: float) -> Array:
        """Displacements of none (0,)."""
        return np.zeros(0)

    def slides(self, factor: float) -> Slides:
        """What holds the nodes at a factor: each stays as far from the axis along its normal as it was."""
        cosine, sine = np.cos(factor * self.angle), np.sin(factor * self.angle)
        normals = np.array([[cosine, -sine], [sine, cosine]]) @ self.normals.T
        return Slides(self.along_x, normals, ((self.normals - normals.T) * self.arms).sum(axis=1))


@dataclass(frozen=True)
class Prescribed:
    """What is prescribed at some factors: displacements ``values`` (m,) in m of the ``unknowns``, and the nodes that slide."""

    unknowns: Array
    values: Array
    slides: Slides | None

    def missing(self, unknowns: Array) -> Array:
        """Displacements (size,) in m that are missing of what is prescribed, zero where nothing is."""
        missing = np.zeros(len(unknowns))
        missing[self.unknowns] = self.values - unknowns[self.unknowns]
        if self.slides is not None:
            self.slides.add(missing, self.slides.distances - self.slides.along(unknowns))
        return missing

    def differs(self, other: Prescribed) -> bool:
        """Whether the same motions prescribe something else at the factors of the ``other``."""
        both = self.slides, other.slides
        turned = both[0] is not None and both[1] is not None and not np.array_equal(both[0].normals, both[1].normals)
        return turned or not np.array_equal(self.values, other.values)

    @property
    def largest(self) -> float:
        """Largest prescribed displacement in m."""
        distances = 0.0 if self.slides is None else np.abs(self.slides.distances).max()
        return float(max(np.abs(self.values).max(initial=0.0), distances))


class Disagreement(InputError):
    """Two motions, by their ``names``, prescribe different displacements of one node."""

    def __init__(self, *names: str):
        super().__init__(f"{' and '.join(names)} prescribe different displacements of one node; free one of them")
        self.names = names


class PrescribedMotions:
    """Several motions of one body, each with its factor; ``unknowns`` (m,) are all whose displacements they prescribe.

    Parameters
    ----------
    motions : in the order of their factors
    size : of the body in m

    Raises
    ------
    InputError
        If two motions prescribe different displacements of one unknown, or one slides that another holds.
    """

    def __init__(self, motions: Sequence[PrescribedMotion], size: float):
        self._motions, self._size = tuple(motions), size
        every = [motion.unknowns for motion in motions]
        self.unknowns = np.unique(np.concatenate(every)).astype(np.int64) if every else np.zeros(0, np.int64)
        self._places = [np.searchsorted(self.unknowns, unknowns) for unknowns in every]
        self.values((1.0,) * len(self._motions))
        self._check_slides()

    @property
    def move(self) -> bool:
        """Whether anything moves at the factor one.

        Raises
        ------
        InputError
            If two motions prescribe different displacements of one node.
        """
        return self.at((1.0,) * len(self._motions)).differs(self.at((0.0,) * len(self._motions)))

    def at(self, factors: Sequence[float]) -> Prescribed:
        """All that is prescribed at these factors.

        Raises
        ------
        InputError
            As `values` does.
        """
        every = [NO_SLIDES, *(motion.slides(factor) for motion, factor in zip(self._motions, factors, strict=True))]
        first, distances = (np.concatenate([getattr(one, name) for one in every]) for name in ("first", "distances"))
        slides = Slides(first, np.concatenate([one.normals for one in every], axis=1), distances)
        return Prescribed(self.unknowns, self.values(factors), slides if len(first) else None)

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
                raise Disagreement(motion.name, other)
            values[places], owner[places] = new, number
        return values

    def _check_slides(self) -> None:
        """Check that nothing else holds what slides."""
        held = dict.fromkeys(self.unknowns.tolist(), "another condition, or the symmetry of the body,")
        for motion in self._motions:
            sliding = motion.slides(0.0).unknowns.tolist()
            for unknown in sliding:
                if unknown in held:
                    raise InputError(f"{motion.name} and {held[unknown]} hold one node; let one of them end beside the other")
            held |= dict.fromkeys(sliding, motion.name)
