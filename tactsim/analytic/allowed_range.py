"""The allowed range of a number or an array, checked."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import ArrayLike

from tactsim.errors import InvalidQuantity, shown


def checked(what: str, value: ArrayLike, allowed: str) -> np.ndarray:
    """``value`` as an array of floats of its shape, all of which lie in ``allowed``, an interval written as in ``"(0, 0.5] m"``.

    Raises
    ------
    InvalidQuantity
        If a value lies outside, is not a number, or is not real.
    """
    opening, low, high, closing = re.match(r"([\[(])(.+), (.+)([\])])", allowed).groups()  # type: ignore[union-attr]
    try:
        values = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InvalidQuantity(f"{what} {shown(value)} is not a real number; allowed: {allowed}") from None
    above = values >= float(low) if opening == "[" else values > float(low)
    valid = above & (values <= float(high) if closing == "]" else values < float(high))
    if not valid.all():
        raise InvalidQuantity(f"{what} {shown(float(values[~valid][0]))} is out of range; allowed: {allowed}")
    return values
