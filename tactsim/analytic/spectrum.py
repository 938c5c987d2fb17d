"""Checked discrete spectra of times, as the linear viscoelastic models hold them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.errors import InvalidQuantity, shown


def checked_spectrum(name: str, strengths: ArrayLike, times: ArrayLike) -> tuple[Array, Array]:
    """``strengths`` and ``times``, both of shape (n,) and read-only, sorted by time; strengths of equal times are added.

    Raises
    ------
    InvalidQuantity
        If the shapes differ, or if a strength or a time is not finite and positive; ``name`` is what a strength is called.
    """
    given = real_array(name, strengths), real_array("times", times)
    if given[0].ndim != 1 or given[0].shape != given[1].shape:
        shapes = " and ".join(str(array.shape) for array in given)
        raise InvalidQuantity(f"{name} and times have the shapes {shapes}; allowed: one shape (n,), n >= 0")
    for label, array in zip((name, "times"), given, strict=True):
        for i in np.flatnonzero(~(np.isfinite(array) & (array > 0)))[:1]:
            raise InvalidQuantity(f"{label}[{i}] is {array[i]:g}; allowed: finite and > 0")
    distinct, group = np.unique(given[1], return_inverse=True)
    merged = np.zeros_like(distinct)
    np.add.at(merged, group, given[0])
    return read_only(merged), read_only(distinct)


def checked_number(name: str, value: float, *, zero: bool = False) -> float:
    """``value`` as a float, finite and positive, or not negative where ``zero`` is allowed.

    Raises
    ------
    InvalidQuantity
        If it is not.
    """
    number = real_array(name, value)
    if number.ndim != 0 or not math.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise InvalidQuantity(f"{name} is {shown(value)}; allowed: finite and {'>= 0' if zero else '> 0'}")
    return float(number)


def checked_instants(times: ArrayLike) -> Array:
    """The times in s as a new array of floats of the same shape, infinity allowed.

    Raises
    ------
    InvalidQuantity
        If one is NaN.
    """
    instants = real_array("t", times)
    if np.isnan(instants).any():
        raise InvalidQuantity(f"t is {shown(times)}; allowed: times in s, not NaN")
    return instants


def checked_frequencies(values: ArrayLike, *, zero: bool) -> Array:
    """Angular frequencies ``omega`` in rad/s as a new array of the same shape, finite and positive, or not negative if ``zero``.

    Raises
    ------
    InvalidQuantity
        If they are not.
    """
    frequencies = real_array("omega", values)
    if not (np.isfinite(frequencies) & (frequencies >= 0) & (zero | (frequencies > 0))).all():
        raise InvalidQuantity(f"omega is {shown(values)} rad/s; allowed: finite and {'>= 0' if zero else '> 0'}")
    return frequencies


def real_array(name: str, values: ArrayLike) -> Array:
    """A new array of floats of the shape of ``values``.

    Raises
    ------
    InvalidQuantity
        If ``values`` are not real numbers.
    """
    try:
        raw = np.asarray(values)
        if raw.dtype.kind not in "fiu" and raw.size:
            raise TypeError
        return raw.astype(np.float64)
    except (TypeError, ValueError):
        raise InvalidQuantity(f"{name} is {shown(values)}; allowed: real numbers") from None


def read_only(array: Array) -> Array:
    """The same array, of any shape, which can no longer be written."""
    array.flags.writeable = False
    return array
