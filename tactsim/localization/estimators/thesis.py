"""The thesis's algorithm as an estimator: place from the top view, depth from the ratio of both jaws, no size."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Estimator
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings, rising
from tactsim.localization.bands import Form
from tactsim.localization.section_image import depth_share
from tactsim.localization.separate_places import PROMINENCE, nearest_peak, separate_peaks
from tactsim.units import NonNegative, format_quantity


class ThesisEstimator(Estimator):
    r"""One inclusion, read off the views of thesis 6.3 at real positions instead of pixels; several where they stand apart.

    The signal is the force of each taxel, or with ``background: reference`` what it reads more than the tissue without a lump
    (less, where the strongest change is a loss: an inclusion softer than the tissue). Its sum over both jaws is the top view.

    Something is there if the largest sum exceeds its base by more than ``threshold`` standard deviations. With a reference the
    base is zero and the deviation 2 noise, as the reference has noise of its own. Without, the base is the median of the sums
    and the deviation :math:`\sqrt 2` noise; then the unevenness of plain tissue under the jaws counts as a signal, the known
    weakness of the thesis's algorithm. The depth is a/(a + b) of eq. .2.3, of the undeformed thickness.

    The centroid of two lumps lies between them, where nothing is. Sums with several separate maxima, none of which one ball could
    make beside another (``separate_places``), therefore give a place for each, of the taxels nearest to it, and say so.

    Source: thesis, 6.3.1 to 6.3.4 and Appendix .2, errata E13, E24, E25.
    """

    kind: Literal["thesis"] = "thesis"
    background: Literal["none", "reference"] = "none"
    """Whether the readings of tissue without a lump at the same closing are taken off."""
    lateral: Literal["centroid", "peak"] = "centroid"
    """Centroid of the sums above their base, or the brightest point of the top view, which lies in the centre of a column."""
    form: Form = "corrected"
    """Eq. .2.3 corrected (E13), or as printed, which turns the depth upside down."""
    threshold: NonNegative[float] = 4.0
    """Standard deviations of the noise by which the strongest place must exceed its base."""

    @classmethod
    def example(cls) -> Self:
        """The corrected algorithm on the bare forces."""
        return cls()

    @classmethod
    def variants(cls) -> dict[str, Self]:
        """On the bare forces, and on what they differ from a reference."""
        return {"thesis": cls(), "thesis with reference": cls(background="reference")}

    @property
    def title(self) -> str:
        """Whether it takes off a reference too."""
        return "Thesis, less a reference" if self.needs_reference else "Thesis"

    @property
    def needs_reference(self) -> bool:
        """Whether the reference is taken off."""
        return self.background == "reference"

    def estimate(self, readings: Readings) -> Estimate:
        """An inclusion for every separate place, without radius, contrast or covariance, the strongest first.

        Raises
        ------
        InputError
            If the reference is the background and the readings have none.
        """
        signal, softer = self._signal(readings)
        upper, lower = np.maximum(signal, 0.0)
        total = upper + lower
        base = 0.0 if self.background == "reference" else float(np.median(total))
        strength, least = float(total.max()) - base, self.threshold * self._deviation(readings)
        over = f"{'less' if softer else 'more'} than {'the reference' if self.background == 'reference' else 'the median of all'}"
        words = f"the strongest place reads {format_quantity(strength, 'N')} {over}"
        limit = self._limit_words(readings)
        if strength <= least:
            return Estimate(False, (), f"no inclusion: {words}, which is within {limit}")
        peaks = [peak for peak in separate_peaks(total, max(least, PROMINENCE * strength)) if total[peak] - base > least]
        if len(peaks) > 1:
            words = f"{len(peaks)} places explain the readings better than one, as the sums fall between them; {words}"
        nearest = nearest_peak(total.shape, peaks)
        parts = [np.where(nearest == number, total, base) for number in range(len(peaks))]
        places = [self._place(part, base, upper, lower, readings) for part in parts]
        inclusions = tuple(EstimatedInclusion("unknown", place) for place in places)
        return Estimate(True, inclusions, f"{words}, which is beyond {limit}")

    def _place(self, total: Array, base: float, upper: Array, lower: Array, readings: Readings) -> tuple[float, float, float]:
        """Centre in m of what rises in sums (row, column) above their base."""
        weights = self._weights(total, base)
        x, y = readings.taxel_places()
        share = float(depth_share((weights * upper).sum(), (weights * lower).sum(), self.form))
        return float(weights.sum(axis=0) @ x), float(weights.sum(axis=1) @ y), float((1 - share) * readings.block_size[2])

    def _signal(self, readings: Readings) -> tuple[Array, bool]:
        """Signal (jaw, row, column) in N, and whether it is a loss, as over something softer than the tissue."""
        if self.background == "none":
            return readings.filled, False
        if readings.difference is None:
            raise InputError(
                "background: reference needs readings of the tissue without a lump; give a reference, or background: none"
            )
        return rising(readings.difference)

    def _deviation(self, readings: Readings) -> float:
        """Standard deviation in N of the sum of both jaws at one place."""
        return float(readings.noise * (2.0 if self.background == "reference" else np.sqrt(2.0)))

    def _limit_words(self, readings: Readings) -> str:
        """The least change that counts, and how it follows from the noise of a taxel."""
        deviation = self._deviation(readings)
        forces = (self.threshold * deviation, deviation, readings.noise)
        least, one, each = (format_quantity(float(f"{force:.3g}"), "N") for force in forces)
        return f"{least} ({self.threshold:g} standard deviations of {one}, from noise of {each} on each taxel)"

    def _weights(self, total: Array, base: float) -> Array:
        """Share of each place (row, column) in the estimated position; they add up to 1."""
        if self.lateral == "centroid":
            weights = np.maximum(total - base, 0.0)
        else:
            weights = np.zeros_like(total)
            pairs = total[:-1] + total[1:] if len(total) > 1 else total
            row, column = np.unravel_index(int(pairs.argmax()), pairs.shape)
            rows = slice(int(row), int(row) + 2)
            weights[rows, column] = total[rows, column]
        return weights / weights.sum()
