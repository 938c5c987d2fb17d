"""Generalized Kelvin model: a spring, Kelvin units and a dashpot in series."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.spectrum import checked_frequencies, checked_instants, checked_number, checked_spectrum
from tactsim.array import Array


@dataclass(frozen=True, eq=False)
class GeneralizedKelvin:
    r"""Linear viscoelastic model given by its creep compliance.

    .. math:: J(t) = J_0 + \sum_{i=1}^{n} J_i (1 - e^{-t / \tau_i}) + \varphi t

    The compliance may be that of any pair of stress and strain: 1/E, 1/G or 1/(2G).

    Parameters
    ----------
    glassy_compliance : float
        ``J0 > 0`` in 1/Pa.
    compliances, times : array_like
        ``J_i > 0`` in 1/Pa and ``tau_i > 0`` in s, shape (n,), n >= 0; held sorted by time, read-only, equal times merged.
    fluidity : float
        ``phi >= 0`` in 1/(Pa s); positive for a fluid.

    Raises
    ------
    InvalidQuantity
        If a number is out of its range.

    Source: Tschoegl 1989, The Phenomenological Theory of Linear Viscoelastic Behavior, chapter 3; thesis section 4.3, eq. 4.3.8.
    """

    glassy_compliance: float
    compliances: Array
    times: Array
    fluidity: float = 0.0

    def __post_init__(self) -> None:
        compliances, times = checked_spectrum("compliances", self.compliances, self.times)
        object.__setattr__(self, "glassy_compliance", checked_number("glassy_compliance", self.glassy_compliance))
        object.__setattr__(self, "compliances", compliances)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "fluidity", checked_number("fluidity", self.fluidity, zero=True))

    @property
    def equilibrium_compliance(self) -> float:
        """J(inf) = J0 + sum J_i in 1/Pa; infinite for a fluid."""
        return math.inf if self.fluidity else self.glassy_compliance + math.fsum(self.compliances)

    def creep(self, t: ArrayLike) -> Array:
        """J(t) in 1/Pa at times ``t`` in s, of the shape of ``t``; 0 for t < 0.

        Raises
        ------
        InvalidQuantity
            If a time is NaN or not a real number.
        """
        instants = checked_instants(t)
        after = np.maximum(instants, 0.0)
        units = -np.expm1(-after[..., None] / self.times) @ self.compliances
        flow = self.fluidity * after if self.fluidity else 0.0
        return np.where(instants < 0, 0.0, self.glassy_compliance + units + flow)

    def complex_compliance(self, omega: ArrayLike) -> Array:
        r"""Complex compliance D* = D_e - i D_v in 1/Pa at angular frequencies ``omega`` in rad/s, of the shape of ``omega``.

        .. math::
            D^*(\omega) = J_0 + \sum_i \frac{J_i}{1 + i \omega \tau_i} + \frac{\varphi}{i \omega}

        Raises
        ------
        InvalidQuantity
            If a frequency is negative or not finite, or zero for a fluid.

        Source: thesis section 4.3, eq. 4.3.8.
        """
        frequencies = checked_frequencies(omega, zero=self.fluidity == 0)
        units = (1 / (1 + 1j * frequencies[..., None] * self.times)) @ self.compliances
        flow = self.fluidity / (1j * frequencies) if self.fluidity else 0.0
        return self.glassy_compliance + units + flow

    def scaled(self, factor: float) -> GeneralizedKelvin:
        """The model with all compliances and the fluidity multiplied by ``factor > 0``.

        Raises
        ------
        InvalidQuantity
            If the factor is not finite and positive.
        """
        factor = checked_number("factor", factor)
        return GeneralizedKelvin(
            factor * self.glassy_compliance, factor * self.compliances, self.times, fluidity=factor * self.fluidity
        )
