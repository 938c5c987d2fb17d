"""Input histories: piecewise linear and harmonic functions of time, zero before t = 0, with jumps between their pieces."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.spectrum import checked_instants, checked_number, read_only, real_array
from tactsim.array import Array
from tactsim.errors import InvalidQuantity, shown


@dataclass(frozen=True)
class Harmonic:
    """amplitude * sin(angular_frequency * (t - start) + phase), with the start of its segment; rad/s >= 0 and rad.

    Raises
    ------
    InvalidQuantity
        If a number is not finite or the angular frequency is negative.
    """

    amplitude: float
    angular_frequency: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (self.amplitude, self.angular_frequency, self.phase))) or self.angular_frequency < 0:
            raise InvalidQuantity(f"harmonic is {shown(self)}; allowed: finite numbers, angular_frequency >= 0")


@dataclass(frozen=True)
class Segment:
    r"""A piece of a history on [start, end).

    .. math:: f(t) = value + slope\,(t - start) + \sum_m A_m \sin(\omega_m (t - start) + \theta_m)

    Parameters
    ----------
    start, end : float
        In s, ``end > start >= 0``; ``end`` may be infinite.
    value, slope : float
        In the unit of the input, and per s.
    harmonics : tuple of Harmonic

    Raises
    ------
    InvalidQuantity
        If a number is out of its range.
    """

    start: float
    end: float
    value: float
    slope: float = 0.0
    harmonics: tuple[Harmonic, ...] = ()

    def __post_init__(self) -> None:
        if not (math.isfinite(self.start) and 0 <= self.start < self.end):
            raise InvalidQuantity(f"segment is [{self.start}, {self.end}) s; allowed: 0 <= start < end, start finite")
        if not (math.isfinite(self.value) and math.isfinite(self.slope)):
            raise InvalidQuantity(f"segment has value {self.value} and slope {self.slope}; allowed: finite numbers")

    def at(self, t: float) -> float:
        """f(t) at a time in s, also outside of [start, end)."""
        elapsed = t - self.start
        waves = sum(h.amplitude * math.sin(h.angular_frequency * elapsed + h.phase) for h in self.harmonics)
        return self.value + self.slope * elapsed + waves

    def part(self, start: float, end: float) -> Segment:
        """The same function on [start, end), both in s.

        Raises
        ------
        InvalidQuantity
            If ``start`` is negative, not finite or not before ``end``.
        """
        if (start, end) == (self.start, self.end):
            return self
        shift = start - self.start
        moved = (Harmonic(h.amplitude, h.angular_frequency, h.phase + h.angular_frequency * shift) for h in self.harmonics)
        return Segment(start, end, self.value + self.slope * shift, self.slope, tuple(moved))


@dataclass(frozen=True, eq=False)
class Pieces:
    """Segments as arrays: ``values`` (m,), ``slopes`` (m,) per second, and of the waves ``amplitudes`` (k, m),
    ``angular_frequencies`` (k, m) in rad/s and ``phases`` (k, m) in rad."""

    values: Array
    slopes: Array
    amplitudes: Array
    angular_frequencies: Array
    phases: Array

    @classmethod
    def of(cls, segments: tuple[Segment, ...]) -> Self:
        """The arrays of ``segments``; k is their largest number of harmonics, the others have the amplitude zero."""
        waves = np.zeros((3, max(len(segment.harmonics) for segment in segments), len(segments)))
        if waves.size:
            for i, segment in enumerate(segments):
                for j, wave in enumerate(segment.harmonics):
                    waves[:, j, i] = wave.amplitude, wave.angular_frequency, wave.phase
        linear = np.array([(segment.value, segment.slope) for segment in segments]).T.copy()
        return cls(read_only(linear)[0], linear[1], *read_only(waves))

    def taken(self, index: Array | slice) -> Self:
        """The pieces with the given indices (n,)."""
        waves = (array[:, index] for array in (self.amplitudes, self.angular_frequencies, self.phases))
        return type(self)(self.values[index], self.slopes[index], *waves)

    def at(self, elapsed: Array) -> Array:
        """f of every piece at its own time ``elapsed`` in s since its start, shape (m,)."""
        waves = self.amplitudes * np.sin(self.angular_frequencies * elapsed + self.phases)
        return self.values + self.slopes * elapsed + waves.sum(axis=0)


@dataclass(frozen=True, eq=False)
class History:
    """An input as a function of time, zero for t < 0.

    Parameters
    ----------
    segments : sequence of Segment
        Contiguous, the first from t = 0; the input may jump between two. If the last end is finite, its value is held afterwards.

    Attributes
    ----------
    starts : array
        Starts of the segments in s, shape (m,), read-only.
    pieces : Pieces
        The segments as arrays.

    Raises
    ------
    InvalidQuantity
        If there is no segment, or if the segments leave a gap or overlap.
    """

    segments: tuple[Segment, ...]
    starts: Array = field(init=False, repr=False)
    pieces: Pieces = field(init=False, repr=False)

    def __post_init__(self) -> None:
        segments = tuple(self.segments)
        if not segments or segments[0].start != 0:
            raise InvalidQuantity(f"segments are {shown(segments)}; allowed: at least one, the first from 0 s")
        for before, after in itertools.pairwise(segments):
            if before.end != after.start:
                raise InvalidQuantity(
                    f"a segment ends at {before.end} s, the next starts at {after.start} s; allowed: contiguous"
                )
        last = segments[-1]
        if last.end < math.inf:
            segments = (*segments, Segment(last.end, math.inf, last.at(last.end)))
        object.__setattr__(self, "segments", segments)
        object.__setattr__(self, "starts", read_only(np.array([segment.start for segment in segments])))
        object.__setattr__(self, "pieces", Pieces.of(segments))

    def value(self, t: ArrayLike) -> Array:
        """f(t) at times ``t`` in s, of the shape of ``t``; at a jump the value after it.

        Raises
        ------
        InvalidQuantity
            If a time is not a finite real number: a sine has no value at infinity.
        """
        instants = checked_instants(t)
        if np.isinf(instants).any():
            raise InvalidQuantity(f"t is {shown(t)}; allowed: finite times in s")
        piece, elapsed = self.located(instants)
        return np.where(instants < 0, 0.0, self.pieces.taken(piece).at(elapsed).reshape(instants.shape))

    def located(self, instants: Array) -> tuple[Array, Array]:
        """Piece that holds each of m times in s, and the time in s since its start, both (m,); before 0 it is as at 0."""
        flat = np.maximum(instants, 0.0).ravel()
        piece = np.searchsorted(self.starts, flat, side="right") - 1
        return piece, flat - self.starts[piece]

    def added(self, other: History) -> History:
        """The sum of both histories, on the union of their breakpoints."""
        starts = np.union1d(self.starts, other.starts).tolist()
        ends = [*starts[1:], math.inf]
        firsts, seconds = (
            [history.segments[i].part(a, b) for i, a, b in zip(_covering(history, starts), starts, ends, strict=True)]
            for history in (self, other)
        )
        return History(
            tuple(
                Segment(a.start, a.end, a.value + b.value, a.slope + b.slope, a.harmonics + b.harmonics)
                for a, b in zip(firsts, seconds, strict=True)
            )
        )


def _covering(history: History, times: list[float]) -> list[int]:
    """Index of the segment that holds each of ``times``."""
    return (np.searchsorted(history.starts, times, side="right") - 1).tolist()


def step(value: float) -> History:
    """The history that jumps to ``value`` at t = 0.

    Raises
    ------
    InvalidQuantity
        If the value is not finite.
    """
    return History((Segment(0.0, math.inf, value),))


def ramp(rate: float, duration: float) -> History:
    """The history ``rate * t`` until ``duration`` in s, then held.

    Raises
    ------
    InvalidQuantity
        If the duration is not finite and positive.
    """
    duration = checked_number("duration", duration)
    return History((Segment(0.0, duration, 0.0, rate), Segment(duration, math.inf, rate * duration)))


def harmonic(amplitude: float, frequency: float, *, start: float = 0.0, mean: float = 0.0) -> History:
    """The history ``mean`` from t = 0 on, to which ``amplitude * sin(2 pi frequency (t - start))`` is added from ``start`` on.

    ``frequency > 0`` in Hz, ``start >= 0`` in s.

    Raises
    ------
    InvalidQuantity
        If a number is out of its range.
    """
    start, frequency = checked_number("start", start, zero=True), checked_number("frequency", frequency)
    wave = Segment(start, math.inf, mean, harmonics=(Harmonic(amplitude, 2 * math.pi * frequency),))
    return History((wave,) if start == 0 else (Segment(0.0, start, mean), wave))


def sampled(times: ArrayLike, values: ArrayLike) -> History:
    """The history linear between samples, with a jump from 0 at the first one and held after the last one.

    ``times >= 0`` in s, increasing, and ``values`` have the shape (n,), n >= 2.

    Raises
    ------
    InvalidQuantity
        If a sample is not finite, times are negative, unsorted or repeated, or there are fewer than two samples.
    """
    t, f = real_array("times", times), real_array("values", values)
    if t.ndim != 1 or t.shape != f.shape or t.size < 2:
        raise InvalidQuantity(f"times and values have the shapes {t.shape} and {f.shape}; allowed: one shape (n,), n >= 2")
    if not (np.isfinite(t).all() and np.isfinite(f).all()):
        raise InvalidQuantity("times or values hold NaN or infinity; allowed: finite numbers")
    steps = np.diff(t)
    for i in np.flatnonzero(steps <= 0)[:1]:
        raise InvalidQuantity(f"times[{i + 1}] is {t[i + 1]:g} s after {t[i]:g} s; allowed: increasing times")
    if t[0] < 0:
        raise InvalidQuantity(f"times[0] is {t[0]:g} s; allowed: >= 0")
    slopes = np.diff(f) / steps
    between = map(Segment, t[:-1].tolist(), t[1:].tolist(), f[:-1].tolist(), slopes.tolist())
    rest = () if t[0] == 0 else (Segment(0.0, float(t[0]), 0.0),)
    return History((*rest, *between, Segment(float(t[-1]), math.inf, float(f[-1]))))
