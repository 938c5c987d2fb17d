"""The pressure in the empty space of an inclusion over time: the pulse of the blood, or any history."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tactsim.analytic.histories import Harmonic, History, Segment
from tactsim.mechanics.paths.loading import Loading, pieces_of
from tactsim.model import FrozenModel
from tactsim.units import Frequency, NonNegative, Positive, Pressure, Time, format_quantity

MMHG = 133.322387415
"""Pressure in Pa of a millimetre of mercury (BIPM, SI brochure, 8th edition, table 8)."""
READINGS = {"absolute": (80 * MMHG, 120 * MMHG), "captions": (8 * MMHG, 12 * MMHG), "above_diastole": (0.0, 40 * MMHG)}
"""Diastolic and systolic pressure in Pa on the given geometry (thesis 6.5; captions of Fig. 6.5 and 6.6; erratum E14)."""


class PulsePressure(FrozenModel):
    r"""A pulse between a diastolic pressure d and a systolic one s, after a steady rise to d.

    .. math:: p(t) = d + \tfrac12 (s - d) (1 - \cos 2 \pi f (t - t_{rise})), \qquad t \ge t_{rise}

    Source: thesis, 6.5 (a pulse between 80 and 120 mmHg); its shape and rate are not printed.
    """

    kind: Literal["pulse"]
    reading: Literal["above_diastole", "absolute", "captions"] = "above_diastole"
    """What the given geometry bears: ``above_diastole`` 0 to 40 mmHg (it is the geometry at 80 mmHg), ``absolute`` 80 to 120 mmHg
    (it is stress-free), ``captions`` 8 to 12 mmHg (erratum E14)."""
    diastole: NonNegative[Pressure] | None = None
    """Least pressure, instead of the reading's."""
    systole: Positive[Pressure] | None = None
    """Largest pressure, instead of the reading's."""
    rate: Annotated[Frequency, Field(gt=0, le=1e3)] = 1.2
    """Beats per time; the default, 72 per minute, is a usual rate at rest (an assumption)."""
    beats: Annotated[int, Field(ge=1, le=1000)] | None = None
    """Number of beats, after which the diastolic pressure stays; by default they last until the end of the loading."""
    rise: Positive[Time] = 1.0
    """Time from the beginning to the first beat, in which the diastolic pressure is reached."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        least, most = self.limits
        if most <= least:
            systole, diastole = format_quantity(most, "Pa"), format_quantity(least, "Pa")
            raise ValueError(f"systole {systole} must be above diastole {diastole}, or nothing pulses")
        return self

    @property
    def limits(self) -> tuple[float, float]:
        """Diastolic and systolic pressure in Pa."""
        least, most = READINGS[self.reading]
        return least if self.diastole is None else self.diastole, most if self.systole is None else self.systole

    @property
    def duration(self) -> float:
        """Time in s to the end of the last beat, or to the end of the first if they go on."""
        return self.rise + (self.beats or 1) / self.rate

    def history(self, end: float) -> History:
        """The pressure in Pa, its beats up to ``end`` in s unless they are counted."""
        least, most = self.limits
        last = self.duration if self.beats is not None else max(end, self.duration)
        wave = Harmonic((most - least) / 2, 2 * math.pi * self.rate, -math.pi / 2)
        rise = Segment(0.0, self.rise, 0.0, least / self.rise)
        beating = Segment(self.rise, last, (least + most) / 2, 0.0, (wave,))
        return History((rise, beating) if self.beats is None else (rise, beating, Segment(last, math.inf, least)))


class PressureHistory(Loading):
    """Any pressure over time."""

    kind: Literal["history"]
    pieces: pieces_of(Pressure, "LumenPressure", __name__)  # type: ignore[valid-type]
    """Pressure over time, one piece after the other, from zero."""


AnyLumenPressure = Annotated[PulsePressure | PressureHistory, Field(discriminator="kind")]


def lumen_history(lumen: PulsePressure | PressureHistory, end: float) -> History:
    """The pressure in Pa over time, given the end of everything in s."""
    return lumen.history(end) if isinstance(lumen, PulsePressure) else lumen.history()
