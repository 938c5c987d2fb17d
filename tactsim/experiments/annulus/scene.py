"""What the map of annular sensors reports beside quantities and history."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from tactsim.analytic.force_factor import LARGEST_RATIO
from tactsim.model import FrozenModel
from tactsim.results.quantity import Coordinate
from tactsim.results.scene import Scene
from tactsim.units import Force, Length, Positive, Time

Ratio = Annotated[float, Field(gt=0, le=LARGEST_RATIO)]


class DesignPoint(FrozenModel):
    """A sensor and how it is pressed; by default the optimum of thesis section 4.7."""

    ratio: Ratio = 0.1
    """Inner over outer radius."""
    recess: Positive[Length] = 0.7e-3
    """Depth L of the small sensor."""
    force: Positive[Force] = 1.0
    """Constant force."""
    time: Positive[Time] = 0.5
    """Time since the force began."""


class AnnulusDesignScene(Scene):
    """The axes of the map and the limits that are drawn into it; lengths in m, times in s, forces in N."""

    kind: Literal["annulus_design"] = "annulus_design"
    ratios: tuple[float, ...]
    """Inner over outer radius."""
    recesses: tuple[float, ...]
    """Depths of the small sensor below the face."""
    times: tuple[float, ...]
    """Since the force began."""
    recommended_force: float
    """Force in N on heart tissue that should not be exceeded."""
    largest_force: float
    """Force in N on heart tissue that must not be exceeded."""
    design_point: DesignPoint
    """The sensor that is judged beside the map."""
    small_displacement: float
    """Displacement over the outer radius up to which linear theory is meant."""
    forces: tuple[float, ...] = ()
    """Constant forces of the map; empty in results of earlier versions."""

    def coordinates(self, quantity: str) -> dict[str, Coordinate]:
        """The axes of the map."""
        axes = {
            "ratio": (self.ratios, "1"),
            "recess": (self.recesses, "m"),
            "force": (self.forces, "N"),
            "time": (self.times, "s"),
        }
        return {name: Coordinate(name, values, unit) for name, (values, unit) in axes.items()}
