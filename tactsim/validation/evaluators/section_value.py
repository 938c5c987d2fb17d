"""Intensity of a pixel of the picture between two arrays."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.localization.bands import Form
from tactsim.localization.section_image import section_image
from tactsim.validation.evaluator import Evaluator, Inputs


class SectionValue(Evaluator):
    """H in a row and column of the picture of Appendix .2."""

    kind: Literal["section_value"] = "section_value"
    upper: tuple[float, ...] = (3.0,)
    """V_U of each sensor."""
    lower: tuple[float, ...] = (1.0,)
    """V_L of each sensor."""
    shape: tuple[int, int] = (5, 1)
    """M and N."""
    pixel: tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(ge=1)]] = (1, 1)
    """Row and column, from 1."""
    form: Form = "corrected"
    """Corrected (E12, E13, E25) or as printed."""

    @classmethod
    def example(cls) -> Self:
        """At the upper array."""
        return cls()

    def found(self, inputs: Inputs) -> float:
        """In the unit of the signals."""
        if self.pixel[0] > self.shape[0] or self.pixel[1] > self.shape[1]:
            raise InputError(f"pixel {self.pixel} of a picture of {self.shape[0]} rows and {self.shape[1]} columns")
        return float(
            section_image(np.array(self.upper), np.array(self.lower), self.shape, self.form)[self.pixel[0] - 1, self.pixel[1] - 1]
        )
