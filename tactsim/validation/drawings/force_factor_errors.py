"""Figure of how far the formulas of the force factor are off (4.2.21)."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.analytic.force_factor import LARGEST_RATIO, force_factor
from tactsim.validation.evaluator import Drawing, Inputs

LABELS = {
    "exact": "exact (solved contact)",
    "thesis_4_2_21": "4.2.21 as printed",
    "small_hole_series": "series in beta to the sixth power",
    "smythe": "Smythe 1951",
}
POINTS = 400


class ForceFactorErrors(Drawing):
    """The force factor above, the relative error of each formula below, over the ratio of the radii."""

    kind: Literal["force_factor_errors"] = "force_factor_errors"
    title: str
    """Title of the figure."""
    formulas: Annotated[tuple[Literal["thesis_4_2_21", "small_hole_series", "smythe"], ...], Field(min_length=1)]
    """Formulas that are judged."""
    largest_error: Annotated[float, Field(gt=0)] = 0.05
    """A formula is drawn up to this error."""

    @classmethod
    def example(cls) -> Self:
        """The formula of the thesis."""
        return cls(title="4.2.21", formulas=("thesis_4_2_21",))

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: the factor, and its error in percent."""
        beta = np.linspace(0.0, LARGEST_RATIO, POINTS)
        exact = force_factor(beta)
        upper = [{"label": LABELS["exact"], "x": beta.tolist(), "y": exact.tolist(), "style": "line"}]
        lower = [{"label": LABELS["exact"], "x": beta.tolist(), "y": np.zeros(POINTS).tolist(), "style": "line"}]
        for formula in self.formulas:
            value = force_factor(beta, formula)
            error = value / exact - 1
            beyond = np.flatnonzero(np.abs(error) > self.largest_error)
            shown = slice(0, int(beyond[0]) if beyond.size else POINTS)
            for curves, y in ((upper, value), (lower, 100 * error)):
                curves.append({"label": LABELS[formula], "x": beta[shown].tolist(), "y": y[shown].tolist(), "style": "line"})
        panels = [
            {"y_axis": "force factor kappa", "unit": "", "curves": upper},
            {"y_axis": "error in %", "unit": "", "curves": lower},
        ]
        return {"form": "curves", "title": self.title, "x_axis": "ri/ro", "x_unit": "", "panels": panels}
