"""Which sensors an output of the three views adds up."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.localization.views import views
from tactsim.validation.evaluator import Evaluator, Inputs

SHAPE = (61, 101)
"""A picture whose middle column stands on the middle sensor."""
PLACES = {"upper": 0, "lower": -1, "left": 0, "middle": 50, "right": -1}


class ViewOutput(Evaluator):
    """Intensity at the border of a view of two 3 x 3 matrices in which U of row r and column c reads 10 r + c, and L 100 more."""

    kind: Literal["view_output"] = "view_output"
    view: Literal["front", "left", "top"]
    """Which view."""
    row: Literal["upper", "lower"]
    """Border of the picture."""
    column: Literal["left", "middle", "right"]
    """Sensor along it, as in thesis Fig. 6.3."""

    @classmethod
    def example(cls) -> Self:
        """U1,1 + U2,1 + U3,1."""
        return cls(view="front", row="upper", column="left")

    def found(self, inputs: Inputs) -> float:
        """Sum of the readings."""
        number = np.arange(1.0, 4.0)
        upper = 10 * number[:, None] + number
        image = getattr(views(np.array([upper, upper + 100]), SHAPE), self.view)
        return float(image[PLACES[self.row], PLACES[self.column]])
