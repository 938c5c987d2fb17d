"""How well a form of the energy fits the uniaxial curve of a material set."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.uniaxial_curves import fitted


class FitError(Evaluator):
    """Relative error of the nominal stress of a fit to the uniaxial compression curve of a set."""

    kind: Literal["fit_error"] = "fit_error"
    material: str
    """Shipped set whose curve is fitted."""
    form: str
    """Form of the fit, as in ``tactsim material --fit``."""
    measure: Literal["max", "rms"] = "max"
    """Largest error, or root mean square."""

    @classmethod
    def example(cls) -> Self:
        """Two parameters for the soft elastomer."""
        return cls(material="icf_printed", form="2-parameter")

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        fit = fitted(self.material, self.form)
        return fit.max_relative_error if self.measure == "max" else fit.rms_relative_error
