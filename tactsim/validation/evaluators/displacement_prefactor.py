"""The factor in front of the force in the displacement of eq. 4.6.4."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.analytic.atrial import atrial_shear_compliance, table_4_1
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.validation.evaluator import Evaluator, Inputs


class DisplacementPrefactor(Evaluator):
    """n in eps0 = p D(t) / (n ro kappa), with the compliance D of Table 4.1 and Poisson's ratio 1/2, found at 1 s."""

    kind: Literal["displacement_prefactor"] = "displacement_prefactor"
    compliance: Literal["tensile", "half_shear"] = "half_shear"
    """Reading of D: 1/E, or 1/(2G)."""

    @classmethod
    def example(cls) -> Self:
        """The reading of the thesis."""
        return cls()

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        annulus = ViscoelasticAnnulus(1.0, 0.1, atrial_shear_compliance("viscosities", self.compliance))
        displacement = float(annulus.creep_displacement(1.0, 1.0))
        return float(table_4_1("viscosities").creep(1.0)) / (displacement * annulus.force_factor)
