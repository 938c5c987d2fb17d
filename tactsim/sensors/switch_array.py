"""The switch array of chapter 5: five switches on the sides of a probe that say when its one force sensor counts."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Force, Length, NonNegative, Positive, format_quantity

Formula = Literal["corrected", "as_printed"]
MARGIN = 2.0
"""Fall of the force that ends the loading, over the threshold of a touch: the largest of many noisy samples is too high."""


class SwitchArray(FrozenModel):
    """Places and thresholds of the switches, and the mean rate of a touch.

    Source: thesis, sections 5.1 and 5.2, Fig. 5.4.
    """

    count: Annotated[int, Field(ge=1, le=50)] = 5
    """Number of switches."""
    pitch: Positive[Length] = 1e-3
    """Height between two switches along the probe's axis; switch i lies i times that above the face."""
    strip: Positive[Length] = 0.2e-3
    """Height that a switch covers, centred on its own; not printed."""
    touch_threshold: NonNegative[Force] = 0.0
    """A touch begins with the first sample whose force is above; zero in the thesis."""
    release_threshold: NonNegative[Force] | None = None
    """It ends with the first sample whose force is not above this; by default half the threshold of the touch."""
    switch_threshold: NonNegative[Force] = 0.0
    """A switch counts as closed above this force on it."""
    fall: NonNegative[Force] = 0.0
    """How far the force may be below its largest of the touch and still count as loading."""
    formula: Formula = "corrected"
    """Mean rate by the sum of the intervals (E11), or by the sum of the times as eq. 5.2.2 prints."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.strip > self.pitch:
            strip, pitch = format_quantity(self.strip, "m"), format_quantity(self.pitch, "m")
            raise ValueError(f"strip {strip} is longer than the pitch {pitch}: switches would overlap; take at most the pitch")
        if self.release_threshold is not None and self.release_threshold > self.touch_threshold:
            given, most = format_quantity(self.release_threshold, "N"), format_quantity(self.touch_threshold, "N")
            raise ValueError(f"release_threshold {given} is above touch_threshold {most}: a touch would end as it begins")
        return self

    def above_noise(self, force_noise: float, switch_noise: float, *, times: float) -> Self:
        """The array with thresholds of ``times`` the root mean square noise in N of the force sensor and of the switches."""
        touch = times * force_noise
        thresholds = {"touch_threshold": touch, "switch_threshold": times * switch_noise, "fall": MARGIN * touch}
        return self.model_copy(update={**thresholds, "release_threshold": None})

    @property
    def release(self) -> float:
        """Force in N at or below which a touch ends."""
        return self.touch_threshold / 2 if self.release_threshold is None else self.release_threshold

    @property
    def heights(self) -> Array:
        """Heights (count,) in m of the switches above the face, from the face on."""
        return self.pitch * np.arange(1, self.count + 1)

    @property
    def sides(self) -> tuple[Literal["right", "left"], ...]:
        """Side of each switch: the first, third and fifth on the right, the others on the left."""
        return tuple("right" if number % 2 == 0 else "left" for number in range(self.count))

    @property
    def travel(self) -> float:
        """Depth in m at which the last switch closes if the tissue follows the sides: 5 mm."""
        return self.pitch * self.count

    def mean_rate(self, start: float, times: Array) -> float:
        r"""Mean rate in m/s of a touch that began at ``start`` and closed the switches at ``times`` (count,) in s.

        .. math:: \bar V = \frac{h}{\sum_i \delta T_i}, \qquad \delta T_i = T_i - T_{i-1}, \quad T_0 = 0

        with h = 5 mm and all times counted from the touch; ``as_printed`` divides by the sum of the T_i (E11).

        Raises
        ------
        InvalidQuantity
            If a switch is missing or the last did not close after the touch began.

        Source: thesis, eq. 5.2.1 and 5.2.2.
        """
        since = np.asarray(times, float) - start
        if since.shape != (self.count,):
            raise InvalidQuantity(f"{since.size} switching times; a mean rate needs those of all {self.count} switches")
        total = float(since.max() if self.formula == "corrected" else since.sum())
        if not total > 0:
            raise InvalidQuantity(f"the last switch closed {total:g} s after the touch began; allowed: later than it")
        return self.travel / total


def rising(signals: Array, threshold: float, before: Array) -> Array:
    """Where the shift register takes a sample: greater than the threshold and than the sample before.

    ``signals`` (time, ...) in N, ``before`` (...) the sample before the first; infinite if there is none.

    Source: thesis, section 5.2.
    """
    earlier = np.concatenate([before[None], signals[:-1]])
    return (signals > threshold) & (signals > earlier)
