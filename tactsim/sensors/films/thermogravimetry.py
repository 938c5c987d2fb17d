"""Volume fraction of a filler from the masses that a thermogravimetric analysis weighs, with its uncertainty."""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from tactsim.model import FrozenModel
from tactsim.sensors.films.tunnelling import LOOSEST_PACKING, volume_fraction
from tactsim.units import Density, Mass, NonNegative, Positive, format_quantity


class Thermogravimetry(FrozenModel):
    r"""A sample of composite, burnt in nitrogen: the filler remains, the rest was the matrix.

    .. math:: \frac{\phi}{1 - \phi} = \frac{m_f}{m - m_f} \frac{\rho_m}{\rho_f}, \qquad
        u(\phi) = \phi (1 - \phi)\, u\!\left(\ln \frac{\phi}{1 - \phi}\right)

    The uncertainty is the first-order one of independent inputs (JCGM 100:2008, 5.1.2); a mass that is read to a resolution r has
    the standard uncertainty r / sqrt(12) (4.3.7 there).

    Source: thesis, section 2.3, whose numbers are the defaults of the densities.
    """

    sample_mass: Positive[Mass]
    """Mass of the sample before the analysis."""
    filler_mass: Positive[Mass]
    """Mass of what remains."""
    mass_resolution: NonNegative[Mass] = 1e-10
    """Last digit of the balance; by default that of the thesis, 0.0001 mg."""
    filler_density: Positive[Density] = 560.0
    """Density of the filler. The thesis takes 0.56 g/cm^3, the bulk density of the powder; solid carbon has 1.8 g/cm^3 (E27)."""
    matrix_density: Positive[Density] = 910.0
    """Density of the matrix."""
    filler_density_deviation: NonNegative[Density] = 0.0
    """Standard uncertainty of the density of the filler."""
    matrix_density_deviation: NonNegative[Density] = 0.0
    """Standard uncertainty of the density of the matrix."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.matrix_mass <= 0:
            left, whole = (format_quantity(mass, "kg") for mass in (self.filler_mass, self.sample_mass))
            raise ValueError(f"filler_mass {left} must be below the sample_mass {whole}: nothing burnt")
        if self.volume_fraction >= LOOSEST_PACKING:
            raise ValueError(
                f"the masses and densities give a volume fraction of {self.volume_fraction:.4g}; allowed: below pi/6 = "
                f"{LOOSEST_PACKING:.4f}, at which equal spheres touch (is filler_density a bulk density?)"
            )
        return self

    @property
    def matrix_mass(self) -> float:
        """Mass in kg of what burnt."""
        return self.sample_mass - self.filler_mass

    @property
    def mass_fraction(self) -> float:
        """Filler over sample by mass."""
        return self.filler_mass / self.sample_mass

    @property
    def mass_fraction_deviation(self) -> float:
        """Standard uncertainty of the fraction by mass."""
        return self._weighing * float(np.hypot(1.0, self.mass_fraction)) / self.sample_mass

    @property
    def volume_fraction(self) -> float:
        """Filler over sample by volume."""
        return volume_fraction(
            filler_mass=self.filler_mass,
            filler_density=self.filler_density,
            matrix_mass=self.matrix_mass,
            matrix_density=self.matrix_density,
        )

    @property
    def volume_fraction_deviation(self) -> float:
        """Standard uncertainty of the fraction by volume."""
        return float(np.sqrt(sum(part**2 for part in self.contributions().values())))

    def contributions(self) -> dict[str, float]:
        """What the masses and each density contribute to the standard uncertainty of the fraction by volume."""
        scale = self.volume_fraction * (1 - self.volume_fraction)
        left, burnt = 1 / self.filler_mass, 1 / self.matrix_mass
        return {
            "masses": scale * self._weighing * float(np.hypot(left + burnt, burnt)),
            "filler_density": scale * self.filler_density_deviation / self.filler_density,
            "matrix_density": scale * self.matrix_density_deviation / self.matrix_density,
        }

    @property
    def _weighing(self) -> float:
        """Standard uncertainty in kg of one weighing."""
        return self.mass_resolution / float(np.sqrt(12))


def _form(value: Any) -> str:
    return "masses" if isinstance(value, (dict, Thermogravimetry)) else "number"


FillerFraction = Annotated[
    Annotated[Annotated[float, Field(gt=0, lt=LOOSEST_PACKING)], Tag("number")] | Annotated[Thermogravimetry, Tag("masses")],
    Discriminator(_form),
]
"""A volume fraction in a model: a number, or the masses and densities that it follows from."""
