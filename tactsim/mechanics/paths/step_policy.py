"""How long the steps of a history are: the settings that a case gives, and the rule that follows from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from tactsim.fem.paths.time_steps import TimeControl
from tactsim.interfaces import Material
from tactsim.model import FrozenModel
from tactsim.units import Positive, Time

if TYPE_CHECKING:
    from tactsim.mechanics.paths.history_path import TimeInterval

FIRST_SHARE = 1e-3
"""First step of a piece, as a part of its duration or of the shortest relaxation time."""
SMALLEST_SHARE = 1e-6
"""Smallest step, as a part of the first."""
RELAXING_GROWTH = 5.0
"""Most by which a step is longer than the one before while nothing prescribed changes: tissue relaxes smoothly over the decades
of time, where two steps from stop to stop, as 2 asks for, are no better than one. Usual are 1.5 to 5 (Hairer, Nørsett & Wanner
1993, doi:10.1007/978-3-540-78862-1, section II.4). Under loads that begin to grow, such steps would be taken back."""
SMALLEST_LOAD_STEP = 1e-3
"""Smallest load step of elastic tissue, as a part of the largest."""


class TimeSettings(FrozenModel):
    """Steps of time; the error of the stress at each step is estimated and kept below the tolerance."""

    tolerance: Annotated[float, Field(gt=0, le=0.1)] = 1e-3
    """Largest estimated error of the stress, relative to its root mean square over the volume."""
    first: Positive[Time] | None = None
    """First step of each piece; by default a thousandth of the shortest relaxation time or of the piece, whatever is shorter."""
    per_decade: Annotated[int, Field(ge=0, le=1000)] = 5
    """Times per decade of time since the beginning of each piece at which a step must end, so that plots are even."""
    earliest: Positive[Time] | None = None
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


def shortest_relaxation_time(materials: Sequence[Material]) -> float:
    """Shortest relaxation time of materials in s, infinite if none relaxes."""
    return min((min(m.relaxation.times) for m in materials if m.relaxation is not None), default=math.inf)


@dataclass(frozen=True)
class StepPolicy:
    """Steps of time with a controlled error, or equal load steps.

    Attributes
    ----------
    settings : of the case
    shortest_time : shortest relaxation time in s, infinite if nothing relaxes
    per_ramp, per_period : least number of steps of a ramp, and per period of a sine
    many_iterations : Newton iterations of a step, every augmentation counted, beyond which the next one is not longer
    sparing : for models whose steps cost minutes: load steps where nothing relaxes, short first steps after a sudden change only,
        and a sine counts by its periods alone
    """

    settings: TimeSettings
    shortest_time: float
    per_ramp: int
    per_period: int
    many_iterations: int = TimeControl.many_iterations
    sparing: bool = False

    def control(self, interval: TimeInterval) -> TimeControl:
        """How steps of an interval grow and shrink."""
        if self._by_load:
            largest = self.largest(interval)
            return TimeControl(1.0, first=largest, smallest=SMALLEST_LOAD_STEP * largest, many_iterations=self.many_iterations)
        resolved = interval.sudden or not self.sparing
        shortest = min(interval.duration, self.shortest_time) if resolved else interval.duration
        first = min(interval.duration, self.settings.first or FIRST_SHARE * shortest)
        return TimeControl(
            self.settings.tolerance,
            first=first,
            smallest=SMALLEST_SHARE * first,
            growth=TimeControl.growth if interval.changes else RELAXING_GROWTH,
            many_iterations=self.many_iterations,
        )

    def largest(self, interval: TimeInterval) -> float:
        """Longest step in s."""
        divided = interval.ramped if self.sparing else interval.changes
        by_ramp = interval.duration / (self.per_ramp if divided else 1)
        return min(by_ramp, interval.shortest_period / self.per_period)

    def stops(self, interval: TimeInterval) -> list[float]:
        """Times in s at which a step must end, the last one the end of the interval."""
        return [interval.end] if self._by_load else self.settings.stops(interval.start, interval.end)

    @property
    def _by_load(self) -> bool:
        """Whether the steps are load steps, of one size."""
        return self.sparing and math.isinf(self.shortest_time)
