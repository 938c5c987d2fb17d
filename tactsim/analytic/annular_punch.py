"""The rigid flat frictionless annulus on an elastic half-space or layer: force, pressure and shape of the surface."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.polynomial.chebyshev import chebval
from numpy.typing import ArrayLike

from tactsim.analytic.allowed_range import checked
from tactsim.analytic.annular_kernel import LogarithmicRing
from tactsim.analytic.layer_kernel import Base, Layer
from tactsim.errors import ConvergenceError

SMALLEST_HOLE = 1e-12
"""Radius ratio below which the hole counts as none: it changes displacements on a half-space by 4e-13 eps at most."""
STAND_IN = 1e-8
"""Hole that stands for none; it changes the force by 1e-25 and the pressure at CENTRE by (STAND_IN / CENTRE)^3."""
CENTRE = 1e-3
"""Radius below which the pressure without a hole is the even parabola through CENTRE and 2 CENTRE; 1e-11 off on a half-space."""
TERMS = (16, 32, 64, 128, 256, 512, 1024, 2048)
"""Numbers of points tried in turn."""
DECAYED = 50.0
"""Thicknesses beside the punch after which a layer is at rest: its modes decay at least like exp(-0.739 r / h)."""
AXIS = 1e-12
"""Radius over that of the hole that stands for the axis of the half-space, where the logarithm of the radius has no value."""
RADII = 33
"""Radii of the hole among which its highest place is looked for first."""
CHUNK = 1000
"""Radii evaluated at a time, which bounds the memory."""


@dataclass(frozen=True)
class AnnularPunch:
    r"""The solved contact of a rigid annulus b < r < a pressed by eps, frictionless; lengths over a, displacements over eps.

    The pressure solves the integral equation

    .. math::
        \frac{1 - \nu}{G} \int_b^a p(s)\, s \int_0^\infty M(k h) J_0(k r) J_0(k s)\, dk\, ds = \epsilon, \quad b < r < a

    by collocation at Chebyshev's points in ln r (``LogarithmicRing``).

    Source: the surface displacement of ``Layer``, superposed by the Hankel transform of the pressure.
    """

    radius_ratio: float
    """b / a."""
    layer: Layer
    """Lengths over a; of infinite thickness for the half-space."""
    force_factor: float
    """kappa = (1 - nu) P / (4 G a eps)."""
    terms: int
    """Number of points of the solution."""
    error: float
    """Last change of the force factor (relative) or of the displacement of the axis over eps."""
    density: np.ndarray = field(repr=False, compare=False)
    """p r times the root of ln(a / r) ln(r / b) at the points, shape (terms,)."""

    def pressure(self, r: ArrayLike) -> np.ndarray:
        """Contact pressure p a (1 - nu) / (G eps) at ``r`` over a, of the shape of ``r``: 0 beside the ring, inf at its edges.

        Raises
        ------
        InvalidQuantity
            If a radius is negative or not finite.
        """
        r = checked("radius over outer radius", r, "[0, inf)")
        low, high = self._solid * CENTRE, 2 * CENTRE
        inside = (r > self._hole) & (r >= low) & (r < 1)
        pressure = np.zeros(r.shape)
        pressure[inside] = self._ring_pressure(r[inside])
        pressure[(r == 1) | ((r == self._hole) & (low == 0))] = np.inf
        if self._solid:
            first, second = self._ring_pressure(np.array([low, high]))
            centre = r < low
            pressure[centre] = first + (second - first) * (r[centre] ** 2 - low**2) / (high**2 - low**2)
        return pressure

    def surface_displacement(self, r: ArrayLike) -> np.ndarray:
        """Displacement of the surface u / eps at ``r`` over a, positive into the body, of the shape of ``r``.

        Raises
        ------
        InvalidQuantity
            If a radius is negative or not finite.
        """
        r = checked("radius over outer radius", r, "[0, inf)")
        displacement = np.where(r <= 1, 1.0, 0.0)
        hole = (r < self.radius_ratio) & (not self._solid)
        free = hole | ((r > 1) & ((r - 1) / self.layer.thickness < DECAYED))
        radii = r[free]
        pieces = [self._displacement(radii[i : i + CHUNK]) for i in range(0, radii.size, CHUNK)]
        displacement[free] = np.concatenate(pieces) if pieces else radii
        return displacement

    def rise(self, r: ArrayLike) -> np.ndarray:
        """Height of the surface above the face of the punch over eps at ``r`` over a, 1 - u / eps, of the shape of ``r``.

        Raises
        ------
        InvalidQuantity
            If a radius is negative or not finite.
        """
        return 1 - self.surface_displacement(r)

    @property
    def rise_factor(self) -> float:
        """Height of the surface on the axis above the face of the punch, over eps; above 1 it stands above the free surface."""
        return float(self.rise(0.0))

    @property
    def largest_rise_factor(self) -> float:
        """Largest height of the surface in the hole above the face, over eps: off the axis on layers thin beside the hole."""
        if self._solid:
            return 0.0
        radii = np.linspace(0.0, self.radius_ratio, RADII, endpoint=False)
        rises = self.rise(radii)
        highest = int(rises.argmax())
        if highest == 0:
            return self.rise_factor
        around = float(radii[highest - 1]), float(min(radii[highest] + radii[1], self.radius_ratio))
        peak = scipy.optimize.minimize_scalar(lambda r: -float(self.rise(r)), bounds=around, method="bounded")
        return -float(peak.fun)

    @property
    def _solid(self) -> bool:
        return self.radius_ratio < SMALLEST_HOLE

    @property
    def _hole(self) -> float:
        return standing_in(self.radius_ratio)

    def _ring_pressure(self, r: np.ndarray) -> np.ndarray:
        outer, inner = -np.log(r), np.log(r / self._hole)
        coefficients = scipy.fft.dct(self.density) / self.terms
        coefficients[0] /= 2
        position = (inner - outer) / (inner + outer)
        return chebval(position, coefficients) / (r * np.sqrt(outer * inner))

    def _displacement(self, r: np.ndarray) -> np.ndarray:
        ring = LogarithmicRing(self._hole, self.terms)
        return influence(ring, self.layer, r) @ self.density


def standing_in(radius_ratio: float) -> float:
    """The radius ratio that is solved for ``radius_ratio``: itself, or STAND_IN for no hole."""
    return STAND_IN if radius_ratio < SMALLEST_HOLE else radius_ratio


def influence(ring: LogarithmicRing, layer: Layer, r: np.ndarray) -> np.ndarray:
    """Displacement u / eps at ``r`` over a, shape (n,), per density at the points of the ring: shape (n, terms)."""
    matrix = ring.half_space_influence(np.maximum(r, AXIS * ring.hole))
    return matrix if np.isinf(layer.thickness) else matrix + ring.layer_influence(layer, r)


def own_influence(ring: LogarithmicRing, layer: Layer) -> tuple[np.ndarray, np.ndarray]:
    """`influence` at the points themselves, shape (terms, terms), and on the axis, shape (terms,)."""
    both = ring.half_space_influence(np.append(ring.radii, AXIS * ring.hole))
    own, axis = both[:-1], both[-1]
    if np.isinf(layer.thickness):
        return own, axis
    added, added_on_axis = ring.own_layer_influence(layer)
    return own + added, axis + added_on_axis


def solve_annular_punch(
    radius_ratio: float,
    *,
    radius_over_thickness: float = 0.0,
    poisson_ratio: float = 0.5,
    base: Base = "bonded",
    tolerance: float = 1e-10,
) -> AnnularPunch:
    r"""The contact of a rigid flat frictionless annulus, in units of its outer radius and its indentation.

    The number of points is doubled until the force factor and the displacement of the axis change by less than ``tolerance``.

    Parameters
    ----------
    radius_ratio : float
        Inner over outer radius, in ``[0, 0.9999]``; 0 for a solid punch.
    radius_over_thickness : float
        Outer radius over the thickness of the layer, in ``[0, inf)``; 0 for a half-space. The points of ``TERMS`` suffice to 60
        without a hole, to 150 with a radius ratio of 0.1 and to 300 with 0.5, there in half a minute; thinner layers end as a
        ConvergenceError.
    poisson_ratio : float
        In ``(-1, 0.5]``; on a half-space it enters only through the units.
    base : str
        ``"bonded"`` or ``"slipping"``.
    tolerance : float
        In ``[1e-13, 0.01]``.

    Raises
    ------
    InvalidQuantity, UnknownName
        If an argument is out of its range.
    ConvergenceError
        If the last number of points of ``TERMS`` does not meet the tolerance; the history holds the changes.
    """
    checked("radius ratio", radius_ratio, "[0, 0.9999]")
    checked("radius over thickness", radius_over_thickness, "[0, inf)")
    checked("tolerance", tolerance, "[1e-13, 0.01]")
    layer = Layer(1 / radius_over_thickness if radius_over_thickness else np.inf, poisson_ratio, base)
    changes: list[float] = []
    before: tuple[float, float] | None = None
    for terms in TERMS:
        ring = LogarithmicRing(standing_in(radius_ratio), terms)
        matrix, on_axis = own_influence(ring, layer)
        density = np.linalg.solve(matrix, np.ones(terms))
        force_factor = np.pi / 2 * ring.weight * float(ring.radii @ density)
        axis = float(on_axis @ density)
        if before is not None:
            changes.append(max(abs(force_factor / before[0] - 1), abs(axis - before[1]) / max(1.0, abs(axis))))
            if changes[-1] <= tolerance:
                return AnnularPunch(float(radius_ratio), layer, force_factor, terms, changes[-1], density)
        before = force_factor, axis
    reason = f"annular punch of radius ratio {radius_ratio:g} with radius over thickness {radius_over_thickness:g}"
    raise ConvergenceError(f"{reason} still changes by {changes[-1]:.1e}, not {tolerance:g}, at {TERMS[-1]} points", changes)
