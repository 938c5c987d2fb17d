"""What every estimator takes and gives: readings of both jaws in, inclusions with their uncertainty out."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.interfaces import CaseKind
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.localization.lump_response import LumpResponse
from tactsim.localization.readings import JAWS, checked_readings
from tactsim.localization.region import Region
from tactsim.units import format_quantity

Array = np.ndarray

RESOLUTION = 0.1
"""Resolution of a sensor in N: thesis, section 6.2."""
ROUNDING_NOISE = RESOLUTION / 12**0.5
"""Standard deviation in N of what rounding to the resolution does to a force."""
PARAMETERS = ("x", "y", "z", "radius", "contrast")
"""Order of the rows and columns of a covariance."""


@dataclass(frozen=True, eq=False)
class Readings:
    """Forces on the taxels of both jaws, and what is known of the grasp.

    Attributes
    ----------
    forces : (jaw, row, column) in N pressing into the taxels, the upper jaw first, row 1 nearest the front, column 1 smallest x
    layout : of the taxels on each jaw
    block_size : (3,) of the undeformed tissue in m, which begins at the origin
    reference : (jaw, row, column) in N, what the same tissue without a lump reads at the same closing; None if not known
    noise : standard deviation of a reading in N
    valid : (jaw, row, column), False for a dead or saturated taxel; None if all can be trusted
    middle : (2,) x and y in m of the middle of both matrices; None for that of the block
    closing : of each jaw from first touch, in m; None if not known
    response : fast forward model of lumps in this tissue at this closing; None if not known

    Raises
    ------
    InvalidQuantity
        On construction: a wrong shape, a taxel that is not finite (named), a block or noise out of its range.
    """

    forces: Array
    layout: TaxelLayout
    block_size: Array
    reference: Array | None = None
    noise: float = ROUNDING_NOISE
    valid: Array | None = None
    middle: Array | None = None
    closing: float | None = None
    response: LumpResponse | None = field(default=None, repr=False)
    filled: Array = field(init=False, repr=False)
    """The forces with those of invalid taxels interpolated from their neighbours."""
    difference: Array | None = field(init=False, repr=False)
    """Forces less reference in N, those of invalid taxels interpolated; None without a reference."""

    def __post_init__(self) -> None:
        forces = np.asarray(self.forces, dtype=float)
        allowed = (len(JAWS), self.layout.rows, self.layout.columns)
        for what, values in (("forces", forces), ("reference", self.reference)):
            if values is not None and np.shape(values) != allowed:
                raise InvalidQuantity(f"{what} of shape {np.shape(values)}; the layout needs (jaw, row, column) = {allowed}")
        size = np.asarray(self.block_size, dtype=float)
        if size.shape != (3,) or not np.isfinite(size).all() or not (size > 0).all():
            raise InvalidQuantity(f"the block has the size {size.tolist()} m; allowed: three positive lengths")
        if not (np.isfinite(self.noise) and self.noise >= 0):
            raise InvalidQuantity(f"noise {self.noise} N; allowed: finite and not negative")
        middle = size[:2] / 2 if self.middle is None else np.asarray(self.middle, dtype=float)
        if middle.shape != (2,) or not np.isfinite(middle).all():
            raise InvalidQuantity(f"middle of the matrices {middle.tolist()} m; allowed: two finite lengths, x and y")
        difference = None
        if self.reference is not None:
            difference = checked_readings(forces - checked_readings(self.reference, self.valid), self.valid)
        parts = {"forces": forces, "block_size": size, "middle": middle, "difference": difference}
        for name, value in (parts | {"filled": checked_readings(forces, self.valid)}).items():
            object.__setattr__(self, name, value)

    def taxel_places(self) -> tuple[Array, Array]:
        """Centres of the columns along x and of the rows along y in m, from the corner of the undeformed block."""
        middle = np.asarray(self.middle)
        return self.layout.borders("x").mean(axis=1) + middle[0], self.layout.borders("y").mean(axis=1) + middle[1]


@dataclass(frozen=True, eq=False)
class EstimatedInclusion:
    """A lump or an artery as an estimator sees it.

    Attributes
    ----------
    kind : "sphere", "tube", or "unknown" if the estimator does not tell
    center : (3,) in m in the undeformed block
    radius : in m; None if not estimated
    contrast : of the stiffness as it acts on the taxels, 0 for plain tissue, negative if softer; None if not estimated
    covariance : (5, 5) of x, y, z, radius and contrast in SI; None if not estimated
    region : where its centre lies with a stated probability; None if not estimated
    line : both ends of the centre line of a tube in m; None if it is no tube or they are not estimated
    """

    kind: str
    center: tuple[float, float, float]
    radius: float | None = None
    contrast: float | None = None
    covariance: Array | None = None
    region: Region | None = None
    line: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None

    def __post_init__(self) -> None:
        if not np.isfinite(self.center).all():
            raise InvalidQuantity(f"an estimated center {self.center} m is not finite")
        if self.radius is not None and not (np.isfinite(self.radius) and self.radius > 0):
            raise InvalidQuantity(f"an estimated radius {self.radius} m; allowed: finite and positive, or none")
        if self.covariance is None:
            return
        found = np.asarray(self.covariance, dtype=float)
        if found.shape != (len(PARAMETERS),) * 2 or not np.isfinite(found).all():
            raise InvalidQuantity(f"a covariance of shape {found.shape}; needed: (5, 5), finite, of {', '.join(PARAMETERS)}")


@dataclass(frozen=True, eq=False)
class Estimate:
    """What an estimator found; no inclusions means that nothing is there.

    Attributes
    ----------
    present : whether anything is there
    inclusions : the strongest first; empty exactly if nothing is there
    reason : why, in words for a user
    probability : that anything is there, from 0 to 1; None if the estimator does not tell
    classes : probability of each class by its name, adding up to 1; None if the estimator does not tell classes apart
    """

    present: bool
    inclusions: tuple[EstimatedInclusion, ...]
    reason: str
    probability: float | None = None
    classes: dict[str, float] | None = None

    def __post_init__(self) -> None:
        if self.classes is not None and not np.isclose(sum(self.classes.values()), 1.0, rtol=0, atol=1e-6):
            raise InvalidQuantity(f"the probabilities of the classes add up to {sum(self.classes.values()):g}; needed: 1")
        if self.present != bool(self.inclusions):
            raise InvalidQuantity(f"present is {self.present} with {len(self.inclusions)} inclusions; these must agree")
        if self.probability is not None and not 0 <= self.probability <= 1:
            raise InvalidQuantity(f"probability {self.probability}; allowed: 0 to 1")


class Estimator(CaseKind):
    """Finds inclusions from readings: subclass it in a new file of ``estimators`` and it is registered by its ``kind``."""

    package: ClassVar[str] = "tactsim.localization.estimators"

    needs_response: ClassVar[bool] = False
    """Whether it needs the fast forward model of the tissue."""

    @abstractmethod
    def estimate(self, readings: Readings) -> Estimate:
        """What is there, and where.

        Raises
        ------
        InputError
            If the readings lack what this estimator needs, such as a reference.
        """


def told(inclusion: EstimatedInclusion) -> str:
    """An inclusion in words."""
    place = ", ".join(format_quantity(value, "m") for value in inclusion.center)
    size = "" if inclusion.radius is None else f", radius {format_quantity(inclusion.radius, 'm')}"
    return f"{inclusion.kind} at ({place}){size}"
