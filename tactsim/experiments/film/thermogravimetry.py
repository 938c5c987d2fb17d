"""Fractions of a filler from a thermogravimetric analysis, by readings of its density, and what follows for tunnelling."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tactsim.experiments.film.scene import DensityReading, ThermogravimetryScene
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.model import FrozenModel
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.sensors.films.thermogravimetry import Thermogravimetry
from tactsim.sensors.films.tunnelling import particle_separation, tunnelling_decay
from tactsim.units import Density, Energy, Length, Mass, NonNegative, Positive, format_quantity

STEP = 1e-6
"""Relative step of the difference quotient of the separation."""


class FillerDensity(FrozenModel):
    """A density that the filler may be taken to have."""

    name: Annotated[str, Field(min_length=1, max_length=40)]
    """Name in the figure and the quantities."""
    density: Positive[Density]
    """Density."""
    deviation: NonNegative[Density] = 0.0
    """Standard uncertainty."""


BULK = FillerDensity(name="bulk", density=560.0, deviation=5.0 / 3**0.5)
"""Thesis, section 2.3: 0.56 g/cm^3, printed to two digits: +-0.005, equally likely."""
SOLID = FillerDensity(name="solid", density=1800.0, deviation=50.0 / 3**0.5)
"""Solid carbon black, 1.8 g/cm^3 (errata E27), to +-0.05."""


class ThermogravimetricAnalysis(Experiment):
    """Fraction of the filler by mass and by volume, with uncertainties, and separation s0 and exponent gamma s0 of the composite.

    Source: thesis, section 2.3, eqs. 2.1.4 and 2.1.8; uncertainties by JCGM 100:2008.
    """

    kind: Literal["thermogravimetry"] = "thermogravimetry"
    sample_mass: Positive[Mass]
    """Mass of the sample before the analysis."""
    filler_mass: Positive[Mass]
    """Mass of what remains."""
    mass_resolution: NonNegative[Mass] = 1e-10
    """Last digit of the balance."""
    matrix_density: Positive[Density] = 910.0
    """Density of the matrix."""
    matrix_density_deviation: NonNegative[Density] = 0.5 / 3**0.5
    """Standard uncertainty of the density of the matrix; by default that of 0.910 g/cm^3 printed to three digits."""
    filler_densities: Annotated[tuple[FillerDensity, ...], Field(min_length=1, max_length=20)] = (BULK, SOLID)
    """Readings of the density of the filler: the thesis divides by that of the loose powder, particles have that of the solid."""
    particle_diameter: Positive[Length] = 500e-9
    """Of the filler."""
    barrier: Positive[Energy] = 8.01088317e-21
    """Potential barrier between two particles."""

    history_units: ClassVar[dict[str, str]] = {
        "filler_density": "kg/m^3",
        "mass_fraction": "1",
        "mass_fraction_deviation": "1",
        "volume_fraction": "1",
        "volume_fraction_deviation": "1",
        "separation": "m",
        "separation_deviation": "m",
        "exponent": "1",
        "exponent_deviation": "1",
    }

    @model_validator(mode="after")
    def _readable(self) -> Self:
        names = [reading.name for reading in self.filler_densities]
        if len(set(names)) < len(names):
            raise ValueError("two filler_densities have the same name")
        for reading in self.filler_densities:
            self.analysis(reading)
        return self

    @classmethod
    def example(cls) -> Self:
        """Lingstat as the thesis weighed it."""
        return cls(sample_mass=21.158e-6, filler_mass=4.2083e-6)

    def analysis(self, reading: FillerDensity) -> Thermogravimetry:
        """Masses and densities in one reading.

        Raises
        ------
        CaseError
            If nothing burnt, or the filler would fill more than spheres can.
        """
        return Thermogravimetry(
            sample_mass=self.sample_mass,
            filler_mass=self.filler_mass,
            mass_resolution=self.mass_resolution,
            filler_density=reading.density,
            matrix_density=self.matrix_density,
            filler_density_deviation=reading.deviation,
            matrix_density_deviation=self.matrix_density_deviation,
        )

    def begin(self) -> Course:
        """One step for every reading of the density."""
        analyses = [self.analysis(reading) for reading in self.filler_densities]
        steps = [StepRecord(number, 0, 0.0, self._values(analysis)) for number, analysis in enumerate(analyses, 1)]
        readings = (
            DensityReading(name=reading.name, contributions=analysis.contributions())
            for reading, analysis in zip(self.filler_densities, analyses, strict=True)
        )
        return Course.computed(
            Findings(
                f"{len(analyses)} readings of the density",
                steps,
                quantities=self._quantities(steps),
                assumptions=self._assumptions(),
                warnings=self._warnings(steps),
                scene=ThermogravimetryScene(readings=tuple(readings), matrix_density=self.matrix_density),
            )
        )

    def _values(self, analysis: Thermogravimetry) -> dict[str, float]:
        fraction, deviation = analysis.volume_fraction, analysis.volume_fraction_deviation
        separation, decay = particle_separation(self.particle_diameter, fraction), tunnelling_decay(self.barrier)
        slope = abs(particle_separation(self.particle_diameter, fraction * (1 + STEP)) - separation) / (fraction * STEP)
        values = [analysis.filler_density, analysis.mass_fraction, analysis.mass_fraction_deviation, fraction, deviation]
        values += [separation, slope * deviation, decay * separation, decay * slope * deviation]
        return dict(zip(self.history_units, values, strict=True))

    def _quantities(self, steps: list[StepRecord]) -> dict[str, Quantity]:
        words = {
            "volume_fraction": "fraction of the filler by volume",
            "separation": "s0 of eq. 2.1.8",
            "exponent": "gamma s0: fall of the resistance with strain",
        }
        names = ", ".join(reading.name for reading in self.filler_densities)
        quantities = {
            "matrix_mass": Quantity(self.sample_mass - self.filler_mass, "kg", "mass of what burnt"),
            "mass_fraction": Quantity(steps[0].values["mass_fraction"], "1", "fraction of the filler by mass"),
            "mass_fraction_deviation": Quantity(steps[0].values["mass_fraction_deviation"], "1", "its standard uncertainty"),
        }
        for name, meaning in words.items():
            for suffix, ending in (("", ""), ("_deviation", ", standard uncertainty")):
                column, unit = [step.values[name + suffix] for step in steps], self.history_units[name + suffix]
                quantities[name + suffix] = Quantity(column, unit, f"{meaning}{ending} [{names}]")
        return quantities

    def _assumptions(self) -> tuple[str, ...]:
        digit = format_quantity(self.mass_resolution, "kg")
        return (
            f"what remains is filler alone, and the matrix left nothing; the balance shows {digit}",
            "equal spheres on a cubic lattice (eq. 2.1.8)",
        )

    def _warnings(self, steps: list[StepRecord]) -> tuple[str, ...]:
        fractions = [step.values["volume_fraction"] for step in steps]
        spread, known = max(fractions) - min(fractions), max(step.values["volume_fraction_deviation"] for step in steps)
        if spread <= 2 * known:
            return ()
        apart = f", {spread / known:.3g} times the standard uncertainty" if known else ""
        return (
            f"the readings of the density give {min(fractions):.4g} to {max(fractions):.4g}{apart}: which density is meant "
            "decides, not the weighing (erratum E27)",
        )
