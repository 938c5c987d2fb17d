"""What an indentation reports: history, quantities, fields, assumptions and warnings."""

from __future__ import annotations

import time
from typing import Any, ClassVar

import numpy as np

from tactsim.experiments.indentation.contact_record import (
    contact_assumptions,
    contact_oddities,
    contact_values,
    elliptic_points,
    section_frame,
    tissue_rise,
)
from tactsim.experiments.indentation.scene import IndentationScene, PressedBody
from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact_quality import ContactQuality
from tactsim.mechanics.section_model import IndentationModel
from tactsim.mechanics.solver_report import solver_report
from tactsim.mechanics.success import judged
from tactsim.mesh.adaptation import Refinement
from tactsim.results.result import FieldFrame, Quantity, Result, Status, StepRecord
from tactsim.units import format_quantity

Array = np.ndarray


class IndentationRecord:
    """Collects accepted steps and turns them into a result."""

    UNITS: ClassVar[dict[str, str]] = {
        "displacement": "m",
        "reaction_force": "N",
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

    def __init__(self, experiment: IndentationSetup, model: IndentationModel, begin: float):
        self.experiment, self.model, self.begin = experiment, model, begin
        self.starting_height = 0.0
        self.steps: list[StepRecord] = []
        self.reported: dict[str, StepRecord] = {}
        self._quality = ContactQuality()
        self._at_threshold: list[tuple[IndentationModel, ContactEquilibrium]] = []
        self._last: list[tuple[IndentationModel, ContactEquilibrium]] = []
        self.threshold: dict[str, float] = {}
        self.adaptations = 0
        self.rejected_steps = 0
        self._unstable = np.zeros(model.body.points.weights.shape, bool)
        self._setup_time = time.perf_counter() - begin

    @property
    def has_threshold(self) -> bool:
        """Whether the tissue has touched the inner sensor."""
        return bool(self.threshold)

    def rise(self, state: ContactEquilibrium) -> tuple[float, float]:
        """Largest height of the tissue in the hole above the annulus's face, and the height on the axis, in m."""
        return tissue_rise(self.model, state, self.experiment.body, self.starting_height)

    def adapted(self, model: IndentationModel, split: Refinement) -> None:
        """Go on with a refined model: a child has left ellipticity where the nearest point of its parent has."""
        old = model.body.points.pressure_values.T
        new = np.einsum("ekv,kq->evq", split.barycentric, old)
        nearest = np.linalg.norm(new[:, :, :, None] - old[None, :, None, :], axis=1).argmin(axis=2)
        self._unstable = np.take_along_axis(self._unstable[split.parents], nearest, axis=1)
        self.model = model
        self.adaptations += 1

    def accept(self, state: ContactEquilibrium, *, threshold: bool) -> StepRecord:
        """Record an accepted state."""
        values = self._values(state)
        record = StepRecord(len(self.steps) + 1, state.iterations, state.residual, values)
        self.steps.append(record)
        self.reported = {"threshold": record} if threshold else self.reported | {"last": record}
        if threshold:
            self.threshold, self._at_threshold = values, [(self.model, state)]
        else:
            self._last = [(self.model, state)]
        return record

    def _values(self, state: ContactEquilibrium) -> dict[str, float]:
        self._unstable |= ~elliptic_points(self.model, state)
        weights = self.model.body.points.weights
        values, forces = contact_values(self.model, state)
        values["unstable_volume_fraction"] = float(weights[self._unstable].sum() / weights.sum())
        values |= self._quality.values(self.model.body, state)
        if self.experiment.recess is not None:
            rise, axis = self.rise(state)
            values |= {"tissue_rise": rise, "tissue_rise_axis": axis, "sensor_force": sum(forces[1:])}
        return values

    def _frames(self) -> tuple[FieldFrame, ...]:
        """Fields at the threshold and at the last accepted step, in the order of the displacement."""
        kept = sorted([*self._at_threshold, *self._last], key=lambda pair: pair[1].load)
        return tuple(section_frame(model, state, time=state.load) for model, state in kept)

    def result(self, status: Status, reason: str) -> Result:
        """The result with everything that was accepted; no success if a reported state is none."""
        status, reason = judged(status, reason, self.reported.values(), self.experiment.tolerance)
        total = time.perf_counter() - self.begin
        return Result(
            kind="indentation",
            status=status,
            reason=reason,
            quantities=self._quantities(),
            assumptions=tuple(contact_assumptions(self.experiment)),
            warnings=tuple(self._warnings()),
            timing={"setup": self._setup_time, "total": total},
            steps=tuple(self.steps),
            units=self.UNITS,
            frames=self._frames(),
            scene=self._scene(),
        )

    def _quantities(self) -> dict[str, Quantity]:
        last = self.steps[-1].values if self.steps else {}
        told = {
            "displacement": "displacement of the body from first touch",
            "reaction_force": "force of the tissue on the body, along the axis",
            "base_force": "force on the base, along the axis",
            "tissue_rise": "largest height of the tissue in the hole above the face of the annulus",
            "tissue_rise_axis": "height of the tissue on the axis above the face of the annulus",
            "sensor_force": "force of the tissue on the inner sensor",
        }
        found = {name: Quantity(last[name], self.UNITS[name], text) for name, text in told.items() if name in last}
        if self.steps:
            deepest = max(step.values["max_penetration"] for step in self.steps)
            found["max_penetration"] = Quantity(deepest, "m", "largest penetration at any surface point in any step")
            share = last["unstable_volume_fraction"]
            found["unstable_volume_fraction"] = Quantity(
                share, "1", "part of the volume outside strong ellipticity at any accepted step"
            )
            found |= self._quality.quantities(self.steps)
        if self.threshold:
            force, area = self.threshold["reaction_force"], self.experiment.body.area
            found["threshold_force"] = Quantity(force, "N", "force on the annulus when the tissue touches the inner sensor")
            found["threshold_pressure"] = Quantity(force / area, "Pa", "threshold force over the annular area")
            found["threshold_displacement"] = Quantity(self.threshold["displacement"], "m", "displacement at the threshold")
        return found

    def _warnings(self) -> list[str]:
        if not self.steps:
            return []
        warnings = self._quality.warnings() + contact_oddities(self.experiment)
        share = self.steps[-1].values["unstable_volume_fraction"]
        if share > 0:
            first = next(step for step in self.steps if step.values["unstable_volume_fraction"] > 0)
            at = format_quantity(first.values["displacement"], "m")
            warnings.append(
                f"{share:.1%} of the volume left strong ellipticity, first at a displacement of {at}: "
                "there the answer depends on the mesh; take a stable material set"
            )
        return warnings

    def _scene(self) -> PressedBody:
        return IndentationScene(**self._pressed())

    def _pressed(self) -> dict[str, Any]:
        """What every scene of a pressed body has, by name."""
        return {
            "body": self.experiment.body,
            "starting_height": self.starting_height,
            "recess": self.experiment.recess,
            "solver": solver_report(
                self.model.problem, self.steps, rejected_steps=self.rejected_steps, mesh_adaptations=self.adaptations
            ),
        }
