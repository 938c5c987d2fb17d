"""Figure of brackets: every run of some studies beside the printed numbers."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field

from tactsim.units import FrozenModel, parse_quantity
from tactsim.validation.bracket import readings
from tactsim.validation.evaluator import Drawing, Inputs


class PrintedLine(FrozenModel):
    """A printed number drawn across the runs of a study."""

    label: str
    """What it is."""
    value: str
    """The number with its unit."""


class RangeBars(Drawing):
    """One panel per study: the pressure of each run between its values over the two areas, printed numbers as lines."""

    kind: Literal["range_bars"] = "range_bars"
    title: str
    """Title of the figure."""
    panels: Annotated[dict[str, tuple[PrintedLine, ...]], Field(min_length=1)]
    """Study -> printed numbers."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer."""
        return cls(title="Table 3.2", panels={"icf": (PrintedLine(label="FEA", value="0.375 kPa"),)})

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``ranges``: per panel the runs with their two pressures in Pa, or the reason why there are none."""
        panels = []
        for study, lines in self.panels.items():
            bars = [
                {"label": outcome.id, "values": readings(outcome, "threshold_pressure") if outcome.converged else []}
                for outcome in inputs.study(study)
            ]
            printed = [{"label": line.label, "value": parse_quantity(line.value, "Pa")} for line in lines]
            panels.append({"title": study, "bars": bars, "lines": printed})
        return {"form": "ranges", "title": self.title, "axis": "threshold pressure", "unit": "Pa", "panels": panels}
