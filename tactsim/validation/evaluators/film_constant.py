"""Numbers of a film that follow from its composite."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, Literal, Self

from tactsim.sensors.composite import Composite
from tactsim.sensors.composite_library import AnyComposite, named_composite
from tactsim.sensors.tunnelling import particle_separation, tunnelling_decay
from tactsim.units import Force
from tactsim.validation.evaluator import Evaluator, Inputs

Name = Literal["separation", "decay", "exponent", "initial_resistance", "contact_resistance", "creep_rate"]


class FilmConstant(Evaluator):
    """s0, gamma, gamma s0, R0, both contacts' resistance at a force, or the rate E1 / mu1 of the creep at a force."""

    UNITS: ClassVar[dict[str, str]] = {
        "separation": "m",
        "decay": "1/m",
        "exponent": "1",
        "initial_resistance": "ohm",
        "contact_resistance": "ohm",
        "creep_rate": "1/s",
    }
    kind: Literal["film_constant"] = "film_constant"
    number: Name
    """Which number."""
    composite: AnyComposite = named_composite("lingstat_literal")
    """Name of a shipped composite, or its numbers."""
    force: Force = 1.0
    """Force on the reference area, where the number depends on it."""

    @property
    def found_unit(self) -> str:
        """The SI unit."""
        return self.UNITS[self.number]

    @classmethod
    def example(cls) -> Self:
        """The separation of Lingstat's particles."""
        return cls(number="separation")

    def found(self, inputs: Inputs) -> float:
        """In SI."""
        force = self.force
        known: dict[str, Callable[[Composite], float]] = {
            "separation": lambda c: particle_separation(c.particle_diameter, c.volume_fraction),
            "decay": lambda c: tunnelling_decay(c.barrier),
            "exponent": lambda c: c.exponent,
            "initial_resistance": lambda c: c.initial_resistance,
            "contact_resistance": lambda c: c.contact_resistance / force**0.5,
            "creep_rate": lambda c: c.delayed.at(force) / c.viscosity.at(force),
        }
        return float(known[self.number](self.composite))
