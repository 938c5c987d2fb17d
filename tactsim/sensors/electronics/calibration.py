"""Straight line between force and conductance of a piezoresistive sensor."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.registry import Named
from tactsim.units import Conductance, ConductancePerForce


class LinearCalibration(FrozenModel):
    r"""Line of a calibrated sensor, in force and in voltage.

    .. math:: C = m F + n, \qquad F = \frac{1}{(V^+/V_o - 1) R m} - \frac{n}{m}

    A conductance below the intercept gives a negative force, ``-n/m`` at zero: it is reported as it is, since a reader that cut
    it to zero would hide drift and a wrong line.

    Source: thesis, 2.2.1.
    """

    slope: Annotated[ConductancePerForce, Field(ge=1e-18, le=1e12)]
    """m, of any sensor with a wide margin."""
    intercept: Conductance = 0.0
    """n; the line is meant for forces at which the conductance is not negative."""

    def force(self, conductance: Array) -> Array:
        """Force in N for conductances in S of any shape.

        Raises
        ------
        InvalidQuantity
            If a conductance is not finite.
        """
        conductance = np.asarray(conductance, dtype=float)
        if not np.isfinite(conductance).all():
            raise InvalidQuantity(
                f"{np.count_nonzero(~np.isfinite(conductance))} of {conductance.size} conductances are not finite"
            )
        return (conductance - self.intercept) / self.slope

    def conductance(self, force: Array) -> Array:
        """Conductance in S for forces in N of any shape, 0 where the line is below zero.

        Raises
        ------
        InvalidQuantity
            If a force is negative or not finite.
        """
        force = np.asarray(force, dtype=float)
        good = np.isfinite(force) & (force >= 0)
        if not good.all():
            raise InvalidQuantity(
                f"{np.count_nonzero(~good)} of {force.size} forces are not usable, first {force[~good][0]:g} N; "
                "allowed: 0 or more, as the sensor only carries pressure"
            )
        return np.maximum(self.slope * force + self.intercept, 0.0)


MILLISIEMENS = 1e-3
THESIS_LINE = LinearCalibration(slope=MILLISIEMENS / 20.94, intercept=0.132 * MILLISIEMENS / 20.94)
"""F = 20.94 C - 0.132 in N with C in mS: the larger sensor of thesis section 3.1.2, Fig. 3.4.

It conducts 6.3 uS without force, where a film of infinite contact resistance conducts nothing.
"""
LIBRARY = {"thesis_line": THESIS_LINE}
"""Name -> shipped line."""
AnyCalibration = Annotated[LinearCalibration, Named("calibration", lambda: LIBRARY)]
"""A calibration in a model: the name of a shipped line, or its slope and intercept."""
