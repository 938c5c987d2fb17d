"""A semiconductive polymer composite: what its resistance and its creep need to be known."""

from __future__ import annotations

import math
from typing import Any, Self

from pydantic import model_validator

from tactsim.model import FrozenModel
from tactsim.sensors.films.thermogravimetry import FillerFraction, Thermogravimetry
from tactsim.sensors.films.tunnelling import particle_separation, tunnelling_decay
from tactsim.units import (
    Area,
    Energy,
    Force,
    Length,
    NonNegative,
    Positive,
    Pressure,
    PressurePerForce,
    Resistance,
    Viscosity,
    ViscosityPerForce,
)

CREEP_COEFFICIENTS = ("instantaneous", "delayed", "viscosity")
"""Names of the coefficients of the creep: E0 in Pa, E1 in Pa and mu1 in Pa s."""


class ModulusLine(FrozenModel):
    """A modulus of the standard linear solid over the force, E(F) = slope F + intercept."""

    slope: NonNegative[PressurePerForce]
    """Per newton on the reference area."""
    intercept: Positive[Pressure]
    """Without force."""

    def at(self, force: Any) -> Any:
        """Pa, for forces in N on the reference area."""
        return self.slope * force + self.intercept


class ViscosityLine(FrozenModel):
    """The viscosity of the standard linear solid over the force, mu(F) = slope F + intercept."""

    slope: NonNegative[ViscosityPerForce]
    """Per newton on the reference area."""
    intercept: Positive[Viscosity]
    """Without force."""

    def at(self, force: Any) -> Any:
        """Pa s, for forces in N on the reference area."""
        return self.slope * force + self.intercept


class Composite(FrozenModel):
    """Filled polymer between two electrodes, measured on a sensor of ``reference_area``."""

    volume_fraction: FillerFraction
    """Of the filler: a number, or ``{sample_mass: 21.158 mg, filler_mass: 4.2083 mg, ...}`` of a thermogravimetric analysis."""
    particle_diameter: Positive[Length]
    """Of the filler."""
    barrier: Positive[Energy]
    """Potential barrier between two particles."""
    initial_resistance: Positive[Resistance]
    """R0 of the unstrained composite on the reference area."""
    contact_resistance: Positive[Resistance]
    """Of both contacts at a force of 1 N; it falls with the root of the force, whatever the area."""
    instantaneous: ModulusLine
    """E0 over the force."""
    delayed: ModulusLine
    """E1 over the force."""
    viscosity: ViscosityLine
    """mu1 over the force."""
    reference_area: Positive[Area]
    """Active area of the sensor on which the numbers were measured."""
    largest_force: Positive[Force]
    """Largest force on the reference area for which the lines over the force were measured."""
    source: str
    """Where the numbers come from."""

    @property
    def filler_fraction(self) -> float:
        """Volume fraction of the filler, however it is given."""
        given = self.volume_fraction
        return given.volume_fraction if isinstance(given, Thermogravimetry) else given

    @property
    def separation(self) -> float:
        """s0 in m between neighbouring particles."""
        return particle_separation(self.particle_diameter, self.filler_fraction)

    @property
    def exponent(self) -> float:
        """gamma s0: how fast the resistance falls with strain."""
        return tunnelling_decay(self.barrier) * self.separation

    def magnification(self, active_area: float | None) -> float:
        """Reference area over an active area in m^2, dimensionless; 1 for None, which is the reference area."""
        return self.reference_area / (active_area or self.reference_area)

    @model_validator(mode="after")
    def _compressible(self) -> Self:
        for name in ("instantaneous", "delayed"):
            line: ModulusLine = getattr(self, name)
            strain = self.largest_force / (self.reference_area * line.at(self.largest_force))
            if not (math.isfinite(strain) and strain < 0.5):
                raise ValueError(
                    f"{name} gives a strain of {strain:.3g} at the largest_force; allowed: below 0.5 (modulus, area or force?)"
                )
        return self
