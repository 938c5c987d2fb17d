"""What a durometer reports: the reading with its interval, or that it is off the scale, beside Hertz's contact."""

from __future__ import annotations

import numpy as np

from tactsim.analytic.durometer import ASSUMED, FULL, DurometerScale, hertz_force, hertz_modulus, hertz_reading
from tactsim.experiments.durometer.scene import DurometerScene
from tactsim.experiments.indentation.record import IndentationRecord, StartedPath
from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.materials.moduli import youngs_modulus
from tactsim.mechanics.models.pressed_model import PressedModel
from tactsim.mechanics.paths.history_path import TimedState
from tactsim.results.quantity import Quantity
from tactsim.results.result import Status
from tactsim.units import format_quantity

APART = 0.95
"""The slope of the force is taken from the last step at most this part as deep as the reading."""
WIDE = 12e-3
"""Distance in m from the edge of the specimen that ASTM D2240 asks for; recalled, a declared assumption."""


class DurometerRecord(IndentationRecord):
    """Collects the accepted steps of a durometer, among them the balance of tissue and spring."""

    def __init__(
        self, setup: IndentationSetup, model: PressedModel, path: StartedPath, *, scale: DurometerScale, spring_tolerance: float
    ):
        super().__init__(setup, model, path)
        self.scale, self.spring_tolerance = scale, spring_tolerance
        specimen = setup.specimen
        self.youngs_modulus = youngs_modulus(specimen.materials[0].shear_modulus, specimen.materials[0].bulk_modulus)

    @property
    def balance(self) -> dict[str, float]:
        """History values of the balance of tissue and spring; empty if there is none."""
        return {} if self.event is None else self.event.values

    def kept_as(self, state: TimedState, event: bool) -> tuple[str, ...]:
        """The last state."""
        return ("last",)

    def verdict(self) -> tuple[Status, str]:
        """Status and reason of a path that came to its end."""
        if self.balance:
            reading = float(self.scale.reading(self.balance["displacement"]))
            return Status.CONVERGED, f"tissue and spring balance at a reading of {reading:.2f}"
        borne, asked = self.steps[-1].values["reaction_force"] if self.steps else 0.0, self.scale.force_at_zero
        words = f"the tissue bears {format_quantity(borne, 'N')} of {format_quantity(asked, 'N')} at the whole travel"
        return Status.CONVERGED, f"the indentor bottoms out: {words}, the reading is below 0"

    def threshold(self) -> dict[str, Quantity]:
        """None: the event is the balance."""
        return {}

    def values(self, state: TimedState) -> dict[str, float]:
        """History values of a state in SI, those of the spring and of Hertz beside them."""
        depth = state.contact.load
        hertz = float(hertz_force(depth, self.setup.body.radius, self.youngs_modulus))
        return super().values(state) | {"spring_force": float(self.scale.spring_force(depth)), "hertz_force": hertz}

    def quantities(self) -> dict[str, Quantity]:
        """Reading and modulus, then those of an indentation."""
        inherited = super().quantities()
        radius = self.setup.body.radius
        hertz = hertz_reading(self.youngs_modulus, self.scale, radius)
        quantities = {
            "hertz_reading": Quantity(
                hertz or 0.0, "1", "reading by Hertz on a half-space of the same modulus; 0 is off the scale"
            )
        }
        quantities["youngs_modulus"] = Quantity(self.youngs_modulus, "Pa", "small-strain Young's modulus of the surface")
        if self.balance:
            quantities = self._reading() | quantities
        elif self._went_all_the_way():
            quantities = {
                "reading": Quantity(0.0, "1", "reading of an indentor that bottoms out: the true one is below 0")
            } | quantities
            quantities["bottoms_out"] = Quantity(1, "1", "1 where the tissue does not bear the spring at the whole travel")
        return quantities | inherited

    def _went_all_the_way(self) -> bool:
        return bool(self.steps) and self.steps[-1].values["displacement"] >= self.scale.travel * (1 - 1e-9)

    def _reading(self) -> dict[str, Quantity]:
        """Reading, its interval, and what Hertz would make of it."""
        depth, force = self.balance["displacement"], self.balance["reaction_force"]
        reading = float(self.scale.reading(depth))
        width = self.spring_tolerance / (self._slope(depth, force) * self.scale.travel / FULL + self.scale.force_per_unit)
        modulus = hertz_modulus(reading, self.scale, self.setup.body.radius)
        tolerance = format_quantity(self.spring_tolerance, "N")
        return {
            "reading": Quantity(reading, "1", "reading at which tissue and spring balance"),
            "reading_low": Quantity(max(0.0, reading - width), "1", f"reading with a spring stronger by {tolerance}"),
            "reading_high": Quantity(min(FULL, reading + width), "1", f"reading with a spring weaker by {tolerance}"),
            "bottoms_out": Quantity(0, "1", "1 where the tissue does not bear the spring at the whole travel"),
            "depth": Quantity(depth, "m", "depth of the indentor at the reading"),
            "spring_force": Quantity(force, "N", "force of tissue and spring at the reading"),
            "hertz_modulus": Quantity(modulus, "Pa", "Young's modulus that Hertz makes of the reading"),
        }

    def _slope(self, depth: float, force: float) -> float:
        """Growth of the tissue's force with the depth in N/m at the reading, by a power law from the steps before it."""
        before = [step.values for step in self.steps if step.values["displacement"] <= APART * depth]
        last = before[-1] if before else {"displacement": 0.0, "reaction_force": 0.0}
        if last["reaction_force"] <= 0:
            return force / depth
        exponent = np.log(force / last["reaction_force"]) / np.log(depth / last["displacement"])
        return float(exponent * force / depth)

    def assumptions(self) -> list[str]:
        """Those of an indentation, and what of a real durometer is left out."""
        return [*super().assumptions(), ASSUMED]

    def warnings(self) -> list[str]:
        """Those of an indentation, and what ASTM D2240 says of the reading and of the specimen."""
        warnings = super().warnings()
        if self._went_all_the_way() and not self.balance:
            warnings.append("the reading is below 0: off the scale; the force at the whole travel says more")
        if self.setup.specimen.radius < WIDE:
            given, asked = (format_quantity(value, "m") for value in (self.setup.specimen.radius, WIDE))
            warnings.append(f"the edge of the specimen is {given} away; ASTM D2240 asks for {asked}")
        return warnings

    def scene(self) -> DurometerScene:
        """That of an indentation, with the scale."""
        return DurometerScene(**self._pressed(), scale=self.scale, youngs_modulus=self.youngs_modulus)
