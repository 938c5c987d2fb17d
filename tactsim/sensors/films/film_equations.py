"""The printed equations of a film under a constant force, in their corrected and their printed readings."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.sensors.films.composite import Composite

Reading = Literal["corrected", "eq_2_3_1", "eq_2_1_17"]


def creep_strain(composite: Composite, force: ArrayLike, time: ArrayLike) -> Array:
    r"""Strain after a constant force of F newton on the reference area has acted for t seconds.

    .. math:: \varepsilon = \frac{F}{A E_0} + \frac{F}{A E_1} \left(1 - e^{-E_1 t / \mu_1}\right)

    Force and time broadcast.

    Source: thesis, eqs. 2.1.15 and 2.3.1, whose printed exponent is :math:`-\mu_1 t / E_1` (errata E1).
    """
    first, delayed = _strains(composite, force, time, "corrected")
    return first + delayed


def film_resistance(composite: Composite, force: ArrayLike, time: ArrayLike, *, reading: Reading = "corrected") -> Array:
    r"""Resistance in ohm of film and contacts under a constant force F > 0 on the reference area, after t seconds.

    .. math:: R = \frac{R_1}{\sqrt{F}} + R_0 (1 - \varepsilon) e^{-\gamma s_0 \varepsilon}

    ``eq_2_3_1`` leaves gamma s0 out of the delayed part of the exponent, as printed there (errata E2); ``eq_2_1_17`` has the
    exponent of errata E1. Force and time broadcast.

    Source: thesis, eqs. 2.1.17 and 2.3.1.
    """
    first, delayed = _strains(composite, force, time, reading)
    exponent = composite.exponent * first + (1.0 if reading == "eq_2_3_1" else composite.exponent) * delayed
    relative = (1 - first - delayed) * np.exp(-exponent)
    return composite.contact_resistance / np.sqrt(np.asarray(force)) + composite.initial_resistance * relative


def varying_coefficient_jump(composite: Composite, force: float) -> float:
    r"""Immediate strain under a sudden force in N when eq. 2.1.14 is integrated with coefficients that follow the force.

    .. math:: \varepsilon = \frac{1}{A} \int_0^F \frac{dF'}{E_0(F')} = \frac{1}{A b} \ln\frac{a + b F}{a}, \quad E_0 = a + b F

    It is larger than F / (A E0(F)) of eq. 2.3.1: errata E29.
    """
    line = composite.instantaneous
    if line.slope == 0:
        return force / (composite.reference_area * line.intercept)
    return float(np.log1p(line.slope * force / line.intercept) / (line.slope * composite.reference_area))


def _strains(composite: Composite, force: ArrayLike, time: ArrayLike, reading: Reading) -> tuple[Array, Array]:
    """Immediate and delayed strain."""
    force, time = np.asarray(force, dtype=float), np.asarray(time, dtype=float)
    stress = force / composite.reference_area
    modulus, viscosity = composite.delayed.at(force), composite.viscosity.at(force)
    rate = viscosity / modulus if reading == "eq_2_1_17" else modulus / viscosity
    return stress / composite.instantaneous.at(force), -np.expm1(-rate * time) * stress / modulus
