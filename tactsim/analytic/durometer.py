"""The scale of a durometer and what Hertz's contact says about it."""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Force, Length, Positive

ASSUMED = (
    "durometer by its given dimensions, by default those of type OO of ASTM D2240, recalled and not looked up; its presser foot, "
    "and how long it rests, do not count"
)
"""What every simulated reading assumes."""
FULL = 100.0
"""Largest reading."""
LARGEST_MODULUS = 1e15
"""In Pa, beyond any solid; Hertz then reads 100 to ten digits."""


class DurometerScale(FrozenModel):
    r"""A spring-loaded indentor whose depth is read in units from 0, the whole travel, to 100, no depth at all.

    .. math:: d = L (1 - H / 100), \qquad F = F_0 + k H

    Source: type OO of ASTM D2240, recalled from the standard and not looked up: a declared assumption.
    """

    travel: Positive[Length] = 2.5e-3
    """Depth L at reading 0."""
    force_at_zero: Positive[Force] = 0.203
    """Force F0 of the spring at reading 0."""
    force_per_unit: Positive[Force] = 0.00908
    """Growth k of the spring's force per unit of reading."""

    def depth(self, reading: float | Array) -> float | Array:
        """Depth in m at a reading, of its shape."""
        return self.travel * (1 - reading / FULL)

    def reading(self, depth: float | Array) -> float | Array:
        """Reading at a depth in m, dimensionless, of the depth's shape."""
        return FULL * (1 - depth / self.travel)

    def spring_force(self, depth: float | Array) -> float | Array:
        """Force in N of the spring at a depth in m, of its shape."""
        return self.force_at_zero + self.force_per_unit * self.reading(depth)

    def checked_reading(self, reading: float) -> float:
        """A reading at which the indentor has a depth.

        Raises
        ------
        InvalidQuantity
            If it is not in [0, 100).
        """
        if not 0 <= reading < FULL:
            raise InvalidQuantity(f"Shore reading {reading:g}; allowed are 0 to below {FULL:g}, where the depth is zero")
        return reading


def hertz_force(depth: float | Array, radius: float, youngs_modulus: float) -> float | Array:
    r"""Force in N, of the shape of the depth, of a rigid sphere on an incompressible elastic half-space.

    .. math:: F = \tfrac{16}{9} E \sqrt{R}\, d^{3/2}

    Parameters
    ----------
    depth, radius : ``d >= 0`` and ``R`` in m
    youngs_modulus : ``E`` in Pa

    Source: Hertz 1881, doi:10.1515/crll.1882.92.156, with a Poisson ratio of 1/2.
    """
    return 16 / 9 * youngs_modulus * np.sqrt(radius) * np.asarray(depth) ** 1.5


def hertz_depth(force: float, radius: float, youngs_modulus: float) -> float:
    """Depth in m at which Hertz's sphere bears a force in N; the inverse of `hertz_force`."""
    return float((force / hertz_force(1.0, radius, youngs_modulus)) ** (2 / 3))


def hertz_modulus(reading: float, scale: DurometerScale, radius: float) -> float:
    """Young's modulus in Pa of the incompressible half-space on which Hertz's sphere of this radius in m gives the reading.

    Raises
    ------
    InvalidQuantity
        If the reading is not in [0, 100).
    """
    depth = scale.depth(scale.checked_reading(reading))
    return float(scale.spring_force(depth) / hertz_force(depth, radius, 1.0))


def hertz_reading(youngs_modulus: float, scale: DurometerScale, radius: float) -> float | None:
    """Reading by Hertz on a half-space of this Young's modulus in Pa; None where the indentor goes beyond its travel.

    Raises
    ------
    InvalidQuantity
        If the modulus is not positive, or beyond any solid.
    """
    if not 0 < youngs_modulus <= LARGEST_MODULUS:
        raise InvalidQuantity(f"Young's modulus {youngs_modulus:g} Pa; allowed are above 0 up to {LARGEST_MODULUS:g} Pa")

    def surplus(depth: float) -> float:
        return float(hertz_force(depth, radius, youngs_modulus) - scale.spring_force(depth))

    if surplus(scale.travel) < 0:
        return None
    return float(scale.reading(scipy.optimize.brentq(surplus, 0.0, scale.travel, xtol=1e-12 * scale.travel)))
