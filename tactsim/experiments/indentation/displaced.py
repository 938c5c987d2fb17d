"""What an indentation without regard to time is given: the stop and the steps of its displacement."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, Self

from pydantic import model_validator

from tactsim.experiments.indentation.pressing import PressingSetup
from tactsim.experiments.indentation.setup import Displaced
from tactsim.fem.paths.loading import StepControl
from tactsim.fem.paths.progress import check_steps
from tactsim.model import FrozenModel
from tactsim.progress import Extent
from tactsim.units import Length, Positive, format_quantity

LEAST_STEP = 1e-9
"""First step over the displacement: Newton leaves 1e-10 of the forces, in which shorter ones drown."""

FIRST_STEP, LARGEST_STEP, SMALLEST_STEP = 1e-3, 0.05, 1e-4
"""First and largest step over the body's radius, smallest over the first.

Contact begins at a rim, at which longer first steps save nothing: `annulus_icf` takes 128 systems in 22 steps; with a first step
seven times as long 133 in 20, fifty times as long 119 in 19 after three that failed, all in the same time.
"""
FEW_ITERATIONS, MANY_ITERATIONS = 10, 15
"""Under a round tip: its contact spreads over new points in every step, so that Newton takes 7 to 10 iterations however short the
step is, and with the usual limits (7 and 12) steps of a ball stay an eighth of the largest."""


class StepSettings(FrozenModel):
    """Lengths of the load steps, as displacements of the body."""

    first: Positive[Length] | None = None
    """First step; by default a thousandth of the body's radius."""
    largest: Positive[Length] | None = None
    """Largest step; by default a twentieth of the body's radius."""
    smallest: Positive[Length] | None = None
    """The run fails when a step would have to be shorter; by default a ten-thousandth of the first step."""


class DisplacedSetup(PressingSetup):
    """A rigid body pressed into a specimen by a displacement, without regard to time."""

    stop: Literal["threshold", "displacement"] = "threshold"
    """Whether the run ends at the threshold, or goes on to the displacement with the inner sensor in contact."""
    displacement: Positive[Length]
    """Displacement of the body from first touch; the most that is tried when the run stops at the threshold."""
    steps: StepSettings = StepSettings()
    """Length of the load steps."""

    @property
    def extent(self) -> Extent:
        """What ends the run: the tissue's rise to the inner sensor, or the displacement."""
        if self.stop == "threshold" and self.recess is not None:
            return Extent("tissue_rise", self.recess)
        return Extent("displacement", self.displacement)

    @property
    def depth(self) -> float:
        """The displacement in m."""
        return self.displacement

    @property
    def prescribed(self) -> float:
        """The displacement in m."""
        return self.displacement

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.displacement >= self.specimen.thickness:
            given, most = (format_quantity(v, "m") for v in (self.displacement, self.specimen.thickness))
            raise ValueError(f"displacement: {given} must be smaller than the specimen's thickness {most}")
        if self.hole and self.recess is None:
            raise ValueError("a body with a hole needs the recess of its inner sensor, like recess: 0.8 mm")
        if not self.hole and self.stop == "threshold":
            raise ValueError(
                f"stop: only a body with a hole has a recess and a threshold; for a {self.body.kind} set stop: displacement"
            )
        for key, material in self.specimen.materials_by_key.items():
            if material.relaxation is not None:
                raise ValueError(
                    f"specimen.{key}: the material relaxes, which needs a history in time: kind: timed_indentation "
                    "(tactsim new timed_indentation writes a case of it)"
                )
        self._check_steps()
        return self

    def _check_steps(self) -> None:
        control, displacement = self.control(), self.displacement
        first, largest = control.first, control.largest
        if first < LEAST_STEP * displacement:
            given, least = format_quantity(first, "m"), format_quantity(LEAST_STEP * displacement, "m")
            raise ValueError(f"steps.first: {given} is lost in round-off; allowed: at least {least}, a billionth of the way")
        check_steps(displacement / largest, f"steps.largest {format_quantity(largest, 'm')}")

    def drive(self) -> Displaced:
        """Load steps to the displacement."""
        return Displaced(
            stops_at_touch=self.stop == "threshold",
            reached=f"{self.stop} reached",
            missed=f"the threshold was not reached within the displacement of {format_quantity(self.displacement, 'm')}; "
            "a larger displacement or a smaller recess may reach it",
            displacement=self.displacement,
            control=self.control(),
        )

    def control(self) -> StepControl:
        """Lengths of the load steps in m."""
        first = min(self.steps.first or FIRST_STEP * self.contact_radius, self.displacement)  # what follows is a part of it
        largest = self.steps.largest or LARGEST_STEP * self.contact_radius
        smallest = self.steps.smallest or SMALLEST_STEP * first
        control = StepControl(first=first, largest=max(largest, first), smallest=smallest, unit="m")
        if self.body.contact_shape.tip is None:
            return control
        return replace(control, few_iterations=FEW_ITERATIONS, many_iterations=MANY_ITERATIONS)
