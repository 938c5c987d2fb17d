"""Volume fraction of the filler from thermogravimetric analysis."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.sensors.tunnelling import volume_fraction
from tactsim.units import Density, Mass
from tactsim.validation.evaluator import Evaluator, Inputs


class FillerFraction(Evaluator):
    """Dimensionless volume fraction, or with ``by: mass`` the fraction of the mass."""

    kind: Literal["filler_fraction"] = "filler_fraction"
    filler_mass: Mass = 4.2083e-6
    """What the furnace left."""
    matrix_mass: Mass = 16.9496e-6
    """What it burnt."""
    filler_density: Density = 560.0
    """Of carbon black."""
    matrix_density: Density = 910.0
    """Of polyethylene."""
    by: Literal["volume", "mass"] = "volume"
    """What is compared."""

    @classmethod
    def example(cls) -> Self:
        """Lingstat."""
        return cls()

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        if self.by == "mass":
            return self.filler_mass / (self.filler_mass + self.matrix_mass)
        return volume_fraction((self.filler_mass, self.filler_density), (self.matrix_mass, self.matrix_density))
