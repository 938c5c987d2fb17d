"""One Kelvin unit behind a spring: its law, and its compliance in oscillation; thesis section 4.3."""

from __future__ import annotations

from typing import Literal

import numpy as np

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.interfaces import quantity
from tactsim.units import Frequency, Positive, Pressure, Time, Viscosity

INSTANTS = np.linspace(0.05, 5.0, 40)
"""In times of the unit."""
STEP = 1e-4
"""In times of the unit; central differences err by STEP^2 / 6 of a third derivative."""


@quantity(unit="1")
def kelvin_law_residual(
    spring: Positive[Pressure] = 10e3, modulus: Positive[Pressure] = 4e3, viscosity: Positive[Viscosity] = 2e3
) -> float:
    r"""What the creep under a constant stress leaves in eq. 4.3.1, over the largest term of it.

    With a constant stress :math:`\Sigma = E_0 E_1 E / (E_0 + E_1) + C_1 E_0 \dot E / (E_0 + E_1)`; the strain is that of the
    generalized Kelvin model, its rate taken by central differences.

    Parameters
    ----------
    spring, modulus, viscosity : E0, E1 and C1
    """
    unit = viscosity / modulus
    model = GeneralizedKelvin(1 / spring, np.array([1 / modulus]), np.array([unit]))
    strain = model.creep(INSTANTS * unit)
    rate = (model.creep((INSTANTS + STEP) * unit) - model.creep((INSTANTS - STEP) * unit)) / (2 * STEP * unit)
    whole = spring + modulus
    elastic, viscous = spring * modulus / whole * strain, viscosity * spring / whole * rate
    return float(np.abs(elastic + viscous - 1).max() / max(elastic.max(), viscous.max()))


@quantity(unit="1/Pa")
def kelvin_unit_compliance(
    part: Literal["elastic", "viscous"],
    *,
    spring: Positive[Pressure],
    modulus: Positive[Pressure],
    time: Positive[Time],
    frequency: Positive[Frequency],
) -> float:
    """Elastic or viscous part in 1/Pa of the complex compliance of one unit behind a spring, eq. 4.3.4.

    Parameters
    ----------
    part : which part; the viscous one is positive
    spring, modulus : E0 and E1
    time : retardation time of the unit
    frequency : frequency of the test
    """
    compliance = GeneralizedKelvin(1 / spring, np.array([1 / modulus]), np.array([time])).complex_compliance(
        2 * np.pi * frequency
    )
    return float(compliance.real if part == "elastic" else -compliance.imag)
