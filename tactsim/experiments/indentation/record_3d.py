"""What an indentation in space reports: history, quantities, fields, assumptions and warnings."""

from __future__ import annotations

import time
from typing import ClassVar

import numpy as np

from tactsim.experiments.indentation.contact_record import contact_assumptions, contact_oddities
from tactsim.experiments.indentation.scene import Indentation3dScene
from tactsim.experiments.indentation.setup_3d import SpaceIndentationSetup
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact_quality import ContactQuality
from tactsim.mechanics.ellipticity import elliptic_in
from tactsim.mechanics.solid_fields import solid_frame
from tactsim.mechanics.solid_model import SpaceIndentationModel
from tactsim.mechanics.solver_report import solver_report
from tactsim.mechanics.success import judged
from tactsim.results.result import Quantity, Result, Status, StepRecord
from tactsim.units import format_quantity

Array = np.ndarray

TOLD = {
    "displacement": "displacement of the body from first touch, downwards",
    "reaction_force": "force of the whole tissue on the body, upwards",
    "base_force": "force on the base, upwards",
    "tissue_rise": "largest height of the tissue in the hole above the face of the annulus, along its axis",
    "tissue_rise_axis": "height of the surface node nearest to the axis of the annulus above its face",
    "sensor_force": "force of the tissue on the inner sensor, upwards",
}
VECTORS = {
    "force_vector": ("N", "force (x, y, z) of the whole tissue on the body"),
    "moment_vector": ("N m", "moment (x, y, z) of this force about the middle of the body's face"),
}


class SpaceIndentationRecord:
    """Collects accepted steps and turns them into a result."""

    UNITS: ClassVar[dict[str, str]] = {
        "displacement": "m",
        "reaction_force": "N",
        "force_x": "N",
        "force_y": "N",
        "moment_x": "N m",
        "moment_y": "N m",
        "moment_z": "N m",
        "tissue_rise": "m",
        "tissue_rise_axis": "m",
        "sensor_force": "N",
        "base_force": "N",
        "max_penetration": "m",
        "max_pressure": "Pa",
        "min_volume_ratio": "1",
        "unstable_volume_fraction": "1",
        **ContactQuality.UNITS,
    }

    def __init__(self, experiment: SpaceIndentationSetup, model: SpaceIndentationModel, begin: float):
        self.experiment, self.model, self.begin = experiment, model, begin
        self.starting_height = 0.0
        self.steps: list[StepRecord] = []
        self.reported: dict[str, StepRecord] = {}
        self._quality = ContactQuality()
        self.threshold: dict[str, float] = {}
        self.rejected_steps = 0
        self._kept: dict[str, ContactEquilibrium] = {}
        self._unstable = np.zeros(model.body.points.weights.shape, bool)
        self._setup_time = time.perf_counter() - begin

    @property
    def has_threshold(self) -> bool:
        """Whether the tissue has touched the inner sensor."""
        return bool(self.threshold)

    def rise(self, state: ContactEquilibrium) -> tuple[float, float]:
        """Largest height of the tissue in the hole above the annulus's face, and the height on its axis, in m."""
        return self.model.highest(state.unknowns, state.contacts[0], self.experiment.body.inner_radius)

    def accept(self, state: ContactEquilibrium, *, threshold: bool) -> StepRecord:
        """Record an accepted state."""
        values = self._values(state)
        record = StepRecord(len(self.steps) + 1, state.iterations, state.residual, values)
        self.steps.append(record)
        self.reported = {"threshold": record} if threshold else self.reported | {"last": record}
        self._kept["threshold" if threshold else "last"] = state
        if threshold:
            self.threshold = values
        return record

    def _values(self, state: ContactEquilibrium) -> dict[str, float]:
        model, weights = self.model, self.model.body.points.weights
        self._unstable |= ~elliptic_in(self.model.body, state.kinematics)
        touches = [contact.at(model.displacement(state.unknowns)) for contact in state.contacts]
        force, moment = model.load_on(state.contacts[0], state.unknowns)
        values = {
            "displacement": state.load,
            "reaction_force": float(force[2]),
            "force_x": float(force[0]),
            "force_y": float(force[1]),
            **{f"moment_{axis}": float(part) for axis, part in zip("xyz", moment, strict=True)},
            "base_force": float(model.base_force(state.unknowns)[2]),
            "max_penetration": max(0.0, *(float(-touch.gap.min()) for touch in touches)),
            "max_pressure": max(float(touch.pressure.max()) for touch in touches),
            "min_volume_ratio": float(state.kinematics.J.min()),
            "unstable_volume_fraction": float(weights[self._unstable].sum() / weights.sum()),
            **self._quality.values(self.model.body, state),
        }
        if self.experiment.recess is not None:
            rise, axis = self.rise(state)
            further = sum(float(model.load_on(contact, state.unknowns)[0][2]) for contact in state.contacts[1:])
            values |= {"tissue_rise": rise, "tissue_rise_axis": axis, "sensor_force": further}
        return values

    def result(self, status: Status, reason: str) -> Result:
        """The result with everything that was accepted; no success if a reported state is none."""
        status, reason = judged(status, reason, self.reported.values(), self.experiment.tolerance)
        kept = sorted(self._kept.values(), key=lambda state: state.load)
        return Result(
            kind="indentation_3d",
            status=status,
            reason=reason,
            quantities=self._quantities(kept[-1]) if kept else {},
            assumptions=tuple(contact_assumptions(self.experiment)),
            warnings=tuple(self._warnings()),
            timing={"setup": self._setup_time, "total": time.perf_counter() - self.begin},
            steps=tuple(self.steps),
            units=self.UNITS,
            frames=tuple(solid_frame(self.model.mesh, self.model.body, state, time=state.load) for state in kept),
            scene=self._scene(),
        )

    def _quantities(self, state: ContactEquilibrium) -> dict[str, Quantity]:
        last = self.steps[-1].values
        found = {name: Quantity(last[name], self.UNITS[name], text) for name, text in TOLD.items() if name in last}
        for (name, (unit, text)), value in zip(
            VECTORS.items(), self.model.load_on(state.contacts[0], state.unknowns), strict=True
        ):
            found[name] = Quantity(value.tolist(), unit, text)
        deepest = max(step.values["max_penetration"] for step in self.steps)
        found["max_penetration"] = Quantity(deepest, "m", "largest penetration at any surface point in any step")
        share = last["unstable_volume_fraction"]
        found["unstable_volume_fraction"] = Quantity(share, "1", "part of the volume outside strong ellipticity at any step")
        found |= self._quality.quantities(self.steps)
        if self.experiment.body.kind == "annulus":
            sectors = 4 * self.experiment.mesh.sectors
            around = self.model.surroundings(state.contacts[0], state.unknowns, sectors) / (self.experiment.body.area / sectors)
            text = "force along the annulus's axis over its area, by equal sectors of the angle about it, from its x axis on"
            found["pressure_around"] = Quantity(around.tolist(), "Pa", text)
        if self.threshold:
            force, area = self.threshold["reaction_force"], self.experiment.body.area
            found["threshold_force"] = Quantity(force, "N", "force on the annulus when the tissue touches the inner sensor")
            found["threshold_pressure"] = Quantity(force / area, "Pa", "threshold force over the annular area")
            found["threshold_displacement"] = Quantity(self.threshold["displacement"], "m", "displacement at the threshold")
        return found

    def _warnings(self) -> list[str]:
        told = self._quality.warnings() + contact_oddities(self.experiment)
        share = self.steps[-1].values["unstable_volume_fraction"] if self.steps else 0.0
        if share == 0:
            return told
        first = next(step for step in self.steps if step.values["unstable_volume_fraction"] > 0)
        at = format_quantity(first.values["displacement"], "m")
        return [
            *told,
            f"{share:.1%} of the volume left strong ellipticity, first at a displacement of {at}: "
            "there the answer depends on the mesh; take a stable material set",
        ]

    def _scene(self) -> Indentation3dScene:
        experiment = self.experiment
        return Indentation3dScene(
            body=experiment.posed_body,
            starting_height=self.starting_height,
            recess=experiment.recess,
            solver=solver_report(self.model.problem, self.steps, rejected_steps=self.rejected_steps),
            symmetry=experiment.symmetry.name.lower(),
            offset=experiment.offset,
        )
