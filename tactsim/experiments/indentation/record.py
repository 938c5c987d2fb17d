"""What an indentation reports, in any dimension, with a clock or without: history, quantities, fields, assumptions, warnings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from tactsim.analytic.annular_area import annular_area
from tactsim.experiments.indentation.comparison import Comparison
from tactsim.experiments.indentation.history import SPACE, THRESHOLD, UNITS
from tactsim.experiments.indentation.scene import (
    ContactProfile,
    Indentation3dScene,
    IndentationScene,
    PressedBodyScene,
    TimedIndentationScene,
)
from tactsim.experiments.indentation.setup import IndentationSetup, Timed
from tactsim.materials.library import set_with_constants_of
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.models.pressed_model import PressedModel
from tactsim.mechanics.models.solid_model import SolidModel
from tactsim.mechanics.outcome.contact_history import LAST
from tactsim.mechanics.outcome.contact_quality import FINER
from tactsim.mechanics.outcome.contact_record import (
    ERROR_IN_TIME,
    UNPRINTED,
    ContactRecord,
    FollowedPath,
    penetration_allowed,
    solver_report,
)
from tactsim.mechanics.paths.history_path import TimedState
from tactsim.mesh.adaptation import Refinement
from tactsim.results.quantity import Quantity
from tactsim.results.result import Status
from tactsim.units import format_quantity

SMALL = 0.01
"""Displacement over the body's radius up to which a linear closed form is meant."""
AT_LAST = {
    "time": "time",
    "displacement": "displacement of the body from first touch",
    "reaction_force": "force of the tissue on the body, along the axis",
    "base_force": "force on the base, along the axis",
    "tissue_rise": "largest height of the tissue in the hole above the face of the annulus",
    "tissue_rise_axis": "height of the tissue on the axis of the annulus above its face",
    "sensor_force": "force of the tissue on the inner sensor",
}
"""Quantities that are history values of the last step, and their words; the axis is that of the specimen."""


class StartedPath(FollowedPath, Protocol):
    """A path that knows where it began."""

    @property
    def start(self) -> ContactEquilibrium:
        """The undeformed tissue at first touch."""


class IndentationRecord(ContactRecord[PressedModel]):
    """Collects the accepted steps of an indentation."""

    def __init__(self, setup: IndentationSetup, model: PressedModel, path: StartedPath):
        super().__init__(model, path, tolerance=setup.tolerance)
        drive = setup.drive()
        self.setup, self.adaptations, self._start, self._posed = setup, 0, path.start, setup.posed()
        self._drive, self._clock = drive, drive if isinstance(drive, Timed) else None
        self._comparison = None if self._clock is None or self._clock.compare is None else Comparison(setup, self._clock)

    def adapted(self, model: PressedModel, split: Refinement) -> None:
        """Go on with a refined model."""
        self.quality.refined(self.model.body, split)
        self.model = model
        self.adaptations += 1

    def values(self, state: TimedState) -> dict[str, float]:
        """History values of a state in SI."""
        model, contact = self.model, state.contact
        forces = [model.force(one.state.traction) for one in contact.contacts]
        values = {} if self._clock is None else {"time": state.time}
        values |= {
            "displacement": contact.load,
            "reaction_force": float(forces[0][-1]),
            "base_force": float(model.base_force(contact)[-1]),
            "max_penetration": contact.penetration,
            "max_pressure": max(float(one.state.pressure.max()) for one in contact.contacts),
            **self.quality.values(model.body, contact),
        }
        if isinstance(model, SolidModel):
            moment = model.moment(contact.contacts[0], contact.unknowns)
            values |= dict(zip(SPACE, map(float, (*forces[0][:2], *moment)), strict=True))
        if hole := self.setup.hole:
            values["tissue_rise"], values["tissue_rise_axis"] = model.rise(contact, hole)
            if self._clock is None:
                values["sensor_force"] = float(sum(force[-1] for force in forces[1:]))
        if self._comparison is not None:
            values |= self._comparison.values(state.time, state.loads[0], values)
        return values

    def kept_as(self, state: TimedState, event: bool) -> Sequence[str]:
        """The last state, and with a clock the first, without one that of the threshold."""
        if self._clock is None:
            return ("threshold",) if event else ("last",)
        return ("last",) if self._kept else ("first", "last")

    def verdict(self) -> tuple[Status, str]:
        """Status and reason, by whether the tissue touched the inner sensor and what the case asks for."""
        return self._drive.ending(touched=self.event is not None)

    def quantities(self) -> dict[str, Quantity]:
        """Quantities of at least one step."""
        last = self.steps[-1].values
        quantities = {name: Quantity(last[name], UNITS[name], text + LAST) for name, text in AT_LAST.items() if name in last}
        quantities |= super().quantities()
        if isinstance(self.model, SolidModel):
            quantities |= self._around(self.model)
        return quantities | (self.threshold() if self._clock is None else self._over_time(self._clock))

    @property
    def _face_area(self) -> float:
        """Area in m^2 of the face around the hole, which the thesis divides the threshold force by."""
        return annular_area(self.setup.hole, self.setup.contact_radius)

    def threshold(self) -> dict[str, Quantity]:
        """What holds when the tissue touches the inner sensor, if it does."""
        if self.event is None:
            return {}
        force, displacement = (self.event.values[name] for name in ("reaction_force", "displacement"))
        values = (force, force / self._face_area, displacement)
        return {name: Quantity(value, *words) for value, (name, words) in zip(values, THRESHOLD.items(), strict=True)}

    def _around(self, model: SolidModel) -> dict[str, Quantity]:
        """Vectors of force and moment at the last kept state, and the pressure around an annulus."""
        state = self._latest().state
        contact, unknowns = state.contact.contacts[0], state.contact.unknowns
        force = model.force(contact.state.traction)
        moment = model.moment(contact, unknowns)
        quantities = {
            "force_vector": Quantity(force.tolist(), "N", "force (x, y, z) of the whole tissue on the body"),
            "moment_vector": Quantity(
                moment.tolist(), "N m", "moment (x, y, z) of this force about the middle of the body's face"
            ),
        }
        if self.setup.hole:
            sectors = self._posed.sectors
            around = model.surroundings(contact, unknowns, sectors) / (self._face_area / sectors)
            text = "axial force over area, by equal sectors of the angle about the annulus's axis, from its x axis on [sector]"
            quantities["pressure_around"] = Quantity(around.tolist(), "Pa", text)
        return quantities

    def _over_time(self, clock: Timed) -> dict[str, Quantity]:
        """Quantities over the whole history."""
        series, extremes = [step.values for step in self.steps], {}
        for name in ("reaction_force", "displacement"):
            most = max(values[name] for values in series)
            text = f"{name.replace('_', ' ')}, the largest of any accepted step"
            extremes[f"largest_{name}"] = Quantity(most, UNITS[name], text)
        if self.event is not None:
            time = self.event.values["time"]
            extremes["time_of_touch"] = Quantity(time, "s", "time at which the tissue touches the inner sensor")
        if self._comparison is not None:
            counted = [v for v in series if v["time"] >= clock.compared_from]
            worst = max((abs(values["closed_form_difference"]) for values in counted), default=math.nan)
            words = "largest relative difference from the closed form, from time.earliest on"
            extremes["closed_form_difference"] = Quantity(worst, "1", words)
        return extremes

    def assumptions(self) -> list[str]:
        """What the thesis does not print and the case chose."""
        assumptions = [*specimen_assumptions(self.setup), penetration_allowed(self.tolerance)]
        if self._drive.stops_at_touch:
            assumptions += energy_assumptions(self.setup)
        if self._clock is not None:
            assumptions.append(ERROR_IN_TIME.format(self._clock.policy.settings.tolerance))
            if self._clock.compare is not None:
                assumptions.append(f"closed form: linear, frictionless annulus on a {self._clock.compare.replace('_', '-')}")
        return assumptions

    def warnings(self) -> list[str]:
        """Warnings about volumes and ellipticity, and of a history that leaves what it is meant for."""
        warnings = super().warnings()
        if not self.quality.touched:
            warnings.append(f"no point of the surface has touched: so small a contact lies between them; {FINER}")
        if self._clock is not None:
            warnings += self._left_behind([step.values for step in self.steps])
        return warnings

    def _left_behind(self, series: Sequence[Mapping[str, float]]) -> list[str]:
        """Where a history leaves the recess or the closed form behind."""
        setup, warnings = self.setup, []
        highest = max(values.get("tissue_rise", 0.0) for values in series)
        if setup.recess is not None and not self._drive.stops_at_touch and highest >= setup.recess:
            recess = format_quantity(setup.recess, "m")
            warnings.append(f"the tissue rose beyond the recess of {recess}; the inner sensor's contact is not part of this run")
        part = max(values["displacement"] for values in series) / setup.contact_radius
        if self._comparison is not None and part > SMALL:
            warnings.append(f"the displacement reached {part:.2g} of the radius; the closed form is meant for up to {SMALL:g}")
        return warnings

    def scene(self) -> PressedBodyScene:
        """The body and where it touched first."""
        if isinstance(self.model, SolidModel):
            symmetry = self.model.symmetry.name.lower()
            return Indentation3dScene(**self._pressed(), symmetry=symmetry, offset=self._posed.offset)
        if self._clock is not None:
            return TimedIndentationScene(**self._pressed(), control=self._clock.loading.control, compare=self._clock.compare)
        return IndentationScene(**self._pressed(), contact=self._contact())

    def _contact(self) -> ContactProfile | None:
        """The contact pressure along the surface of a section at the last kept state; none before the first."""
        if not self._kept:
            return None
        model, state = (kept := self._latest()).model, kept.state
        displacement = model.displacement(state.contact.unknowns)
        weights, edges = model.points.weights, (-1, model.points.per_facet)
        area = weights.reshape(edges).sum(axis=1)
        pressures = [contact.state.pressure for contact in state.contact.contacts]
        at_points = (model.reference + displacement)[0], np.sum(pressures, axis=0)
        radius, pressure = ((weights * values).reshape(edges).sum(axis=1) / area for values in at_points)
        if not pressure.any():
            return None
        order = np.argsort(radius)
        columns = {"radius": radius, "pressure": pressure, "area": area}
        return ContactProfile(**{name: tuple(values[order].tolist()) for name, values in columns.items()})

    def _pressed(self) -> dict[str, Any]:
        """What every scene of a pressed body has, by name."""
        return {
            "body": self._posed.body,
            "starting_height": float(self._start.contacts[0].place[-1]),
            "recess": self.setup.recess,
            "solver": solver_report(self, mesh_adaptations=self.adaptations),
        }


def specimen_assumptions(setup: IndentationSetup) -> list[str]:
    """What the thesis does not print of specimen and body, and every case chose."""
    specimen, fillet = setup.specimen, setup.body.contact_shape.fillet
    radius, thickness = format_quantity(specimen.radius, "m"), format_quantity(specimen.thickness, "m")
    assumptions = [f"specimen of radius {radius} and thickness {thickness} on a {specimen.base} base {UNPRINTED}"]
    if fillet is not None:
        assumptions.append(f"edges of the body filleted by {format_quantity(fillet, 'm')} {UNPRINTED}")
    if any(material.bulk_modulus is None for material in specimen.materials):
        assumptions.append("exactly incompressible tissue (no bulk modulus is given)")
    return assumptions


def energy_assumptions(setup: IndentationSetup) -> list[str]:
    """What the threshold of a tissue owes to the choice of its energy, where the data are compression alone."""
    sets = {entry.name: entry for material in setup.specimen.materials if (entry := set_with_constants_of(material))}
    return [f"{name} is {entry.left_open}" for name, entry in sorted(sets.items()) if entry.left_open]
