"""The tissue between two arrays of sensors as a picture: thesis, Appendix .2."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.localization.bands import Form, band_image, check_count


def depth_share(upper: Array, lower: Array, form: Form = "corrected") -> Array:
    r"""Depth of a lump below the upper array over the thickness, from 0 to 1, dimensionless.

    .. math:: \frac{a}{a + b} = \frac{G_L}{G_L + G_U}

    A lump near an array raises its signal, so that the nearer jaw draws the lump to itself (errata E13); ``as_printed`` has
    G_U in the numerator (eq. .2.3). Negative signals count as none; where neither array has a signal, 1/2. Both arrays and the
    share have one shape.
    """
    above, below = np.maximum(upper, 0.0), np.maximum(lower, 0.0)
    total = above + below
    part = below if form == "corrected" else above
    return np.divide(part, total, out=np.full(np.shape(total), 0.5), where=total > 0)


def lump_rows(upper: Array, lower: Array, rows: int, form: Form = "corrected") -> Array:
    r"""Row r of M, a real number, at which each column shows the centre of a lump; row 1 is the upper array.

    It has the shape of the signals, (columns,) or that of one column.

    .. math:: r = 1 + (M - 1) \frac{G_L}{G_L + G_U}

    (errata E13 and E25), from 1 to M, and the middle (M + 1)/2 without signal. ``as_printed`` is eq. .2.3,
    :math:`r = M G_U / (G_L + G_U)`, from 0 to M, and M/2 without signal.

    Raises
    ------
    InvalidQuantity
        If the rows are not a whole number from 1 on.
    """
    check_count("rows of the picture", rows)
    share = depth_share(upper, lower, form)
    return 1 + (rows - 1) * share if form == "corrected" else rows * share


def section_image(upper: Array, lower: Array, shape: tuple[int, int], form: Form = "corrected") -> Array:
    r"""Picture (M, N) of the section between two arrays of n sensors, in the unit of the signals.

    Row 0 is the upper array (the top of the picture) and row M - 1 the lower; column 0 is sensor 1 and column N - 1 sensor n.
    Signals G interpolated along the arrays (:func:`~tactsim.localization.bands.band_image`), each column runs linearly
    from G_U in row 1 over G_r = G_U + G_L (eq. .2.4) in row r (:func:`lump_rows`) to G_L in row M. Negative signals count as
    none; without any the picture is 0.

    Parameters
    ----------
    upper, lower : arrays of shape (n,)
    shape : (M, N), each at least 1
    form : errata E12, E13 and E25 corrected, or as printed

    Raises
    ------
    InvalidQuantity
        If the arrays differ in shape, a signal is not finite, or a side of the picture is not a positive number.

    Source: thesis, eq. .2.1 to .2.7.
    """
    above, below = np.asarray(upper, dtype=float), np.asarray(lower, dtype=float)
    if above.ndim != 1 or above.shape != below.shape:
        raise InvalidQuantity(f"arrays of shape {above.shape} and {below.shape}; needed: two of the same shape (n,)")
    rows, columns = shape
    check_count("rows of the picture", rows)
    above, below = (band_image(np.maximum(signals, 0.0), columns, form) for signals in (above, below))
    return image_between(above, below, rows, form)


def image_between(upper: Array, lower: Array, rows: int, form: Form = "corrected") -> Array:
    """Picture (M, ...) between interpolated signals (...): eq. .2.7 at rows 1 to M; see :func:`section_image`."""
    place = np.arange(1.0, rows + 1).reshape(-1, *(1,) * np.ndim(upper))
    if form == "as_printed":
        return _printed(upper, lower, place, rows)
    share = (place - 1) / (rows - 1) if rows > 1 else np.full_like(place, 0.5)
    return corrected_profile(upper, lower, share)


def corrected_profile(upper: Array, lower: Array, share: Array) -> Array:
    r"""Intensity at a depth ``share`` of the thickness below the upper array, of the shape to which the three broadcast.

    .. math:: H = \min\{G_U + s (G_U + G_L),\; G_L + (1 - s)(G_U + G_L)\}, \quad s = \frac{i - 1}{M - 1}

    This is eq. .2.7 with the r of errata E25: there :math:`(G_r - G_U)/(r - 1) = G_r/(M - 1)` and
    :math:`(G_L - G_r)/(M - r) = -G_r/(M - 1)`, so that nothing is divided by, whether r = 1, r = M or there is no signal. Both
    lines rise with the same slope and meet at r. Signals must not be negative.
    """
    total = upper + lower
    rise = share * total
    return np.minimum(upper + rise, (lower + total) - rise)


def _printed(upper: Array, lower: Array, place: Array, rows: int) -> Array:
    """Eq. .2.7 with the r of eq. .2.3. The branch that would divide by zero leaves its single row to the other."""
    row = lump_rows(upper, lower, rows, "as_printed")
    total = upper + lower
    above, below = row - 1, rows - row
    rising = upper + (place - 1) * np.divide(total - upper, above, out=np.zeros_like(total), where=above > 0)
    falling = total + (place - row) * np.divide(lower - total, below, out=np.zeros_like(total), where=below > 0)
    printed = np.where((place <= row) & (above > 0), rising, falling)
    return np.where((upper > 0) | (lower > 0), printed, 0.0)
