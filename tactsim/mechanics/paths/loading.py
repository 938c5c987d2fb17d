"""Prescribed histories of force or displacement in a case file: pieces one after the other."""

from __future__ import annotations

import functools
import itertools
import math
import operator
import sys
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PlainValidator, ValidationError, create_model, model_validator

from tactsim.analytic.histories import Harmonic, History, Segment
from tactsim.errors import Refused
from tactsim.model import FrozenModel
from tactsim.refusals import refusals_of
from tactsim.units import Force, Frequency, Length, Positive, Time, format_quantity, written

MOST_PERIODS = 10_000
"""Periods of a wave: with the fewest steps of a period, four, nearly as many steps as a path may have (``fem.progress``)."""


def check_periods(frequency: float, duration: float) -> None:
    """Refuse a wave of a frequency in Hz that has too many periods in a duration in s.

    Raises
    ------
    ValueError
        With their number and what is allowed.
    """
    if not frequency * duration <= MOST_PERIODS:
        given, long = format_quantity(frequency, "Hz"), format_quantity(duration, "s")
        raise ValueError(
            f"frequency {given} over {long} makes {frequency * duration:.3g} periods; allowed: up to {MOST_PERIODS}; "
            "take a lower frequency or a shorter duration"
        )


Value = Annotated[float, PlainValidator(written)]
"""A number in SI, or a quantity as text: of which dimension, the loading knows that the piece is put into."""


class Piece(FrozenModel):
    """A part of a history: the loading that it is put into makes displacements or forces of the values in it."""

    def last(self, segment: Segment) -> float:
        """The value at its end, where its last ``segment`` is up to round-off."""
        return segment.at(segment.end)


class Hold(Piece):
    """The present value, held."""

    kind: Literal["hold"] = "hold"
    duration: Positive[Time]
    """How long."""

    def segments(self, start: float, value: float) -> tuple[Segment, ...]:
        """From ``start`` in s and the value before."""
        return (Segment(start, start + self.duration, value),)


class Jump(Piece):
    """A sudden change to a value, then held."""

    kind: Literal["jump"]
    to: Value
    """The new value."""
    duration: Positive[Time]
    """How long it is held."""

    def segments(self, start: float, value: float) -> tuple[Segment, ...]:
        """From ``start`` in s, whatever the value before."""
        return (Segment(start, start + self.duration, self.to),)


class Ramp(Piece):
    """A change at a constant rate."""

    kind: Literal["ramp"]
    to: Value
    """The value at the end."""
    duration: Positive[Time]
    """How long it takes."""

    def segments(self, start: float, value: float) -> tuple[Segment, ...]:
        """From ``start`` in s and the value before."""
        slope = (self.to - value) / self.duration
        return (Segment(start, start + self.duration, value, slope),)

    def last(self, segment: Segment) -> float:
        """The value itself: a force that is taken back to zero is not below it by round-off."""
        return self.to


class Sine(Piece):
    """A sine about the present value."""

    kind: Literal["sine"]
    amplitude: Value
    """Amplitude."""
    frequency: Positive[Frequency]
    """Frequency."""
    duration: Positive[Time]
    """How long."""

    @model_validator(mode="after")
    def _countable(self) -> Self:
        check_periods(self.frequency, self.duration)
        return self

    def segments(self, start: float, value: float) -> tuple[Segment, ...]:
        """From ``start`` in s and the value before."""
        wave = Harmonic(float(self.amplitude), 2 * math.pi * self.frequency)
        return (Segment(start, start + self.duration, value, 0.0, (wave,)),)


class Samples(Piece):
    """Measured values, linear between them; times count from the beginning of the piece."""

    kind: Literal["samples"]
    times: Annotated[tuple[Time, ...], Field(min_length=2)]
    """Times, increasing from zero."""
    values: tuple[Value, ...]
    """One value for each time; a first one other than the present value is a jump."""

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        if len(self.times) != len(self.values):
            raise ValueError(f"{len(self.times)} times and {len(self.values)} values; each time needs its value")
        if self.times[0] != 0 or any(b <= a for a, b in itertools.pairwise(self.times)):
            raise ValueError("the times must begin at zero and increase")
        return self

    @property
    def duration(self) -> float:
        """How long it takes, in s."""
        return self.times[-1]

    def segments(self, start: float, value: float) -> tuple[Segment, ...]:
        """From ``start`` in s, whatever the value before."""
        pairs = list(zip(self.times, self.values, strict=True))
        return tuple(
            Segment(start + t0, start + t1, float(v0), float(v1 - v0) / (t1 - t0))
            for (t0, v0), (t1, v1) in itertools.pairwise(pairs)
        )

    def last(self, segment: Segment) -> float:
        """The last of the values."""
        return self.values[-1]


class Loading(FrozenModel):
    """Pieces one after the other, from zero at the beginning."""

    pieces: Any

    @model_validator(mode="after")
    def _something(self) -> Self:
        if not self.pieces:
            raise ValueError("a history needs at least one piece")
        return self

    @property
    def duration(self) -> float:
        """Whole duration in s."""
        return float(sum(piece.duration for piece in self.pieces))

    def segments(self) -> tuple[Segment, ...]:
        """The pieces as smooth segments of time, without what follows the last."""
        return tuple(segment for segments, _ in self._course() for segment in segments)

    def history(self) -> History:
        """The prescribed history; its last value is held."""
        return History(self.segments())

    def least_and_most(self) -> tuple[float, float]:
        """Bounds of the values after the beginning: those at the ends of each piece, and a sine's least and most."""
        ends = [value for segments, last in self._course() for value in (*(s.at(s.start) for s in segments), last)]
        waves = [s.value + sign * wave.amplitude for s in self.segments() for wave in s.harmonics for sign in (-1, 1)]
        return min([*ends[1:], *waves]), max([*ends, *waves])

    @property
    def largest_displacement(self) -> float | None:
        """Largest displacement in m that is prescribed, 0 if all are negative; None if a force is."""
        return None

    def _course(self) -> Iterator[tuple[tuple[Segment, ...], float]]:
        """The segments of each piece and the value at its end."""
        start, value = 0.0, 0.0
        for piece in self.pieces:
            segments = piece.segments(start, value)
            start, value = segments[-1].end, piece.last(segments[-1])
            yield segments, value


def pieces_of(quantity: Any, name: str, module: str) -> Any:
    """Type of a tuple of pieces whose values are of this quantity; they stand as ``nameRamp`` ... in ``module``, for pickle."""
    dimensional = [_of_quantity(cls, quantity, name, module) for cls in DIMENSIONLESS]
    kinds: Any = functools.reduce(operator.or_, dimensional, Hold)
    return tuple[Annotated[kinds, Field(discriminator="kind"), BeforeValidator(_as_mapping)], ...]


DIMENSIONLESS: tuple[type[Piece], ...] = (Jump, Ramp, Sine, Samples)
"""Pieces whose values have no dimension yet."""


def _as_mapping(piece: Any) -> Any:
    """A piece without a dimension as the mapping that a case file has in its place."""
    return dict(piece) if type(piece) in DIMENSIONLESS else piece


def _of_quantity(cls: type[FrozenModel], quantity: Any, name: str, module: str) -> type[FrozenModel]:
    """The piece with its values replaced by the quantity."""
    fields: dict[str, Any] = {
        key: (quantity, ...) for key, field in cls.model_fields.items() if PlainValidator(written) in field.metadata
    }
    fields |= {
        key: (tuple[quantity, ...], ...) for key, field in cls.model_fields.items() if field.annotation == tuple[Value, ...]
    }
    made = create_model(f"{name}{cls.__name__}", __base__=cls, __module__=module, **fields)
    made.__doc__ = vars(cls)["__doc__"]
    setattr(sys.modules[module], made.__name__, made)
    return made


class ForceLoading(Loading):
    """The body presses with a prescribed force; its displacement follows."""

    control: Literal["force"]
    pieces: pieces_of(Force, "Force", __name__)  # type: ignore[valid-type]
    """Force over time, one piece after the other, from zero; it presses from the first moment on."""


class DisplacementLoading(Loading):
    """The body is displaced as prescribed, counted from first touch; the force follows."""

    control: Literal["displacement"]
    pieces: pieces_of(Length, "Displacement", __name__)  # type: ignore[valid-type]
    """Displacement over time, one piece after the other, from zero."""

    @property
    def largest_displacement(self) -> float:
        """Largest displacement in m that is prescribed, 0 if all are negative."""
        return max(0.0, self.least_and_most()[1])


AnyLoading = Annotated[ForceLoading | DisplacementLoading, Field(discriminator="control")]


def close(to: Any, duration: Any, *, hold: Any = None) -> DisplacementLoading:
    """A ramp to a displacement within a duration, held for another one if that is given.

    >>> import tactsim as ts
    >>> ts.close(to="1 mm", duration="1 s", hold="4 s").duration  # s
    5.0

    Raises
    ------
    CaseError
        If a value is not a length or a time, or a duration is not positive; the message names the argument.
    """
    pieces = [{"kind": "ramp", "to": to, "duration": duration}, *([] if hold is None else [{"kind": "hold", "duration": hold}])]
    value = {"control": "displacement", "pieces": pieces}
    try:
        return DisplacementLoading.model_validate(value)
    except ValidationError as error:
        refusals = refusals_of(error, written(value), DisplacementLoading)
        lines = [f"close: {_argument(path)}: {message}" for path, message in refusals.items()]
        raise Refused("\n".join(lines), error) from None


def _argument(path: tuple[str | int, ...]) -> str:
    """The argument of ``close`` that a key path within the loading comes from."""
    return "hold" if path[1:2] == (1,) else str(path[-1])
