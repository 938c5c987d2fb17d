"""The stresses that the thesis derives from a harmonic potential, held against equilibrium: eqs. 4.2.4 to 4.2.7."""

from __future__ import annotations

from typing import Literal

import numpy as np

from tactsim.interfaces import quantity

Printing = Literal["corrected", "as_printed"]
DIRECTION = 0.6
"""Share of x in the wave of the potential: in any direction but those of the axes d/dx differs from d/dy."""
DEPTHS = np.linspace(0.1, 3.0, 30)
PLACES = np.linspace(-2.0, 2.0, 21)


@quantity(unit="1")
def equilibrium_residual(form: Printing = "corrected") -> float:
    r"""Largest force per volume that the stresses leave in z, over the largest gradient of :math:`\sigma_{zz}`.

    The potential is :math:`\varphi = e^{-z} \cos ax \cos by` with :math:`a^2 + b^2 = 1`, which is harmonic, and whose derivatives
    are exact. Corrected (E20), :math:`\sigma_{zz} = -\varphi_{zz} + z \varphi_{zzz}` and :math:`\sigma_{yz} = z \varphi_{yzz}`;
    as printed, the second term has the other sign and the last derivative is taken along x.

    Parameters
    ----------
    form : corrected or as printed

    Source: A. E. Green and W. Zerna, Theoretical Elasticity, 1968, section 5.7; thesis, eq. 4.2.7.
    """
    a, b = DIRECTION, np.sqrt(1 - DIRECTION**2)
    z, x, y = np.meshgrid(DEPTHS, PLACES, PLACES, indexing="ij")
    phi = np.exp(-z) * np.cos(a * x) * np.cos(b * y)
    mixed = np.exp(-z) * a * b * np.sin(a * x) * np.sin(b * y)
    sign = 1.0 if form == "corrected" else -1.0
    normal = phi - sign * (phi - z * phi)  # d/dz of -phi_zz + sign z phi_zzz, each d/dz being a factor of -1
    along_x = -(a**2) * z * phi
    along_y = -(b**2) * z * phi if form == "corrected" else z * mixed
    return float(np.abs(along_x + along_y + normal).max() / np.abs(normal).max())
