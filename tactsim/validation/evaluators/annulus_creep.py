"""The annular sensor on atrial tissue under a constant force."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.units import Force, Length, Time
from tactsim.validation.evaluator import Evaluator, Inputs

UNITS = {"displacement": "m", "rise": "m", "time_to_touch": "s", "force_to_touch": "N", "displacement_over_radius": "1"}


class AnnulusCreep(Evaluator):
    """Displacement of the annulus or rise of the tissue in its hole in m, or the time in s or force in N at which it touches."""

    kind: Literal["annulus_creep"] = "annulus_creep"
    quantity: Literal["displacement", "rise", "time_to_touch", "force_to_touch", "displacement_over_radius"]
    """What is asked for."""
    radius_ratio: Annotated[float, Field(gt=0, le=0.99)] = 0.1
    """Inner over outer radius."""
    outer_radius: Annotated[Length, Field(gt=0)] = 3e-3
    """Radius of the face."""
    recess: Annotated[Length, Field(gt=0)] = 0.7e-3
    """Depth of the small sensor."""
    force: Annotated[Force, Field(gt=0)] = 1.0
    """Constant force."""
    time: Annotated[Time, Field(ge=0)] = 0.5
    """Time since the force began."""
    times: Literal["retardation_times", "viscosities"] = "viscosities"
    """Reading of the column of times of Table 4.1."""
    compliance: Literal["tensile", "half_shear"] = "half_shear"
    """Reading of its compliance."""
    formula: Literal["exact", "thesis_4_2_21", "small_hole_series", "smythe"] = "exact"
    """Formula of the force factor."""

    @classmethod
    def example(cls) -> Self:
        """The design point of section 4.7."""
        return cls(quantity="displacement")

    @property
    def found_unit(self) -> str:
        """m, s, N or 1."""
        return UNITS[self.quantity]

    def found(self, inputs: Inputs) -> float:
        """In m, s, N or 1."""
        tissue = atrial_shear_compliance(self.times, self.compliance)
        annulus = ViscoelasticAnnulus(self.outer_radius, self.radius_ratio, tissue, self.formula)
        if self.quantity == "time_to_touch":
            return float(annulus.time_to_touch(self.recess, self.force))
        if self.quantity == "force_to_touch":
            return float(annulus.force_to_touch(self.recess, self.time))
        displacement = float(annulus.creep_displacement(self.force, self.time))
        if self.quantity == "displacement_over_radius":
            return displacement / self.outer_radius
        return displacement if self.quantity == "displacement" else float(annulus.rise(displacement))
