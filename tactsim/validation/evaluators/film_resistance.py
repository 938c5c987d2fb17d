"""Resistance of a film under a constant force, in the readings of eq. 2.3.1."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.sensors.composite_library import AnyComposite, named_composite
from tactsim.sensors.film import Film
from tactsim.sensors.film_equations import Reading, film_resistance
from tactsim.units import Force, Time
from tactsim.validation.evaluator import Evaluator, Inputs


class FilmResistance(Evaluator):
    """Ohm, from the printed or corrected equation, or integrated over the history."""

    unit: ClassVar[str] = "ohm"
    kind: Literal["film_resistance"] = "film_resistance"
    composite: AnyComposite = named_composite("lingstat_identified")
    """Name of a shipped composite, or its numbers."""
    force: Force
    """Constant force on the reference area."""
    time: Time
    """Since it began."""
    reading: Reading | Literal["history"] = "history"
    """Which equation; ``history`` integrates the creep law in 50 steps."""

    @classmethod
    def example(cls) -> Self:
        """The identified Lingstat at 1 N after 1 s."""
        return cls(force=1.0, time=1.0)

    def found(self, inputs: Inputs) -> float:
        """In ohm."""
        if self.reading != "history":
            return float(film_resistance(self.composite, self.force, self.time, reading=self.reading))
        times = [self.time * k / 50 for k in range(51)]
        return float(1 / Film(composite=self.composite).conductance(times, [self.force] * 51)[-1])
