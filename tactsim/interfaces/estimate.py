"""What an estimator gives: inclusions with their uncertainty."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.units import format_quantity

PARAMETERS = ("x", "y", "z", "radius", "contrast")
"""Order of the rows and columns of a covariance."""
LEVEL = 0.9
"""Probability of a region where none is named."""
NO_ERROR, NO_ERRORS = "No error of this place is stated", "No error of these places is stated"
"""Said of a place, or of all of several, whose estimator does not know how far off they may be."""
USUAL_BLOCK = 10e-3
"""Longest side in m of a block from which on tenths of a millimetre are fine enough for places in it."""


def decimals_of_places(block_size: Array) -> int:
    """Decimals with which places in a block of sides (3,) in m are written in mm."""
    return max(1, 1 - math.floor(math.log10(float(np.max(block_size)) / USUAL_BLOCK)))


class Region(ABC):
    """Regions of highest density of the centre, one for every probability."""

    @abstractmethod
    def contains(self, point: Array, probability: float = LEVEL) -> bool:
        """Whether a point (3,) in m lies in the region of this probability.

        Raises
        ------
        InvalidQuantity
            If the region is not known for this probability; known are those between 0 and 1, of a stored region its own alone.
        """

    @abstractmethod
    def sizes(self, probability: float = LEVEL) -> tuple[float, float]:
        """Width in plan, the diameter of a circle of the same area, and height of the region, both in m.

        Raises
        ------
        InvalidQuantity
            As ``contains``.
        """

    @abstractmethod
    def shadow(self, away: int, probability: float = LEVEL) -> list[Array]:
        """Outline of the region seen along the axis ``away``: closed lines (n, 2) in m along the other two axes.

        Raises
        ------
        InvalidQuantity
            As ``contains``.
        """


@dataclass(frozen=True, eq=False)
class EstimatedInclusion:
    """A lump or an artery as an estimator sees it.

    Attributes
    ----------
    kind : "sphere", "tube", or "unknown" if the estimator does not say
    center : (3,) in m in the undeformed block
    radius : in m; None if not estimated
    contrast : of the stiffness at the working strain, as it acts on the taxels: 0 for tissue, negative if softer; None if unknown
    covariance : (5, 5) of x, y, z, radius and contrast in SI, (4, 4) where there is no contrast; None if not estimated
    region : where its centre lies with a stated probability; None if not estimated
    line : both ends of the centre line of a tube in m; None if it is no tube or they are not estimated

    Raises
    ------
    InvalidQuantity
        If the centre, the radius or the covariance has a wrong shape or is not finite, or the radius is not positive.
    """

    kind: str
    center: tuple[float, float, float]
    radius: float | None = None
    contrast: float | None = None
    covariance: Array | None = None
    region: Region | None = None
    line: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None

    def __post_init__(self) -> None:
        if np.shape(self.center) != (3,):
            raise InvalidQuantity(f"an estimated centre of the shape {np.shape(self.center)}; needed: (x, y, z) in m")
        if not np.isfinite(self.center).all():
            raise InvalidQuantity(f"an estimated centre {self.center} m is not finite")
        if self.radius is not None and not (np.isfinite(self.radius) and self.radius > 0):
            raise InvalidQuantity(f"an estimated radius {self.radius} m; allowed: finite and positive, or none")
        if self.covariance is None:
            return
        covariance = np.asarray(self.covariance, dtype=float)
        every = len(PARAMETERS)
        allowed = {(every, every)} | ({(every - 1, every - 1)} if self.contrast is None else set())
        if covariance.shape not in allowed or not np.isfinite(covariance).all():
            needed = f"(5, 5), finite, of {', '.join(PARAMETERS)}; (4, 4) without a contrast"
            raise InvalidQuantity(f"a covariance of shape {covariance.shape}; needed: {needed}")


@dataclass(frozen=True, eq=False)
class Estimate:
    """What an estimator located; no inclusions means that nothing is there.

    Attributes
    ----------
    present : whether anything is there
    inclusions : the strongest first; empty exactly if nothing is there
    reason : why, in words for a user
    probability : that anything is there, from 0 to 1; None if the estimator does not say
    classes : probability of each class by its name, adding up to 1; None if the estimator does not distinguish classes
    factor : what plain tissue reads over the reference, by its stiffness and the gain of the sensors; None if not estimated

    Raises
    ------
    InvalidQuantity
        If the probabilities of the classes do not add up to 1, ``present`` and the inclusions disagree, or another number is out
        of its range.
    """

    present: bool
    inclusions: tuple[EstimatedInclusion, ...]
    reason: str
    probability: float | None = None
    classes: dict[str, float] | None = None
    factor: float | None = None

    def __post_init__(self) -> None:
        if self.classes is not None and not np.isclose(sum(self.classes.values()), 1.0, rtol=0, atol=1e-6):
            raise InvalidQuantity(f"the probabilities of the classes add up to {sum(self.classes.values()):g}; needed: 1")
        if self.present != bool(self.inclusions):
            raise InvalidQuantity(f"present is {self.present} with {len(self.inclusions)} inclusions; these must agree")
        if self.probability is not None and not 0 <= self.probability <= 1:
            raise InvalidQuantity(f"probability {self.probability}; allowed: 0 to 1")
        if self.factor is not None and not np.isfinite(self.factor):
            raise InvalidQuantity(f"a factor of the reference {self.factor}; needed: finite")


def inclusion_in_words(inclusion: EstimatedInclusion) -> str:
    """An inclusion in words."""
    place = ", ".join(format_quantity(value, "m") for value in inclusion.center)
    size = "" if inclusion.radius is None else f", radius {format_quantity(inclusion.radius, 'm')}"
    return f"{inclusion.kind} at ({place}){size}"
