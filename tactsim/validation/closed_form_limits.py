"""How far simulations of the annulus depart from the linear closed form as it is pressed deeper."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.errors import InputError
from tactsim.materials.any_material import AnyMaterial
from tactsim.units import FrozenModel, Length
from tactsim.validation.study import RunOutcome

Array = np.ndarray


class ComparedRun(FrozenModel):
    """A simulation of an annulus pressed into an elastic layer, and what a closed form must know of it."""

    run: str
    """Run of the study."""
    material: AnyMaterial
    """Material of the layer."""
    thickness: Annotated[Length, Field(gt=0)]
    """Thickness of the layer on its fixed base."""
    inner_radius: Annotated[Length, Field(gt=0)] = 1.5e-3
    """Inner radius of the annulus."""
    outer_radius: Annotated[Length, Field(gt=0)] = 3e-3
    """Outer radius of the annulus."""

    def depth(self, outcome: RunOutcome) -> Array:
        """Displacement over the outer radius at the accepted steps."""
        if not outcome.history:
            raise InputError(f"{self.run} has no history: {outcome.reason}")
        return np.array(outcome.history["displacement"]) / self.outer_radius

    def departure(self, outcome: RunOutcome, form: Literal["half_space", "layer"]) -> Array:
        """Force of the simulation over that of the closed form, minus one, at the accepted steps."""
        depth = self.depth(outcome)
        solved = solve_annular_punch(
            self.inner_radius / self.outer_radius,
            radius_over_thickness=self.outer_radius / self.thickness if form == "layer" else 0.0,
        )
        stiffness = 8 * self.material.shear_modulus * self.outer_radius**2 * solved.force_factor
        return np.array(outcome.history["reaction_force"]) / (stiffness * depth) - 1
