"""One array of sensors as a band of grey levels, and the bands between its elements: thesis, Appendix .1."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity

Form = Literal["corrected", "as_printed"]
"""Which equations: corrected by the errata, or as the thesis prints them."""

GREY_LEVELS = 256
"""K of eq. .1.1; thesis, Appendix .1."""


def band_intensities(signals: Array, normalising: float, grey_levels: int = GREY_LEVELS) -> Array:
    r"""Grey level of each signal, from 0 to K - 1, not rounded.

    .. math:: I_i = (V_i / \alpha) (K - 1) \text{ for } V_i \le \alpha, \quad I_i = K - 1 \text{ for } V_i > \alpha

    Parameters
    ----------
    signals : array of any shape
        V, in the unit of ``normalising``; negative ones count as none.
    normalising : float
        ``alpha > 0``: the signal of the highest level, which sets the working range.
    grey_levels : int
        ``K >= 2``.

    Raises
    ------
    InvalidQuantity
        If a signal is not finite, or alpha or K out of its range.

    Source: thesis, eq. .1.1 (there K = 256).
    """
    values = np.asarray(signals, dtype=float)
    _check_finite(values)
    if not (np.isfinite(normalising) and normalising > 0):
        raise InvalidQuantity(f"the normalising signal alpha is {normalising}; allowed: a finite number above 0")
    if isinstance(grey_levels, bool) or int(grey_levels) != grey_levels or grey_levels < 2:
        raise InvalidQuantity(f"the number K of grey levels is {grey_levels}; allowed: whole numbers from 2 on")
    return np.clip(values / normalising, 0.0, 1.0) * (grey_levels - 1)


def inserted_elements(elements: int, pixels: int) -> float:
    """Number (N - n)/(n - 1) of pixels that come between two of n elements along N pixels; rarely whole (errata E12).

    Raises
    ------
    InvalidQuantity
        If there are fewer than two elements or no pixel, or a number is not whole.
    """
    check_count("elements", elements, least=2)
    check_count("pixels", pixels)
    return (pixels - elements) / (elements - 1)


def element_positions(elements: int, pixels: int) -> Array:
    r"""Real position (n,) of each of n elements along N pixels, counted from 1: the first at 1, the last at N.

    .. math:: i_j = 1 + (j - 1) \frac{N - 1}{n - 1}

    A single element stands in the middle. Source: thesis, eq. .1.3, whose :math:`((j-1) N + n - j) / (n - 1)` is the same.

    Raises
    ------
    InvalidQuantity
        If there is no element or no pixel, or a number is not whole.
    """
    check_count("elements", elements)
    check_count("pixels", pixels)
    if elements == 1:
        return np.array([(1 + pixels) / 2])
    return 1 + np.arange(elements) * (pixels - 1) / (elements - 1)


@lru_cache(maxsize=64)
def band_weights(elements: int, pixels: int, form: Form = "corrected") -> Array:
    r"""Matrix W (N, n) of the linear interpolation G = W V of n signals over N pixels; read only.

    ``corrected`` (errata E12) interpolates linearly between the positions of :func:`element_positions`, real numbers where the
    spacing is not whole; the rows of W add up to 1 and no weight is negative. One pixel alone shows the middle of the array.

    ``as_printed`` is eq. .1.4 with its offset (j - 1)(N + n - 2)/(n - 1) and its ranges of (N - 1)/n, whose upper end counts as
    within (the thesis leaves both ends out) and where V_{n+1}, which there is none of, stands for V_n; then eq. .1.3 sets the
    elements that fall on a pixel. Its weights may be negative.

    Raises
    ------
    InvalidQuantity
        If there is no element or no pixel, or a number is not whole.

    Source: thesis, eq. .1.3 and .1.4.
    """
    positions = element_positions(elements, pixels)
    pixel = np.arange(1.0, pixels + 1)
    weights = np.zeros((pixels, elements))
    if elements == 1:
        weights[:] = 1.0
    elif pixels == 1:
        weights[0, (elements - 1) // 2] += 0.5
        weights[0, elements // 2] += 0.5
    elif form == "corrected":
        along = (pixel - 1) * (elements - 1) / (pixels - 1)
        _between(weights, np.minimum(along.astype(int), elements - 2), along)
    else:
        first = np.clip(np.ceil((pixel - 1) * elements / (pixels - 1)) - 1, 0, elements - 1).astype(int)
        offset = first * (pixels + elements - 2) / (elements - 1)
        _between(weights, first, first + (pixel - 1 - offset) * (elements - 1) / (pixels - 1))
        whole = np.isclose(positions, np.rint(positions), rtol=0, atol=1e-9)
        at = np.rint(positions[whole]).astype(int) - 1
        weights[at] = np.eye(elements)[whole]
    weights.setflags(write=False)
    return weights


def _between(weights: Array, first: Array, along: Array) -> None:
    """Add the weights of element ``first`` and the next, for places ``along`` the elements, both counted from 0."""
    pixel, part = np.arange(len(weights)), along - first
    following = np.minimum(first + 1, weights.shape[1] - 1)
    weights[pixel, first] += 1 - part
    weights[pixel, following] += part


def band_image(signals: Array, pixels: int, form: Form = "corrected") -> Array:
    """Signals (..., n) of an array interpolated over N pixels, shape (..., N), in their unit.

    Raises
    ------
    InvalidQuantity
        If there is no signal, one is not finite, or there is no pixel.

    Source: thesis, eq. .1.2 to .1.4, see :func:`band_weights`.
    """
    values = np.asarray(signals, dtype=float)
    if values.ndim == 0 or values.size == 0:
        raise InvalidQuantity(f"signals of shape {values.shape}; needed: at least one signal along the last axis")
    _check_finite(values)
    return values @ band_weights(values.shape[-1], pixels, form).T


def _check_finite(values: Array) -> None:
    if not np.isfinite(values).all():
        place = tuple(int(k) + 1 for k in np.argwhere(~np.isfinite(values))[0])
        raise InvalidQuantity(f"the signal at {place}, counted from 1, is not finite; needed: finite signals")


def check_count(what: str, count: int, least: int = 1) -> None:
    """Refuse a number of things that is not whole or less than ``least``.

    Raises
    ------
    InvalidQuantity
        Naming what is counted, the count and the least one.
    """
    if isinstance(count, bool) or int(count) != count or count < least:
        raise InvalidQuantity(f"the number of {what} is {count}; allowed: whole numbers from {least} on")
