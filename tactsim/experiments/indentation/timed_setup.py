"""What a timed indentation is given beside the contact: the history, the steps of time, and what it is compared with."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tactsim.experiments.indentation.contact_setup import ContactSetup
from tactsim.mechanics.loading import AnyLoading
from tactsim.units import FrozenModel, Length, Time, format_quantity

LOAD_STEPS = 20
"""Least number of steps of a ramp, and per period of a sine."""
FIRST_SHARE = 1e-3
"""First step of a piece, as a part of its duration or of the shortest relaxation time."""
SMALLEST_SHARE = 1e-6
"""Smallest step, as a part of the first."""


class TimeSettings(FrozenModel):
    """Steps of time; the error of the stress at each step is estimated and kept below the tolerance."""

    tolerance: Annotated[float, Field(gt=0, le=0.1)] = 1e-3
    """Largest estimated error of the stress, relative to its root mean square over the volume."""
    first: Annotated[Time, Field(gt=0)] | None = None
    """First step of each piece; by default a thousandth of the shortest relaxation time or of the piece, whatever is shorter."""
    per_decade: Annotated[int, Field(ge=0, le=1000)] = 5
    """Times per decade of time since the beginning of each piece at which a step must end, so that plots are even."""
    earliest: Annotated[Time, Field(gt=0)] | None = None
    """First of these times, and from where on a closed form is compared with; by default a millionth of the piece, or 1 us if
    that is later."""

    def stops(self, start: float, end: float) -> list[float]:
        """Times in s at which a step of the piece from ``start`` to ``end`` must end."""
        duration = end - start
        first = self.earliest or max(1e-6 * duration, 1e-6)
        if self.per_decade == 0 or first >= duration:
            return [end]
        decades = math.log10(duration / first)
        count = int(decades * self.per_decade)
        return [*(start + duration * 10 ** (k / self.per_decade) for k in range(-count, 0)), end]


class TimedIndentationSetup(ContactSetup):
    """A rigid body pressed into tissue by a history of force or displacement."""

    loading: AnyLoading
    """The prescribed history."""
    stop: Literal["end", "touch"] = "end"
    """Whether the run goes on to the end of the history or stops when the tissue touches the inner sensor."""
    deepest: Annotated[Length, Field(gt=0)] | None = None
    """Displacement that the mesh must serve; by default the largest prescribed one, or a tenth of the body's radius."""
    time: TimeSettings = TimeSettings()
    """Steps of time."""
    compare: Literal["half_space", "layer"] | None = None
    """Closed form to compare with: the annulus or punch on a half-space, or on a layer as thick as the specimen."""

    @property
    def depth(self) -> float:
        """Displacement in m that the mesh must serve."""
        if self.deepest is not None:
            return self.deepest
        return self.prescribed or 0.1 * self.contact_radius

    @property
    def prescribed(self) -> float | None:
        """Largest displacement in m that is prescribed; None if a force is."""
        return max(0.0, self.loading.least_and_most()[1]) if self.loading.control == "displacement" else None

    @property
    def shortest_time(self) -> float:
        """Shortest relaxation time of the materials in s, infinite if none relaxes."""
        series = [m.relaxation.times for m in self.specimen.materials if m.relaxation is not None]
        return min((min(times) for times in series), default=math.inf)

    def first_step(self, duration: float) -> float:
        """First step in s of a piece of this duration."""
        return min(duration, self.time.first or FIRST_SHARE * min(duration, self.shortest_time))

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        least, most = self.loading.least_and_most()
        if self.loading.control == "force" and least <= 0:
            raise ValueError(
                f"the force falls to {format_quantity(least, 'N')}: it must press all the time, or the contact opens and no "
                "displacement answers it; preload more (at least 1.5 times the amplitude of a sine)"
            )
        if self.loading.control == "displacement" and most <= 0:
            raise ValueError("the displacement never becomes positive: nothing is pressed; positive is into the tissue")
        if self.loading.control == "displacement" and most >= self.specimen.thickness:
            given, thickness = format_quantity(most, "m"), format_quantity(self.specimen.thickness, "m")
            raise ValueError(f"displacement {given} must be smaller than the specimen's thickness {thickness}")
        if self.stop == "touch" and self.recess is None:
            raise ValueError("stop: touch needs the recess of the inner sensor, like recess: 0.8 mm")
        if self.compare is not None:
            self._check_comparable()
        return self

    def _check_comparable(self) -> None:
        if self.body.kind not in ("annulus", "punch"):
            raise ValueError(f"a closed form exists for an annulus or a punch, not for a {self.body.kind}")
        if len(self.specimen.materials) > 1 or self.specimen.surface != "flat":
            raise ValueError("a closed form exists for one material and a flat surface")
        if self.specimen.material.bulk_modulus is not None:
            raise ValueError("the closed form is that of incompressible tissue; set bulk_modulus: null")
