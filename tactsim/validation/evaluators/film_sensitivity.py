"""How much a film creeps, how its conductance grows with force, and how far it is from a measured line."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.identification.film_line import identify_film
from tactsim.sensors.calibration import THESIS_LINE
from tactsim.sensors.composite_library import AnyComposite, named_composite
from tactsim.sensors.film import Film
from tactsim.sensors.film_equations import creep_strain, varying_coefficient_jump
from tactsim.units import Force, Time
from tactsim.validation.evaluator import Evaluator, Inputs


class FilmSensitivity(Evaluator):
    """``drift``: relative growth of the conductance until a time; ``exponent``: d ln C / d ln F; ``line_error``: largest relative
    error of the resistance against the line of 3.1.2 from 0.5 to 5 N; ``printed_excess``: how much 2.1.14 with varying
    coefficients strains more than 2.3.1 at once.
    """

    kind: Literal["film_sensitivity"] = "film_sensitivity"
    number: Literal["drift", "exponent", "line_error", "printed_excess"]
    """Which number."""
    composite: AnyComposite = named_composite("lingstat_literal")
    """Name of a shipped composite, or its numbers."""
    force: Force = 1.0
    """Constant force on the reference area."""
    time: Time = 60.0
    """Since it began."""

    @classmethod
    def example(cls) -> Self:
        """Drift of the literal set at 1 N."""
        return cls(number="drift")

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        film = Film(composite=self.composite)
        times = [0.0, self.time]
        if self.number == "drift":
            first, last = film.conductance(times, [self.force] * 2)
            return float(last / first - 1)
        if self.number == "exponent":
            conductance = film.conductance([0.0], [self.force])[0]
            return float(film.sensitivity([0.0], [self.force])[0] * self.force / conductance)
        if self.number == "line_error":
            return float(np.abs(identify_film(self.composite, (THESIS_LINE.slope, THESIS_LINE.intercept)).errors).max())
        jump = varying_coefficient_jump(self.composite, self.force)
        return float(jump / creep_strain(self.composite, self.force, 0.0) - 1)
