"""Tunnelling between filler particles and contact at the electrodes of a semiconductive polymer composite."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.errors import InvalidQuantity

PLANCK = 6.62607015e-34
"""Planck constant in J s, exact by the definition of the kilogram; scipy's tables of constants load longer than a film takes."""
ELECTRON_MASS = 9.1093837139e-31
"""In kg, CODATA 2022, doi:10.1103/RevModPhys.97.025002."""
LOOSEST_PACKING = np.pi / 6
"""Volume fraction of a simple cubic packing: spheres touch, the separation of eq. 2.1.8 is zero."""


def tunnelling_decay(barrier: float) -> float:
    r"""Decay gamma in 1/m of the tunnelling current with the separation.

    .. math:: \gamma = \frac{4 \pi}{h} \sqrt{2 m \varphi}

    Parameters
    ----------
    barrier : float
        Height of the potential barrier between two particles in J, > 0.

    Raises
    ------
    InvalidQuantity
        If the barrier is not positive.

    Source: thesis, eq. 2.1.4; J. G. Simmons 1963, doi:10.1063/1.1702682.
    """
    if not barrier > 0:
        raise InvalidQuantity(f"barrier is {barrier} J; allowed: > 0")
    return float(4 * np.pi / PLANCK * np.sqrt(2 * ELECTRON_MASS * barrier))


def particle_separation(diameter: float, volume_fraction: float) -> float:
    r"""Separation s0 in m of neighbouring spherical particles.

    .. math:: s_0 = D \left[\left(\frac{\pi}{6 \phi}\right)^{1/3} - 1\right]

    Parameters
    ----------
    diameter : float
        D in m, > 0.
    volume_fraction : float
        phi, between 0 and pi/6.

    Raises
    ------
    InvalidQuantity
        If the diameter is not positive or the volume fraction out of its range.

    Source: thesis, eq. 2.1.8, after S. Wu 1985, doi:10.1016/0032-3861(85)90015-1.
    """
    if not 0 < volume_fraction < LOOSEST_PACKING:
        raise InvalidQuantity(f"volume fraction is {volume_fraction}; allowed: above 0 and below pi/6 = {LOOSEST_PACKING:.4f}")
    if not diameter > 0:
        raise InvalidQuantity(f"particle diameter is {diameter} m; allowed: > 0")
    return float(diameter * ((LOOSEST_PACKING / volume_fraction) ** (1 / 3) - 1))


def volume_fraction(*, filler_mass: float, filler_density: float, matrix_mass: float, matrix_density: float) -> float:
    """Volume fraction of the filler from thermogravimetric analysis.

    Parameters
    ----------
    filler_mass, matrix_mass : float
        Mass in kg of the residue and of what burnt off, > 0.
    filler_density, matrix_density : float
        In kg/m^3, > 0.

    Raises
    ------
    InvalidQuantity
        If a mass or a density is not positive.

    Source: thesis, section 2.3.
    """
    given = (filler_mass, filler_density, matrix_mass, matrix_density)
    if min(given) <= 0:
        raise InvalidQuantity(f"masses and densities are {given} kg, kg/m^3; allowed: > 0")
    filled, empty = filler_mass / filler_density, matrix_mass / matrix_density
    return filled / (filled + empty)


def relative_resistance(strain: ArrayLike, exponent: float) -> Array:
    r"""Resistance of the composite over its initial value, dimensionless.

    .. math:: R / R_0 = (1 - \varepsilon) e^{-\gamma s_0 \varepsilon}

    Parameters
    ----------
    strain : array
        Compressive strain, any shape.
    exponent : float
        gamma s0.

    Source: thesis, eqs. 2.1.6, 2.1.7 and 2.1.9.
    """
    strain = np.asarray(strain)
    return (1 - strain) * np.exp(-exponent * strain)


def contact_coefficient(resistivities: tuple[float, float], hardness: float) -> float:
    r"""Coefficient c in ohm sqrt(N) of the resistance of both contacts, 2 R_con = c / sqrt(F).

    .. math:: c = \frac{\rho_1 + \rho_2}{2} \sqrt{\pi H}

    Parameters
    ----------
    resistivities : (float, float)
        Of composite and electrode in ohm m.
    hardness : float
        Meyer hardness of the softer one in Pa.

    Raises
    ------
    InvalidQuantity
        If the resistivities have no positive sum or the hardness is not positive.

    Source: thesis, eq. 2.1.12, after R. Holm, Electric Contacts, 1967.
    """
    if sum(resistivities) <= 0 or hardness <= 0:
        raise InvalidQuantity(f"resistivities {resistivities} ohm m and hardness {hardness} Pa; allowed: a positive sum, > 0")
    return float(sum(resistivities) / 2 * np.sqrt(np.pi * hardness))
