"""Generalized Maxwell model, the Prony series: a spring and Maxwell units in parallel."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.spectrum import checked_frequencies, checked_instants, checked_number, checked_spectrum
from tactsim.array import Array


@dataclass(frozen=True, eq=False)
class GeneralizedMaxwell:
    r"""Linear viscoelastic model given by its relaxation modulus.

    .. math:: G(t) = G_\infty + \sum_{k=1}^{n} G_k e^{-t / \tau_k}

    Parameters
    ----------
    equilibrium_modulus : float
        ``Ginf >= 0`` in Pa; zero for a fluid.
    moduli, times : array_like
        ``G_k > 0`` in Pa and ``tau_k > 0`` in s, shape (n,), n >= 0; held sorted by time, read-only, equal times merged.

    Raises
    ------
    InvalidQuantity
        If a number is out of its range, or if the model has no stiffness at all.

    Source: Tschoegl 1989, The Phenomenological Theory of Linear Viscoelastic Behavior, chapter 3.
    """

    equilibrium_modulus: float
    moduli: Array
    times: Array

    def __post_init__(self) -> None:
        moduli, times = checked_spectrum("moduli", self.moduli, self.times)
        modulus = checked_number("equilibrium_modulus", self.equilibrium_modulus, zero=moduli.size > 0)
        object.__setattr__(self, "equilibrium_modulus", modulus)
        object.__setattr__(self, "moduli", moduli)
        object.__setattr__(self, "times", times)

    @property
    def instantaneous_modulus(self) -> float:
        """G(0) = Ginf + sum G_k in Pa."""
        return self.equilibrium_modulus + math.fsum(self.moduli)

    def relaxation(self, t: ArrayLike) -> Array:
        """G(t) in Pa at times ``t`` in s, of the shape of ``t``; 0 for t < 0.

        Raises
        ------
        InvalidQuantity
            If a time is NaN or not a real number.
        """
        instants = checked_instants(t)
        units = np.exp(-np.maximum(instants, 0.0)[..., None] / self.times) @ self.moduli
        return np.where(instants < 0, 0.0, self.equilibrium_modulus + units)

    def complex_modulus(self, omega: ArrayLike) -> Array:
        r"""Complex modulus G* in Pa at angular frequencies ``omega`` in rad/s, of the shape of ``omega``.

        .. math:: G^*(\omega) = G_\infty + \sum_k G_k \frac{i \omega \tau_k}{1 + i \omega \tau_k}

        Raises
        ------
        InvalidQuantity
            If a frequency is negative or not finite.
        """
        frequencies = checked_frequencies(omega, zero=True)
        phase = 1j * frequencies[..., None] * self.times
        return self.equilibrium_modulus + (phase / (1 + phase)) @ self.moduli

    def scaled(self, factor: float) -> GeneralizedMaxwell:
        """The model with all moduli multiplied by ``factor > 0``.

        Raises
        ------
        InvalidQuantity
            If the factor is not finite and positive.
        """
        factor = checked_number("factor", factor)
        return GeneralizedMaxwell(factor * self.equilibrium_modulus, factor * self.moduli, self.times)
