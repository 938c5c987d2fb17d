"""Where strong ellipticity is lost in compression."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.errors import InputError
from tactsim.materials.library import named_material
from tactsim.validation.evaluator import Evaluator, Inputs


class EllipticityWindow(Evaluator):
    """Stretch at one end of the compression window in which a material set is not strongly elliptic."""

    kind: Literal["ellipticity_window"] = "ellipticity_window"
    material: str
    """Shipped set."""
    path: Literal["uniaxial", "planar"] = "uniaxial"
    """Loading path."""
    end: Literal["lower", "upper"]
    """Which end."""

    @classmethod
    def example(cls) -> Self:
        """The window of the soft elastomer."""
        return cls(material="icf_printed", end="lower")

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        from tactsim.materials.stability_range import stability_range

        windows = stability_range(named_material(self.material).material).paths[self.path].elliptic_lost
        compressed = [window for window in windows if window[1] < 1]
        if len(compressed) != 1:
            raise InputError(f"{self.material} loses strong ellipticity in {len(compressed)} windows of {self.path} compression")
        return compressed[0][0 if self.end == "lower" else 1]
