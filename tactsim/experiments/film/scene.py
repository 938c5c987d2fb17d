"""What the experiments on a film report beside quantities and history."""

from __future__ import annotations

from typing import Literal

from tactsim.model import FrozenModel
from tactsim.results.scene import Scene


class FilmTestScene(Scene):
    """When the film was read, and, of a composite, its standard linear solid at each force."""

    kind: Literal["film_test"] = "film_test"
    reading_time: float
    """Time of the reading in s after the force began."""
    coefficients: dict[str, tuple[float, ...]] | None = None
    """``instantaneous`` and ``delayed`` modulus in Pa and ``viscosity`` in Pa s, at every force; null if it is no composite."""


class CreepCurve(FrozenModel):
    """A creep test, thinned for the figure."""

    force: float
    """In N."""
    time: tuple[float, ...]
    """In s."""
    strain: tuple[float, ...]
    """At each time, dimensionless."""


class FilmCreepScene(Scene):
    """The creep tests that were fitted."""

    kind: Literal["film_creep"] = "film_creep"
    tests: tuple[CreepCurve, ...]
    """By force, in the order of the data."""
    area: float
    """Loaded area in m^2."""


class CalibrationScene(Scene):
    """What the errors of a calibration are related to."""

    kind: Literal["calibration"] = "calibration"
    full_scale: float
    """In N."""
    confidence: float
    """Of the band of the line."""


class DensityReading(FrozenModel):
    """A density that the filler was taken to have."""

    name: str
    """Its name."""
    contributions: dict[str, float]
    """Standard uncertainties of the fraction by volume: due to ``masses``, ``filler_density`` and ``matrix_density``."""


class ThermogravimetryScene(Scene):
    """Readings of a thermogravimetric analysis."""

    kind: Literal["thermogravimetry"] = "thermogravimetry"
    readings: tuple[DensityReading, ...]
    """In the order of the steps."""
    matrix_density: float
    """In kg/m^3."""
