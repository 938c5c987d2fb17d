"""Grey level of a signal in the display."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.localization.bands import GREY_LEVELS, band_intensities
from tactsim.validation.evaluator import Evaluator, Inputs


class BandLevel(Evaluator):
    """Level of eq. .1.1 for a signal over the normalising one."""

    kind: Literal["band_level"] = "band_level"
    signal: float
    """V over alpha."""
    grey_levels: int = GREY_LEVELS
    """K."""

    @classmethod
    def example(cls) -> Self:
        """The end of the working range."""
        return cls(signal=1.0)

    def found(self, inputs: Inputs) -> float:
        """From 0 to K - 1."""
        return float(band_intensities(np.array(self.signal), 1.0, self.grey_levels))
