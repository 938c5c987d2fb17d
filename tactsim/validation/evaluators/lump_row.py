"""Row of the picture at which a lump is shown."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.localization.bands import Form
from tactsim.localization.section_image import lump_rows
from tactsim.localization.views import SHAPE
from tactsim.validation.evaluator import Evaluator, Inputs


class LumpRow(Evaluator):
    """r of eq. .2.3 for the signals of both arrays; row 1 is the upper array."""

    kind: Literal["lump_row"] = "lump_row"
    upper: Annotated[float, Field(ge=0)]
    """G_U."""
    lower: Annotated[float, Field(ge=0)]
    """G_L."""
    rows: Annotated[int, Field(ge=1)] = SHAPE[0]
    """M."""
    form: Form = "corrected"
    """Corrected (E13, E25) or as printed."""

    @classmethod
    def example(cls) -> Self:
        """A lump near the upper jaw."""
        return cls(upper=3.0, lower=1.0)

    def found(self, inputs: Inputs) -> float:
        """Counted from 1."""
        return float(lump_rows(np.array(self.upper), np.array(self.lower), self.rows, self.form))
