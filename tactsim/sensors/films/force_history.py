"""What sensors accept as samples: times that increase, forces that press, signals."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.units import format_quantity

LARGEST = 1e30
"""Largest number in SI units that is taken, so that no difference or product overflows."""


def checked_times(time: ArrayLike, *, after: float | None = None) -> Array:
    """Times (n,) in s as floats.

    Raises
    ------
    InvalidQuantity
        If there is none, one is not finite, or they do not increase strictly, from ``after`` on.
    """
    times = np.asarray(time, dtype=float)
    if times.ndim != 1 or not len(times):
        raise InvalidQuantity(f"times have the shape {times.shape}; allowed: (n,) with at least one sample")
    _check_finite(times, "time", "s")
    late = np.flatnonzero(np.diff(times) <= 0)
    if len(late):
        n = int(late[0])
        raise InvalidQuantity(f"time {times[n + 1]:g} s of sample {n + 1} follows {times[n]:g} s; times must increase: sort them")
    if after is not None and times[0] <= after:
        raise InvalidQuantity(f"time {times[0]:g} s follows {after:g} s of the samples before; times must increase")
    return times


def checked_forces(force: ArrayLike, samples: int, largest: float) -> Array:
    """Forces (n, ...) in N as floats, between 0 and ``largest``.

    Raises
    ------
    InvalidQuantity
        Naming the first sample that is not.
    """
    forces = _sampled(force, samples, "force", "N")
    wrong = (forces < 0) | (forces > largest)
    if wrong.any():
        place = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise InvalidQuantity(f"force {forces[place]:g} N of sample {place[0]} is out of range; allowed: 0 to {largest:g} N")
    return forces


def checked_signal(signal: ArrayLike, samples: int, name: str, unit: str) -> Array:
    """Values (n, ...) of a film's signal as floats >= 0; ``name`` and ``unit`` are how messages call them.

    Raises
    ------
    InvalidQuantity
        Naming the first sample that is not.
    """
    values = _sampled(signal, samples, name, unit)
    if (values < 0).any():
        place = tuple(int(i) for i in np.argwhere(values < 0)[0])
        raise InvalidQuantity(f"{name} {values[place]:g} {unit} of sample {place[0]} is negative; allowed: >= 0")
    return values


def _sampled(values: ArrayLike, samples: int, name: str, unit: str) -> Array:
    array = np.asarray(values, dtype=float)
    if array.ndim < 1 or len(array) != samples:
        raise InvalidQuantity(f"{name} has the shape {array.shape}; allowed: ({samples}, ...), one for each of {samples} times")
    _check_finite(array, name, unit)
    return array


def _check_finite(array: Array, name: str, unit: str) -> None:
    wrong = ~(np.abs(array) <= LARGEST)  # NaN fails too
    if wrong.any():
        place = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise InvalidQuantity(f"{name} of sample {place[0]} is {array[place]} {unit}; allowed: finite numbers up to {LARGEST:g}")


def beyond_measured(largest: float, measured: float, words: str) -> tuple[str, ...]:
    """The warning that a force in N goes beyond the ``measured`` one, which stands in ``words`` as {}; none if it does not."""
    if largest <= measured * (1 + 1e-9):
        return ()
    return (f"the force reaches {format_quantity(largest, 'N')} on the film; {words.format(format_quantity(measured, 'N'))}",)
