"""Left atrial tissue of swine: the generalized Kelvin model of thesis Table 4.1 in all its readings."""

from __future__ import annotations

import numpy as np

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.errors import UnknownName

MEGAPASCAL = 1e6
E0 = 56.45258219
"""Modulus of the free spring in MPa, thesis section 4.5, Table 4.1."""
E = (0.003942097, 0.007498926, 0.060282772, 0.002390291, 0.006842171, 0.005091904, 0.093982545, 0.001876492)
"""Moduli E_1 to E_8 of the Kelvin units in MPa, Table 4.1."""
TAU = (2.455236432, 2.405097351, 0.021752025, 2.440387389, 2.416770843, 2.392975402, 0.021876111, 2.438807782)
"""The column tau_1 to tau_8 of Table 4.1, there in s."""

TIMES = ("retardation_times", "viscosities")
"""Readings of the column tau."""
COMPLIANCES = {"tensile": 3.0, "half_shear": 2.0}
"""Readings of the compliance D of the table, with J / D for the shear compliance J = 1/G."""


def table_4_1(times: str = "retardation_times") -> GeneralizedKelvin:
    r"""The compliance D of Table 4.1 in 1/Pa, with J0 = 1/E0 and J_i = 1/E_i.

    Parameters
    ----------
    times : str
        ``"retardation_times"``: the column is tau_i in s, as printed and as eq. 4.3.8 and Fig. 4.11 use it.
        ``"viscosities"``: it is C_i in MPa s, so that tau_i = C_i / E_i. The exponents printed in eq. 4.6.4 are the rates
        E_i / C_i of this reading.

    The constants were fitted to eight frequencies from 1 Hz to 36 Hz. That is 16 values for 17 constants, and six of the eight
    printed tau_i lie within 2.6 % of each other: only the curves are determined, not the constants.

    Raises
    ------
    UnknownName
        If ``times`` is none of ``TIMES``.

    Source: thesis section 4.5, Table 4.1; eqs. 4.3.6b, 4.3.8 and 4.6.4.
    """
    if times not in TIMES:
        raise UnknownName("reading of the times", times, TIMES)
    moduli, column = np.array(E), np.array(TAU)
    retardation = column / moduli if times == "viscosities" else column
    return GeneralizedKelvin(1 / (E0 * MEGAPASCAL), 1 / (moduli * MEGAPASCAL), retardation)


def atrial_shear_compliance(times: str = "retardation_times", compliance: str = "tensile") -> GeneralizedKelvin:
    r"""The shear compliance J = 1/G of atrial tissue in 1/Pa, incompressible.

    Parameters
    ----------
    times : str
        One of ``TIMES``; see ``table_4_1``.
    compliance : str
        ``"tensile"``: the table is D = 1/E, as the compression test it comes from measures; E = 3 G, so that J = 3 D.
        ``"half_shear"``: the table is 1/(2G), as eqs. 4.6.3 and 4.6.4 use it; J = 2 D, and displacements are 1.5 times smaller.

    Raises
    ------
    UnknownName
        If a reading is not known.

    Source: thesis section 4.5, Table 4.1; eqs. 4.2.21, 4.6.3 and 4.6.4.
    """
    if compliance not in COMPLIANCES:
        raise UnknownName("reading of the compliance", compliance, COMPLIANCES)
    return table_4_1(times).scaled(COMPLIANCES[compliance])
