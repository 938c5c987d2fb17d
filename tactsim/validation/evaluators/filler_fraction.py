"""Volume fraction of the filler from thermogravimetric analysis."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.sensors.tunnelling import volume_fraction
from tactsim.units import Density, Mass
from tactsim.validation.evaluator import Evaluator, Inputs


class FillerFraction(Evaluator):
    """Volume fraction, or by ``by`` the fraction of the mass, the mass of the whole sample, or the volume of one part."""

    UNITS: ClassVar[dict[str, str]] = {
        "volume": "1",
        "mass": "1",
        "sample_mass": "kg",
        "filler_volume": "m^3",
        "matrix_volume": "m^3",
    }

    kind: Literal["filler_fraction"] = "filler_fraction"
    filler_mass: Mass = 4.2083e-6
    """What the furnace left."""
    matrix_mass: Mass = 16.9496e-6
    """What it burnt."""
    filler_density: Density = 560.0
    """Of carbon black."""
    matrix_density: Density = 910.0
    """Of polyethylene."""
    by: Literal["volume", "mass", "sample_mass", "filler_volume", "matrix_volume"] = "volume"
    """What is compared."""

    @property
    def found_unit(self) -> str:
        """The SI unit."""
        return self.UNITS[self.by]

    @classmethod
    def example(cls) -> Self:
        """Lingstat."""
        return cls()

    def found(self, inputs: Inputs) -> float:
        """In SI."""
        whole = self.filler_mass + self.matrix_mass
        parts = (self.filler_mass, self.filler_density), (self.matrix_mass, self.matrix_density)
        return {
            "volume": volume_fraction(*parts),
            "mass": self.filler_mass / whole,
            "sample_mass": whole,
            "filler_volume": self.filler_mass / self.filler_density,
            "matrix_volume": self.matrix_mass / self.matrix_density,
        }[self.by]
