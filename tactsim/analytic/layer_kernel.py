"""An elastic layer on a rigid base: the amplitude of its surface under a wave of pressure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.allowed_range import checked
from tactsim.errors import UnknownName

Base = Literal["bonded", "slipping"]
"""The layer sticks to its base, or slides on it without friction and without lifting off."""

SERIES_BELOW = 1.0
"""Argument in radian below which sinh z - z is summed as a series; the first term left out is then 1e-16 of the sum."""


@dataclass(frozen=True)
class Layer:
    r"""An elastic layer on a rigid base, as an axisymmetric pressure sees it.

    A pressure :math:`p J_0(x r / h)` without shear moves the surface down by

    .. math:: u = \frac{(1 - \nu) h}{G x} M(x)\, p\, J_0(x r / h)

    where :math:`M = 1` for a half-space and, with :math:`k = 3 - 4 \nu`,

    .. math::
        M_{bonded} = \frac{2 k \sinh 2x - 4x}{2 k \cosh 2x + 1 + k^2 + 4 x^2}, \quad
        M_{slipping} = \frac{\cosh 2x - 1}{\sinh 2x + 2x}

    Parameters
    ----------
    thickness : float
        ``h`` in m, in ``(0, inf]``; infinite for a half-space.
    poisson_ratio : float
        In ``(-1, 0.5]``.
    base : str
        ``"bonded"`` or ``"slipping"``.

    Raises
    ------
    InvalidQuantity
        If the thickness or the ratio is out of its range.
    UnknownName
        If the base is neither of the two.

    Source: Lebedev & Ufliand 1958, PMM 22, 320 (slipping); Hayes, Keer, Herrmann & Mockros 1972, J. Biomech. 5, 541 (bonded).
    """

    thickness: float
    poisson_ratio: float = 0.5
    base: Base = "bonded"

    def __post_init__(self) -> None:
        checked("thickness", self.thickness, "(0, inf] m")
        checked("Poisson's ratio", self.poisson_ratio, "(-1, 0.5]")
        if self.base not in get_args(Base):
            raise UnknownName("base of a layer", str(self.base), get_args(Base))

    def transfer(self, wave: ArrayLike) -> np.ndarray:
        """M at ``wave`` = wave number times thickness, dimensionless, any shape; 0 at 0, 1 at infinity.

        Raises
        ------
        InvalidQuantity
            If a wave is negative or not a number.
        """
        x, decay = self._scaled(wave)
        if self.base == "slipping":
            return np.divide(np.expm1(-2 * x) ** 2, self._denominator(x, decay), out=np.zeros_like(x), where=x > 0)
        k = self._kolosov
        difference = np.where(2 * x < SERIES_BELOW, 2 * decay * sinh_excess(np.minimum(2 * x, SERIES_BELOW)), 0)
        difference = np.where(2 * x < SERIES_BELOW, difference, -np.expm1(-4 * x) - 4 * x * decay)
        return (k * difference + 4 * (k - 1) * x * decay) / self._denominator(x, decay)

    def deficit(self, wave: ArrayLike) -> np.ndarray:
        """1 - M at ``wave``, dimensionless, any shape; 1 at 0, accurate where it decays like exp(-2 wave).

        Raises
        ------
        InvalidQuantity
            If a wave is negative or not a number.
        """
        x, decay = self._scaled(wave)
        if self.base == "slipping":
            numerator = 2 * decay * (2 * x - np.expm1(-2 * x))
            return np.divide(numerator, self._denominator(x, decay), out=np.ones_like(x), where=x > 0)
        k = self._kolosov
        return decay * (1 + k**2 + 4 * x + 4 * x**2 + 2 * k * decay) / self._denominator(x, decay)

    @property
    def _kolosov(self) -> float:
        return 3 - 4 * self.poisson_ratio

    def _denominator(self, x: np.ndarray, decay: np.ndarray) -> np.ndarray:
        """Denominator of M times ``decay`` (bonded) or 2 ``decay`` (slipping), which keeps it finite."""
        if self.base == "slipping":
            return -np.expm1(-4 * x) + 4 * x * decay
        k = self._kolosov
        return k * (1 + decay**2) + (1 + k**2 + 4 * x**2) * decay

    @staticmethod
    def _scaled(wave: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """The wave, cut where exp(-2 wave) is 0 in floating point, and exp(-2 wave)."""
        x = np.minimum(checked("wave number times thickness", wave, "[0, inf]"), 400.0)
        return x, np.exp(-2 * x)


def sinh_excess(z: np.ndarray) -> np.ndarray:
    """Sinh z - z to round-off for z in [0, 1], of its shape, by its Taylor series."""
    total = np.ones_like(z)
    for n in (8, 7, 6, 5, 4, 3, 2):
        total = 1 + z**2 / ((2 * n) * (2 * n + 1)) * total
    return z**3 / 6 * total
