"""Figure: how far the closed forms carry as the annulus is pressed deeper, over thickness and material."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field

from tactsim.materials.library import named_material
from tactsim.validation.closed_form_limits import ComparedRun
from tactsim.validation.evaluator import Drawing, Inputs


class ClosedFormLimits(Drawing):
    """Force of the simulations over that of the closed forms, over displacement; one panel per closed form."""

    kind: Literal["closed_form_limits"] = "closed_form_limits"
    title: str
    """Title of the figure."""
    study: str
    """Study of the table."""
    runs: Annotated[tuple[ComparedRun, ...], Field(min_length=1)]
    """The simulations."""

    @classmethod
    def example(cls) -> Self:
        """ICF, 10 mm thick."""
        one = ComparedRun(run="icf", material=named_material("icf_stable").material, thickness=1e-2)
        return cls(title="Limits of the closed form", study="depth", runs=(one,))

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: force over closed form, dimensionless, over displacement over outer radius."""
        panels = []
        for form, words in (("layer", "closed form of the layer"), ("half_space", "closed form of the half-space")):
            curves = []
            for compared in self.runs:
                outcome = inputs.run(self.study, compared.run)
                x, y = compared.depth(outcome), 1 + compared.departure(outcome, form)  # type: ignore[arg-type]
                curves.append({"label": compared.run, "x": x.tolist(), "y": y.tolist(), "style": "line"})
            panels.append({"y_axis": f"force over the {words}", "unit": "", "curves": curves, "logarithmic": True})
        return {
            "form": "curves",
            "title": self.title,
            "x_axis": "displacement over the outer radius",
            "x_unit": "",
            "x_logarithmic": True,
            "even_panels": True,
            "panels": panels,
        }
