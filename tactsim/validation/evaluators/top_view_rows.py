"""Rows of the top view of two matrices."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.localization.views import SHAPE, Join, joined, pair_images
from tactsim.validation.evaluator import Evaluator, Inputs


class TopViewRows(Evaluator):
    """Number of rows once the pictures of all pairs of rows are joined."""

    kind: Literal["top_view_rows"] = "top_view_rows"
    join: Join = "shared_once"
    """How they are joined (E24)."""
    rows: Annotated[int, Field(ge=1)] = SHAPE[0]
    """M of each picture."""
    sensors: Annotated[int, Field(ge=1)] = 3
    """Rows of each matrix."""

    @classmethod
    def example(cls) -> Self:
        """Two pictures of 60 rows."""
        return cls()

    def found(self, inputs: Inputs) -> float:
        """A count."""
        return float(len(joined(pair_images(np.ones((self.sensors, 3)), (self.rows, SHAPE[1])), self.join)))
