"""Force over depth of an indentor in one shape of energy, to be scaled by the modulus."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from tactsim.analytic.durometer import DurometerScale
from tactsim.array import Array
from tactsim.errors import InputError, InvalidQuantity
from tactsim.results.result import Result
from tactsim.units import format_quantity


@dataclass(frozen=True)
class ForceDepthCurve:
    r"""Force of an incompressible material whose energy is a modulus times a fixed function of the deformation.

    .. math:: F(d) = E\, f(d)

    Shape, specimen, indentor and friction fix f. ``depth`` (n,) in m increases, ``force_per_modulus`` (n,) in m^2 is f there.

    Source: scaling: a factor of the energy is one of every stress at the same deformation, which stays in equilibrium.
    """

    depth: Array
    force_per_modulus: Array

    @classmethod
    def of(cls, result: Result, youngs_modulus: float) -> ForceDepthCurve:
        """The curve of a durometer run on a material of this small-strain Young's modulus in Pa.

        Raises
        ------
        InputError
            If the run accepted too few steps to make a curve.
        """
        if len(result.steps) < 2:
            raise InputError(f"no curve from {len(result.steps)} accepted steps of the durometer: {result.reason}")
        depth = [0.0, *(step.values["displacement"] for step in result.steps)]
        force = [0.0, *(step.values["reaction_force"] for step in result.steps)]
        return cls(np.array(depth), np.array(force) / youngs_modulus)

    @property
    def deepest(self) -> float:
        """Depth in m at which the curve ends."""
        return float(self.depth[-1])

    @cached_property
    def _interpolated(self) -> scipy.interpolate.PchipInterpolator:
        return scipy.interpolate.PchipInterpolator(self.depth, self.force_per_modulus)

    def force(self, depth: float, youngs_modulus: float) -> float:
        """Force in N at a depth in m on the curve."""
        return youngs_modulus * float(self._interpolated(min(depth, self.deepest)))

    def reading(self, youngs_modulus: float, scale: DurometerScale) -> float | None:
        """Reading on a material of this Young's modulus in Pa; None where the indentor bottoms out.

        Raises
        ------
        InputError
            If the curve ends before the reading.
        """

        def surplus(depth: float) -> float:
            return self.force(depth, youngs_modulus) - float(scale.spring_force(depth))

        end = min(self.deepest, scale.travel)
        if surplus(end) >= 0:
            return float(scale.reading(scipy.optimize.brentq(surplus, 0.0, end, xtol=1e-12 * end)))
        if end < scale.travel * (1 - 1e-9):
            at, modulus = format_quantity(end, "m"), format_quantity(youngs_modulus, "Pa")
            raise InputError(f"the force-depth curve ends at {at}, before the reading of a modulus of {modulus}")
        return None

    def modulus(self, reading: float, scale: DurometerScale) -> float:
        """Young's modulus in Pa that the reading means.

        Raises
        ------
        InvalidQuantity
            If the reading is not in [0, 100), or deeper than the curve.
        """
        depth = float(scale.depth(scale.checked_reading(reading)))
        if depth > self.deepest * (1 + 1e-9):
            end = format_quantity(self.deepest, "m")
            raise InvalidQuantity(f"a reading of {reading:g} is {format_quantity(depth, 'm')} deep; the curve ends at {end}")
        return float(scale.spring_force(depth)) / self.force(depth, 1.0)
