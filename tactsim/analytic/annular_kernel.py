"""Influence of the pressure on a ring on the surface displacement: half-space and layer, the logarithm integrated exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy

from tactsim.analytic.layer_kernel import Layer

CLOSEST = 1e-8
"""Separation in ln r below which the even factors of the split kernel equal their values at 0 to round-off."""
FARTHEST = 300.0
"""Separation in ln r beyond which the kernel is a constant or 1e-130."""
LAST_WAVE = 24.0
"""Wave number times thickness beyond which 1 - M < 4 x^2 exp(-2 x) = 3e-18 for every Poisson's ratio."""
PANEL_POINTS = 16
"""Gauss points in a panel: for poles of M at a distance of a panel or more and 4 rad of phase, error below 1e-16."""


@dataclass(frozen=True)
class LogarithmicRing:
    r"""The ring b < r < 1 in :math:`\ln r`, with Chebyshev's points of the first kind.

    .. math:: \ln r = \lambda (y - 1), \quad \lambda = -\tfrac12 \ln b, \quad y \in [-1, 1]

    A pressure :math:`p(r)\, r\, \lambda = \phi(y) / \sqrt{1 - y^2}` is given by ``density``, the values of phi at ``nodes``.

    Source: Mason & Handscomb 2003, Chebyshev Polynomials, chapter 9: density and points for an integral equation with a
    logarithm.
    """

    hole: float
    """Inner radius b over the outer radius, in (0, 1)."""
    terms: int
    """Number of points."""

    @property
    def half_length(self) -> float:
        """Half of the range of ln r."""
        return -0.5 * float(np.log(self.hole))

    @cached_property
    def nodes(self) -> np.ndarray:
        """Points y, shape (terms,), from 1 down to -1."""
        return np.cos((np.arange(self.terms) + 0.5) * np.pi / self.terms)

    @cached_property
    def radii(self) -> np.ndarray:
        """Radii of the points over the outer radius, shape (terms,)."""
        return np.exp(self.half_length * (self.nodes - 1))

    @property
    def weight(self) -> float:
        """Gauss weight of every point for integrals with 1 / sqrt(1 - y^2)."""
        return np.pi / self.terms

    def half_space_influence(self, r: np.ndarray) -> np.ndarray:
        r"""Displacement at ``r`` > 0, shape (n,), per density at the nodes: matrix of shape (n, terms), dimensionless.

        .. math::
            u(r) = \frac{1}{2 \pi} \int_b^1 p(s)\, s\, \frac{4}{r + s} K\!\left(\frac{4 r s}{(r + s)^2}\right) ds
            = \frac{1}{\pi} \int_{-1}^{1} \frac{2 K(m)}{1 + r/s} \frac{\phi(y)\, dy}{\sqrt{1 - y^2}}

        with p in units of G eps / ((1 - nu) a) and u in units of eps. Source: Johnson 1985, Contact Mechanics, section 3.8.
        """
        logarithm = np.log(r)[:, None]
        delta = np.clip(logarithm - self.half_length * (self.nodes - 1), -FARTHEST, FARTHEST)
        singular, smooth = split_kernel(delta)
        smooth = smooth + singular * np.log(self.half_length)
        return (singular * self.logarithm_weights(r) + self.weight * smooth) / np.pi

    def logarithm_weights(self, r: np.ndarray) -> np.ndarray:
        r"""Weights of the values f(nodes) in the integral of f(y) ln|x - y| / sqrt(1 - y^2) at x of ``r``, shape (n, terms).

        Exact for polynomials of degree below ``terms``. With :math:`\rho = |x| + \sqrt{x^2 - 1}` for :math:`|x| > 1`, else 1, and
        :math:`\theta = \cos^{-1} x`, cut to 0 or pi for :math:`|x| > 1`,

        .. math::
            \int_{-1}^1 \frac{\ln|x - y|}{\sqrt{1 - y^2}} dy = \pi \ln \frac{\rho}{2}, \quad
            \int_{-1}^1 \frac{T_n(y) \ln|x - y|}{\sqrt{1 - y^2}} dy = -\frac{\pi}{n} \rho^{-n} \cos n \theta

        Source: Mason & Handscomb 2003, Chebyshev Polynomials, chapter 9, integrated.
        """
        order = np.arange(1, self.terms)
        x = 1 + np.log(r) / self.half_length
        root = np.sqrt(np.maximum(np.log(r) * np.log(r / self.hole), 0)) / self.half_length
        decay = np.where(root > 0, 1 / (np.maximum(np.abs(x), 1) + root), 1)
        angle = np.arccos(np.clip(x, -1, 1))
        moments = decay[:, None] ** order * np.cos(angle[:, None] * order) * (-np.pi / order)
        chebyshev = np.cos(np.outer(order, np.arccos(self.nodes)))
        first = -np.pi * np.log(2 * decay)
        return (first[:, None] + 2 * moments @ chebyshev) / self.terms

    def layer_influence(self, layer: Layer, r: np.ndarray) -> np.ndarray:
        r"""What the base of ``layer`` (lengths over the outer radius) adds to ``half_space_influence``, shape (n, terms).

        .. math:: \int_b^1 p(s)\, s \int_0^\infty (M(x) - 1)\, J_0(x r / h)\, J_0(x s / h)\, \frac{dx}{h}\, ds

        Source: the surface displacement of ``Layer``, superposed by the Hankel transform of the pressure, less that of the
        half-space.
        """
        x, amplitudes = _waves(layer, max(1.0, float(r.max(initial=0))))
        return _modes(layer, r, x) @ (amplitudes[:, None] * _modes(layer, self.radii, x).T) * (self.weight * self.radii)

    def own_layer_influence(self, layer: Layer) -> tuple[np.ndarray, np.ndarray]:
        """The same at the points, shape (terms, terms), and on the axis, shape (terms,), from waves that are worked out once."""
        x, amplitudes = _waves(layer, 1.0)
        modes, loads = _modes(layer, self.radii, x), self.weight * self.radii
        roots = modes * np.sqrt(-amplitudes)  # 1 - M > 0; a matrix by its own transpose is half the work
        return -(roots @ roots.T) * loads, modes @ amplitudes * loads


def _waves(layer: Layer, farthest: float) -> tuple[np.ndarray, np.ndarray]:
    """Wave numbers times thickness that resolve the product of two waves out to ``farthest``, and their amplitudes."""
    x, weights = wave_quadrature(farthest / layer.thickness)
    return x, -weights * layer.deficit(x) / layer.thickness


def _modes(layer: Layer, r: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Waves at radii (n,) of wave numbers times thickness (m,): shape (n, m)."""
    return scipy.special.j0(np.outer(r, x) / layer.thickness)


def split_kernel(delta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    r"""Smooth functions A and B of the separation ``delta`` in ln r with kernel = A ln|delta| + B, dimensionless.

    .. math::
        \frac{2 K(m)}{1 + e^\delta} = A \ln|\delta| + B, \quad m = \cosh^{-2}(\delta / 2), \quad m_1 = 1 - m

    From :math:`K(m) = -K(m_1) \ln q(m_1) / \pi` with the nome q, analytic and of slope 1/16 at 0,
    :math:`A = -(2 / \pi) K(m_1) \cdot 2 / (1 + e^\delta)`. Both are analytic for :math:`|\Im \delta| < \pi`; B(0) = 3 ln 2. The
    subtraction loses no more than ln(1 / CLOSEST) round-offs. Both have the shape of ``delta``.

    Source: Abramowitz & Stegun 1964, section 17.3 (nome).
    """
    distance = np.maximum(np.abs(delta), CLOSEST)
    factor = 2 / (1 + np.exp(delta))
    singular = -2 / np.pi * scipy.special.ellipkm1(np.cosh(distance / 2) ** -2)
    return factor * singular, factor * (scipy.special.ellipkm1(np.tanh(distance / 2) ** 2) - singular * np.log(distance))


def wave_quadrature(frequency: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights (n,) on [0, LAST_WAVE] that resolve M and the product of two waves of ``frequency`` rad per unit."""
    panels = int(np.ceil(LAST_WAVE * max(1.0, frequency / 4)))
    edges = np.linspace(0, LAST_WAVE, panels + 1)
    points, weights = _panel_quadrature()
    half = LAST_WAVE / panels / 2
    return (edges[:-1, None] + half * (points + 1)).ravel(), np.tile(half * weights, panels)


@cache
def _panel_quadrature() -> tuple[np.ndarray, np.ndarray]:
    """Points and weights on [-1, 1]."""
    return np.polynomial.legendre.leggauss(PANEL_POINTS)
