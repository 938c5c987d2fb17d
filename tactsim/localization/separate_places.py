"""At how many separate places the sums of both jaws rise: more than one cannot come from one lump."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.readings import rising

PROMINENCE = 0.15
"""Rise of a second maximum above the saddle to a higher one, over the strongest, from which the two are separate places. In the
fast forward model of ``cases/grasp_plain.yaml`` no single ball of 1.5 to 8 mm, wherever it lies, makes a second maximum that
rises by more than 0.09; the two balls of ``cases/grasp_two_lumps.yaml`` make one of 0.92. Two lumps nearer to each other than
about two taxels have no saddle between them: only an estimator with a model of the tissue can tell them apart."""

NOISES = 4.0
"""Standard deviations of the noise, as the threshold of ``ThesisEstimator``, beyond which a maximum rises."""


def separate_peaks(sums: Array, least: float) -> list[tuple[int, int]]:
    """Row and column of the maxima of sums (row, column), the highest first, that rise by more than ``least`` above the saddle.

    The saddle of a maximum is the highest one among the lowest points of all paths over neighbours, diagonal ones too, to a
    higher maximum; the highest maximum of all has none and always counts. This is the persistence of the maxima: H. Edelsbrunner,
    D. Letscher & A. Zomorodian 2002, doi:10.1007/s00454-002-2885-2.
    """
    heights = np.asarray(sums, dtype=float).ravel()
    columns = np.shape(sums)[1]
    peak_of: dict[int, int] = {}
    peaks: list[int] = []
    for place in map(int, np.argsort(-heights, kind="stable")):
        meeting = sorted({_root(peak_of, near) for near in _neighbours(place, np.shape(sums)) if near in peak_of})
        meeting.sort(key=lambda peak: -heights[peak])
        peak_of[place] = meeting[0] if meeting else place
        for lower in meeting[1:]:
            if heights[lower] - heights[place] > least:
                peaks.append(lower)
            peak_of[lower] = meeting[0]
    peaks.append(_root(peak_of, 0))
    peaks.sort(key=lambda peak: -heights[peak])
    return [(peak // columns, peak % columns) for peak in peaks]


def rises_apart(difference: Array, noise: float) -> bool:
    """Whether a change of readings (jaw, row, column) in N rises at separate places, beyond noise of both readings in N."""
    sums = np.maximum(rising(difference)[0], 0.0).sum(axis=0)
    return len(separate_peaks(sums, max(2 * NOISES * noise, PROMINENCE * float(sums.max())))) > 1


def nearest_peak(shape: tuple[int, ...], peaks: list[tuple[int, int]]) -> Array:
    """Number (row, column) of the maximum that each place of a matrix lies nearest to; of equally near ones the first."""
    rows, columns = np.indices(shape)
    return np.argmin([(rows - row) ** 2 + (columns - column) ** 2 for row, column in peaks], axis=0)


def _root(peak_of: dict[int, int], place: int) -> int:
    while peak_of[place] != place:
        place = peak_of[place]
    return place


def _neighbours(place: int, shape: tuple[int, ...]) -> list[int]:
    row, column = divmod(place, shape[1])
    around = [(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return [r * shape[1] + c for r, c in around if 0 <= r < shape[0] and 0 <= c < shape[1] and (r, c) != (row, column)]
