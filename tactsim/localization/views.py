"""Front, left and top view of the tissue between two matrices of sensors: thesis, section 6.3."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces.readings import checked_readings
from tactsim.localization.bands import Form, band_weights, check_count
from tactsim.localization.section_image import corrected_profile, image_between

Join = Literal["shared_once", "stacked", "added"]
"""How the pictures of neighbouring pairs of rows become one (errata E24)."""

AWAY = {"front": 1, "left": 0, "top": 2}
"""Axis along which each view looks."""
SHAPE = (60, 100)
"""Rows and columns of a picture: thesis, Fig. 3e of Appendix .2."""


@dataclass(frozen=True)
class Views:
    """Pictures in the unit of the readings; row 0 is the top of each picture, column 0 its left.

    The outermost pixels stand at the centres of the outermost taxels, or at the faces of the jaws.

    Attributes
    ----------
    front : (M, N), the upper jaw at the top, column 1 (smallest x) at the left
    left : (M, N), the upper jaw at the top; seen from the left, so the last row (largest y, the back) is at the left
    top : (M, N), the last row (the back) at the top, column 1 at the left
    """

    front: Array
    left: Array
    top: Array


def views(readings: Array, shape: tuple[int, int] = SHAPE, *, form: Form = "corrected", valid: Array | None = None) -> Views:
    """All three views of readings (jaw, row, column), the upper jaw first, each of ``shape`` (M, N).

    Front: the sums over the rows of each column as two arrays (Fig. 6.3b); left: the sums over the columns of each row
    (Fig. 6.3c); top: the sums of both jaws (Fig. 6.3d), neighbouring rows as in `pair_images`. Negative readings count as no
    signal, as a sensor reads a pull. ``valid`` is False for a dead or saturated taxel: it is interpolated from its neighbours.
    ``as_printed`` stacks the top view, so that it has (rows - 1) M rows.

    Raises
    ------
    InvalidQuantity
        If the readings have a wrong shape or are not finite (the taxel is named), or the picture has no pixels.

    Source: thesis, 6.3.1 to 6.3.4.
    """
    forces = np.maximum(checked_readings(readings, valid), 0.0)
    check_count("rows of the picture", shape[0])
    upper, lower = forces
    return Views(
        _section(upper.sum(axis=0), lower.sum(axis=0), shape, form),
        _section(upper.sum(axis=1)[::-1], lower.sum(axis=1)[::-1], shape, form),
        _top(upper + lower, shape, form),
    )


def _section(upper: Array, lower: Array, shape: tuple[int, int], form: Form) -> Array:
    weights = band_weights(len(upper), shape[1], form)
    return image_between(weights @ upper, weights @ lower, shape[0], form)


def _top(total: Array, shape: tuple[int, int], form: Form) -> Array:
    """Top view of sums (row, column) of both jaws; row 0 of the picture is the back (the last row of the matrix).

    Every two neighbouring rows are drawn as a section between two arrays, the one further back as the upper array (eq. 6.3.2,
    6.3.3). ``corrected`` joins these pictures with their common rows once (errata E24) and has ``shape`` (M, N), sampled at real
    positions; where M - 1 is a multiple of the number of pairs it is :func:`joined` of :func:`pair_images`. ``as_printed``
    stacks pictures of ``shape`` (eq. 6.3.4). A single row is the same at every height.
    """
    if form == "as_printed" or len(total) == 1:
        return joined(_pairs(total, shape, form), "stacked")
    weights = band_weights(total.shape[1], shape[1], form)
    bands = total[::-1] @ weights.T
    pairs = len(total) - 1
    along = np.linspace(0.0, pairs, shape[0]) if shape[0] > 1 else np.array([pairs / 2])
    first = np.minimum(along.astype(int), pairs - 1)
    return corrected_profile(bands[first], bands[first + 1], (along - first)[:, None])


def pair_images(total: Array, shape: tuple[int, int] = SHAPE) -> Array:
    """Pictures H1, H2, ... (pair, M, N) between neighbouring rows of sums (row, column), from the back to the front.

    A matrix of R rows has R - 1 pairs; one row alone is paired with itself as a picture that is the same at every height.

    Raises
    ------
    InvalidQuantity
        If there is no taxel, a sum is not finite, or the picture has no pixels.

    Source: thesis, eq. 6.3.1 to 6.3.3.
    """
    check_count("rows of the picture", shape[0])
    return _pairs(_checked_total(total), shape, "corrected")


def _pairs(total: Array, shape: tuple[int, int], form: Form) -> Array:
    bands = total[::-1] @ band_weights(total.shape[1], shape[1], form).T
    if len(bands) == 1:
        return np.broadcast_to(bands, (1, *shape)).copy()
    return np.moveaxis(image_between(bands[:-1], bands[1:], shape[0], form), 0, 1)


def joined(images: Array, join: Join = "shared_once") -> Array:
    """One picture of the pictures (pair, M, N) of all pairs.

    - ``shared_once``: below each other, the row that two have in common once: P (M - 1) + 1 rows, 2 M - 1 for two (errata E24);
    - ``stacked``: below each other, 2 M rows for two, as eq. 6.3.4 is printed;
    - ``added``: their sum, M rows, as the text before eq. 6.3.1 says.

    Raises
    ------
    InvalidQuantity
        If the images have another shape or no pixels.
    """
    pictures = np.asarray(images, dtype=float)
    if pictures.ndim != 3 or 0 in pictures.shape:
        raise InvalidQuantity(f"pictures of shape {pictures.shape}; needed: (pairs, rows, columns), none of them 0")
    if join == "added":
        return pictures.sum(axis=0)
    if join == "stacked":
        return pictures.reshape(-1, pictures.shape[2])
    return np.concatenate([pictures[0], *pictures[1:, 1:]])


def volume(readings: Array, shape: tuple[int, int, int]) -> Array:
    """Intensity (depth, y, x) in the whole tissue, in the unit of the readings: the three views' algorithm in every column.

    Depth 0 is the upper jaw, y 0 the front, x 0 column 1. Readings (jaw, row, column) are interpolated linearly over each jaw
    (corrected eq. .1.4 along both directions); between the jaws runs the corrected eq. .2.7. The thesis builds its image in
    space from the three views by hand (Fig. 6.8); this is the same algorithm where it has both lateral places at once.

    Raises
    ------
    InvalidQuantity
        If the readings have a wrong shape or are not finite, or a number of the shape is not whole and positive.
    """
    forces = np.maximum(checked_readings(readings), 0.0)
    depth, back, across = shape
    check_count("layers of the volume", depth)
    along_y, along_x = band_weights(forces.shape[1], back), band_weights(forces.shape[2], across)
    upper, lower = along_y @ forces @ along_x.T
    return image_between(upper, lower, depth)


def _checked_total(total: Array) -> Array:
    sums = np.asarray(total, dtype=float)
    if sums.ndim != 2 or 0 in sums.shape:
        raise InvalidQuantity(f"sums of shape {sums.shape}; needed: (rows, columns) with at least one of each")
    if not np.isfinite(sums).all():
        row, column = (int(k) + 1 for k in np.argwhere(~np.isfinite(sums))[0])
        raise InvalidQuantity(f"the sum of both taxels in row {row}, column {column} is not finite; needed: a finite number")
    return sums
