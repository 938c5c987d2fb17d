"""The steps of a grasp, each of which takes minutes: few, unless a material relaxes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from tactsim.interfaces import Material
from tactsim.mechanics.paths.step_policy import StepPolicy, TimeSettings, shortest_relaxation_time
from tactsim.units import Positive, Time

MANY_ITERATIONS = 60
"""Newton iterations of a step, those of every augmentation together, beyond which the next one is not longer."""


class GraspTimeSettings(TimeSettings):
    """Steps of time: load steps of elastic tissue, controlled by their error if a material relaxes."""

    steps: Annotated[int, Field(ge=1, le=1000)] = 2
    """Load steps of a ramp, at least."""
    per_period: Annotated[int, Field(ge=4, le=1000)] = 8
    """Steps per period of a sine or pulse, at least."""
    tolerance: Annotated[float, Field(gt=0, le=0.1)] = 5e-3
    """Largest estimated error of the stress of materials that relax, relative to its root mean square over the volume."""
    first: Positive[Time] | None = None
    """First step of each piece if a material relaxes; by default a thousandth of the piece, and after a sudden change of the
    shortest relaxation time if that is shorter."""
    per_decade: Annotated[int, Field(ge=0, le=1000)] = 0
    """Times per decade of time at which a step must end if a material relaxes."""

    def policy(self, materials: Sequence[Material]) -> StepPolicy:
        """Lengths of the steps of a block of materials."""
        return StepPolicy(
            self,
            shortest_relaxation_time(materials),
            per_ramp=self.steps,
            per_period=self.per_period,
            many_iterations=MANY_ITERATIONS,
            sparing=True,
        )
