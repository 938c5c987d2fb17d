"""The fast model of chapter 5's probe: an elastic curve of finite elements, made to relax by quasi-linear superposition."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.quasi_linear import quasi_linear
from tactsim.array import Array
from tactsim.errors import InvalidQuantity


@dataclass(frozen=True, eq=False)
class ProbeCurve:
    """Elastic answer of the probe over depth, per m of width and per Pa of shear modulus: a geometry's, not a material's.

    ``depth`` (n,) in m from zero, increasing; ``force`` (n,) on the probe and ``switches`` (n, count) on each switch, both in m;
    ``contact_height`` (n,) in m, which the tissue reaches on the sides. Between the depths monotone cubics hold (PCHIP).
    """

    depth: Array
    force: Array
    contact_height: Array
    switches: Array

    @cached_property
    def _interpolated(self) -> scipy.interpolate.PchipInterpolator:
        """Made when it is first used: a module holds a curve, and scipy's interpolation takes a third of a second to load."""
        columns = np.column_stack([self.force, self.contact_height, self.switches])
        return scipy.interpolate.PchipInterpolator(self.depth, columns, extrapolate=False)

    def at(self, depth: Array) -> tuple[Array, Array, Array]:
        """Force (n,), contact height (n,) and switches (n, count) at depths (n,) in m.

        Raises
        ------
        InvalidQuantity
            If a depth is outside of the curve.
        """
        if not ((depth >= 0) & (depth <= self.depth[-1])).all():
            raise InvalidQuantity(
                f"depths of {depth.min():g} m to {depth.max():g} m; the curve holds from 0 to {self.depth[-1]:g} m"
            )
        columns = self._interpolated(depth)
        return columns[:, 0], columns[:, 1], columns[:, 2:]


@dataclass(frozen=True, eq=False)
class ProbeForces:
    """``force`` (n,) on the probe and ``switches`` (n, count) on its switches in N, and ``contact_height`` (n,) in m."""

    force: Array
    switches: Array
    contact_height: Array


def probe_forces(time: Array, depth: Array, *, curve: ProbeCurve, modulus: GeneralizedMaxwell, width: float) -> ProbeForces:
    """Forces on a probe ``width`` in m out of the plane at depths (n,) in m over ``time`` (n,) in s, by the shear ``modulus``.

    The contact opens where the superposed force would pull: there all forces are zero. Beside finite elements of the same tissue
    at 0.5 to 3 mm/s, the force on the probe is within 2 % down to 5 mm (0.7 % at 1 mm/s), that on a switch at the edge of the
    contact within 30 %.

    Raises
    ------
    InvalidQuantity
        If the times do not increase, or are not as many as the depths.
    """
    force, height, switches = curve.at(depth)
    elastic = modulus.instantaneous_modulus * width * np.column_stack([force, switches])
    relaxed = quasi_linear(time, elastic, modulus)
    pressed = relaxed[:, :1] > 0
    relaxed = np.where(pressed, np.maximum(relaxed, 0.0), 0.0)
    return ProbeForces(relaxed[:, 0], relaxed[:, 1:], np.where(pressed[:, 0], height, 0.0))
