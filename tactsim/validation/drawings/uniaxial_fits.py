"""Figure of fits to a uniaxial compression curve, as Fig. 3.8."""

from __future__ import annotations

from typing import Any, Literal, Self

from tactsim.interfaces import Array
from tactsim.validation.evaluator import Drawing, Inputs


class UniaxialFits(Drawing):
    """The curve of a material set with fits of several forms, and the relative error of each."""

    kind: Literal["uniaxial_fits"] = "uniaxial_fits"
    title: str
    """Title of the figure."""
    material: str
    """Shipped set whose curve is fitted."""
    forms: tuple[str, ...]
    """Forms of the fit."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer."""
        return cls(title="Fig. 3.8b", material="icf_printed", forms=("2-parameter", "3-parameter"))

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: nominal stress in Pa above, relative error in percent below, over the stretch."""
        from tactsim.identification.uniaxial import uniaxial_nominal_stress
        from tactsim.validation.uniaxial_curves import compression_curve, fitted

        curve = compression_curve(self.material)
        stretch, stress = curve.stretch, curve.nominal_stress
        upper = [_curve("3.1.9 with c11, constants of Table 3.1", stretch, stress, "points")]
        lower = []
        for form in self.forms:
            fit = fitted(self.material, form)
            model = uniaxial_nominal_stress(fit.material, stretch)
            upper.append(_curve(f"{form}: max {fit.max_relative_error:.1%}, rms {fit.rms_relative_error:.1%}", stretch, model))
            lower.append(_curve(form, stretch, 100 * (model / stress - 1)))
        panels = [
            {"y_axis": "nominal stress", "unit": "Pa", "curves": upper},
            {"y_axis": "relative error in %", "unit": "", "curves": lower},
        ]
        return {"form": "curves", "title": self.title, "x_axis": "stretch", "x_unit": "", "panels": panels}


def _curve(label: str, x: Array, y: Array, style: str = "line") -> dict[str, Any]:
    return {"label": label, "x": x.tolist(), "y": y.tolist(), "style": style}
