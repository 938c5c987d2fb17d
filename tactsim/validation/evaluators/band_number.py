"""Numbers of the interpolation of an array of sensors over the pixels of a picture."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.localization.bands import Form, band_image, element_positions, inserted_elements
from tactsim.validation.evaluator import Evaluator, Inputs

Count = Annotated[int, Field(ge=2)]


class BandNumber(Evaluator):
    """Elements inserted between two, position of an element, or the interpolated value at a pixel when element j reads j."""

    kind: Literal["band_number"] = "band_number"
    number: Literal["inserted", "position", "value"]
    """Which number."""
    elements: Count = 7
    """n."""
    pixels: Count = 60
    """N."""
    at: Annotated[int, Field(ge=1)] = 1
    """Number of the element, or of the pixel, from 1."""
    form: Form = "corrected"
    """Eq. .1.4 corrected (E12) or as printed."""

    @classmethod
    def example(cls) -> Self:
        """Between seven sensors over 60 pixels."""
        return cls(number="inserted")

    def found(self, inputs: Inputs) -> float:
        """A number of pixels, a position from 1, or a reading."""
        if self.number == "inserted":
            return inserted_elements(self.elements, self.pixels)
        if self.number == "position":
            return float(element_positions(self.elements, self.pixels)[self.at - 1])
        return float(band_image(np.arange(1.0, self.elements + 1), self.pixels, self.form)[self.at - 1])
