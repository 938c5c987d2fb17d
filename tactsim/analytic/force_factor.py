r"""Force and rise of the rigid flat annulus on an elastic half-space as quick functions of its radius ratio.

.. math:: P = \kappa(b / a)\, \frac{4 G a \epsilon}{1 - \nu}

Source: thesis, eqs. 4.2.21 and 4.6.5, for the form; the factor is computed anew, as the printed one is not that of the annulus
(errata E6).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Literal

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.typing import ArrayLike

from tactsim.analytic.allowed_range import checked
from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.errors import UnknownName

Formula = Literal["exact", "thesis_4_2_21", "small_hole_series", "smythe"]

LARGEST_RATIO = 0.99
"""Largest radius ratio of the functions here; above it ``solve_annular_punch`` goes on to 0.9999."""
INTERPOLATION_TERMS = 40
"""Terms of the Chebyshev series; from the 35th on they are round-off."""
INTERPOLATION_ERROR = 1e-12
"""Bound of the error of the interpolated force factor and rise factor."""
CHUNK = 8192
"""Ratios evaluated at a time, so that the sums stay in the cache of the processor."""


def force_factor(radius_ratio: ArrayLike, formula: str = "exact") -> np.ndarray:
    r"""Force factor kappa = (1 - nu) P / (4 G a eps) of the annulus, dimensionless, of the shape of ``radius_ratio``.

    With :math:`\beta = b / a`, the ``formula`` is one of ``FORMULAS``:

    - ``exact``: the solved contact, interpolated to ``INTERPOLATION_ERROR``;
    - ``thesis_4_2_21``: :math:`1 - 4 \beta^3 / (3 \pi^2) - \beta^4 / 8`, as printed in the thesis, eq. 4.2.21 (an error there);
    - ``small_hole_series``: :math:`1 - 4 \beta^3 / (3 \pi^2) - 8 \beta^5 / (15 \pi^2) - 16 \beta^6 / (27 \pi^4)`, of use to
      :math:`\beta = 0.5` (Gubenko & Mossakovskii 1960, PMM 24; Collins 1963, Proc. Edinburgh Math. Soc. 13, 235);
    - ``smythe``: :math:`(2 / \pi) (\cos^{-1} \beta + \sqrt{1 - \beta^2} \tanh^{-1} \beta)
      (1 + 0.0143\, \beta^{-1} \tan^3 1.28 \beta)`, within 0.4 % to :math:`\beta = 0.75` (Smythe 1951, J. Appl. Phys. 22, 1499).

    Raises
    ------
    InvalidQuantity
        If a ratio is outside ``[0, 0.99]``.
    UnknownName
        If the formula is not one of ``FORMULAS``.
    """
    if formula not in FORMULAS:
        raise UnknownName("formula of the force factor", str(formula), FORMULAS)
    return FORMULAS[formula](checked("radius ratio", radius_ratio, f"[0, {LARGEST_RATIO}]"))


def rise_factor(radius_ratio: ArrayLike) -> np.ndarray:
    """Height of the surface on the axis over the face of the annulus, over eps; dimensionless, of the shape of ``radius_ratio``.

    The solved contact, interpolated to ``INTERPOLATION_ERROR``.

    Raises
    ------
    InvalidQuantity
        If a ratio is outside ``[0, 0.99]``.
    """
    return _interpolated(checked("radius ratio", radius_ratio, f"[0, {LARGEST_RATIO}]"), 1)


@cache
def _coefficients() -> np.ndarray:
    """Chebyshev coefficients of the force factor and the rise factor in atanh(b / a), shape (2, INTERPOLATION_TERMS).

    In this variable the logarithm at b = a is at infinity and the nearest singularity at a distance of pi / 4 or more.
    """
    angle = (np.arange(INTERPOLATION_TERMS) + 0.5) * np.pi / INTERPOLATION_TERMS
    ratios = np.tanh(np.arctanh(LARGEST_RATIO) * (1 + np.cos(angle)) / 2)
    punches = [solve_annular_punch(ratio) for ratio in ratios]
    values = np.array([[punch.force_factor, punch.rise_factor] for punch in punches])
    coefficients = 2 / INTERPOLATION_TERMS * np.cos(np.outer(np.arange(INTERPOLATION_TERMS), angle)) @ values
    coefficients[0] /= 2
    return coefficients.T


def _interpolated(ratio: np.ndarray, which: int) -> np.ndarray:
    """Force factor (``which`` = 0) or rise factor (1), of the shape of ``ratio``."""
    coefficients, flat, values = _coefficients()[which], ratio.ravel(), np.empty(ratio.size)
    for start in range(0, flat.size, CHUNK):
        piece = slice(start, start + CHUNK)
        values[piece] = chebval(np.arctanh(flat[piece]) * (2 / np.arctanh(LARGEST_RATIO)) - 1, coefficients)
    return values.reshape(ratio.shape)


def _exact(ratio: np.ndarray) -> np.ndarray:
    return _interpolated(ratio, 0)


def _thesis(ratio: np.ndarray) -> np.ndarray:
    return 1 - 4 * ratio**3 / (3 * np.pi**2) - ratio**4 / 8


def _small_hole_series(ratio: np.ndarray) -> np.ndarray:
    return 1 - 4 * ratio**3 / (3 * np.pi**2) - 8 * ratio**5 / (15 * np.pi**2) - 16 * ratio**6 / (27 * np.pi**4)


def _smythe(ratio: np.ndarray) -> np.ndarray:
    thin = np.arccos(ratio) + np.sqrt(1 - ratio**2) * np.arctanh(ratio)
    tangent = np.tan(1.28 * ratio)
    correction = 0.0143 * tangent**2 * np.divide(tangent, ratio, out=np.zeros_like(ratio), where=ratio > 0)
    return 2 / np.pi * thin * (1 + correction)


FORMULAS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "exact": _exact,
    "thesis_4_2_21": _thesis,
    "small_hole_series": _small_hole_series,
    "smythe": _smythe,
}
"""Formulas of the force factor."""
