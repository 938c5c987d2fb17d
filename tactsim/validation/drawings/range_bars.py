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


class Panel(FrozenModel):
    """The runs of one study."""

    study: str
    """Study of the table."""
    title: str
    """What it simulates."""
    printed: tuple[PrintedLine, ...]
    """Printed numbers to compare with."""


class RangeBars(Drawing):
    """One panel per study: the pressure of each run between its values over the two areas, printed numbers as lines."""

    kind: Literal["range_bars"] = "range_bars"
    title: str
    """Title of the figure."""
    panels: Annotated[tuple[Panel, ...], Field(min_length=1)]
    """From left to right."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer."""
        line = PrintedLine(label="FEA", value="0.375 kPa")
        return cls(title="Table 3.2", panels=(Panel(study="icf", title="ICF", printed=(line,)),))

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``ranges``: per panel the runs with their two pressures in Pa, or the reason why there are none."""
        panels = []
        for panel in self.panels:
            bars = [
                {"label": outcome.id, "values": readings(outcome, "threshold_pressure") if outcome.converged else []}
                for outcome in inputs.study(panel.study)
            ]
            printed = [{"label": line.label, "value": parse_quantity(line.value, "Pa")} for line in panel.printed]
            panels.append({"title": panel.title, "bars": bars, "lines": printed})
        return {"form": "ranges", "title": self.title, "axis": "threshold pressure", "unit": "Pa", "panels": panels}
