"""What a timed indentation reports: history, comparison with the closed form, quantities and fields."""

from __future__ import annotations

import math
import time
from typing import ClassVar

import numpy as np

from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.experiments.indentation.contact_record import (
    contact_assumptions,
    contact_oddities,
    contact_values,
    elliptic_points,
    section_frame,
    tissue_rise,
)
from tactsim.experiments.indentation.scene import TimedIndentationScene
from tactsim.experiments.indentation.timed_path import TimedIndentationPath
from tactsim.experiments.indentation.timed_setup import TimedIndentationSetup
from tactsim.materials.viscoelasticity import shear_compliance
from tactsim.mechanics.contact_quality import ContactQuality
from tactsim.mechanics.history_path import TimedState
from tactsim.mechanics.section_model import IndentationModel
from tactsim.mechanics.solver_report import solver_report
from tactsim.mechanics.success import judged
from tactsim.results.result import FieldFrame, Quantity, Result, Status, StepRecord
from tactsim.units import format_quantity

SMALL = 0.01
"""Displacement over the body's radius up to which a linear closed form is meant."""


class TimedRecord:
    """Collects accepted steps and turns them into a result."""

    UNITS: ClassVar[dict[str, str]] = {
        "time": "s",
        "displacement": "m",
        "reaction_force": "N",
        "tissue_rise": "m",
        "tissue_rise_axis": "m",
        "base_force": "N",
        "max_penetration": "m",
        "max_pressure": "Pa",
        "min_volume_ratio": "1",
        "unstable_volume_fraction": "1",
        **ContactQuality.UNITS,
        "closed_form_displacement": "m",
        "closed_form_force": "N",
        "closed_form_difference": "1",
    }

    def __init__(self, experiment: TimedIndentationSetup, model: IndentationModel, path: TimedIndentationPath, begin: float):
        self.experiment, self.model, self._path, self._begin = experiment, model, path, begin
        self.steps: list[StepRecord] = []
        self._quality = ContactQuality()
        self.touched = False
        self._kept: list[TimedState] = []
        self._unstable = np.zeros(model.body.points.weights.shape, bool)
        self._closed_form = closed_form_of(experiment)
        self._history = experiment.loading.history()
        self._setup_time = time.perf_counter() - begin

    def rise(self, state: TimedState) -> tuple[float, float]:
        """Largest height of the tissue in the hole above the annulus's face, and the height on the axis, in m."""
        return tissue_rise(self.model, state.contact, self.experiment.body, self._path.height)

    def accept(self, state: TimedState, *, touched: bool) -> StepRecord:
        """Record an accepted state."""
        record = StepRecord(len(self.steps) + 1, state.iterations, state.contact.residual, self._values(state))
        self.steps.append(record)
        self.touched |= touched
        self._kept = [*self._kept[:1], state]
        return record

    def _values(self, state: TimedState) -> dict[str, float]:
        self._unstable |= ~elliptic_points(self.model, state.contact)
        weights = self.model.body.points.weights
        found, _ = contact_values(self.model, state.contact, state.past)
        values = {"time": state.time, **found}
        values["unstable_volume_fraction"] = float(weights[self._unstable].sum() / weights.sum())
        values |= self._quality.values(self.model.body, state.contact)
        if self.experiment.body.kind == "annulus":
            values["tissue_rise"], values["tissue_rise_axis"] = self.rise(state)
        if self._closed_form is not None:
            values |= self._compared(state, values)
        return values

    def _compared(self, state: TimedState, values: dict[str, float]) -> dict[str, float]:
        """What the closed form says at this time, and the relative difference of the answer."""
        closed_form = self._closed_form
        if closed_form is None:
            return {}
        now = np.array([state.time])
        if self.experiment.loading.control == "displacement":
            force, displacement = float(closed_form.force(self._history, now)[0]), state.loads[0]
            difference = values["reaction_force"] / force - 1 if force else math.nan
        else:
            displacement, force = float(closed_form.displacement(self._history, now)[0]), state.loads[0]
            difference = values["displacement"] / displacement - 1 if displacement else math.nan
        return {"closed_form_displacement": displacement, "closed_form_force": force, "closed_form_difference": difference}

    def result(self, status: Status, reason: str) -> Result:
        """The result with everything that was accepted; no success if the last state is none."""
        status, reason = judged(status, reason, self.steps[-1:], self.experiment.tolerance)
        return Result(
            kind="timed_indentation",
            status=status,
            reason=reason,
            quantities=self._quantities(),
            assumptions=tuple(self._assumptions()),
            warnings=tuple(self._warnings()),
            timing={"setup": self._setup_time, "total": time.perf_counter() - self._begin},
            steps=tuple(self.steps),
            units=self.UNITS,
            frames=self._frames(),
            scene=self._scene(),
        )

    def _quantities(self) -> dict[str, Quantity]:
        if not self.steps:
            return {}
        last, series = self.steps[-1].values, [step.values for step in self.steps]
        told = {
            "time": "time of the last accepted step",
            "displacement": "displacement of the body from first touch, at the last accepted step",
            "reaction_force": "force of the tissue on the body, along the axis, at the last accepted step",
            "base_force": "force on the base, along the axis, at the last accepted step",
            "tissue_rise": "largest height of the tissue in the hole above the face of the annulus, at the last accepted step",
            "tissue_rise_axis": "height of the tissue on the axis above the face of the annulus, at the last accepted step",
            "unstable_volume_fraction": "part of the volume outside strong ellipticity at any accepted step",
        }
        found = {name: Quantity(last[name], self.UNITS[name], text) for name, text in told.items() if name in last}
        for name in ("max_penetration", "reaction_force", "displacement"):
            most = max(values[name] for values in series)
            key = name if name.startswith("max") else f"largest_{name}"
            found[key] = Quantity(most, self.UNITS[name], f"{name.replace('_', ' ')}, the largest of any accepted step")
        found |= self._quality.quantities(self.steps)
        if self.touched:
            found["time_of_touch"] = Quantity(last["time"], "s", "time at which the tissue touches the inner sensor")
        if self._closed_form is not None:
            first = self.experiment.time.earliest or 0.0
            worst = max((abs(v["closed_form_difference"]) for v in series if v["time"] >= first), default=math.nan)
            words = "largest relative difference from the closed form, from time.earliest on"
            found["closed_form_difference"] = Quantity(worst, "1", words)
        return found

    def _assumptions(self) -> list[str]:
        told = contact_assumptions(self.experiment)
        told.append(f"estimated error of the stress in time below {self.experiment.time.tolerance:g} of its size")
        if self.experiment.compare is not None:
            told.append(f"closed form: linear, frictionless annulus on a {self.experiment.compare.replace('_', '-')}")
        return told

    def _warnings(self) -> list[str]:
        if not self.steps:
            return []
        experiment, last, warnings = (
            self.experiment,
            self.steps[-1].values,
            self._quality.warnings() + contact_oddities(self.experiment),
        )
        share = last["unstable_volume_fraction"]
        if share > 0:
            warnings.append(f"{share:.1%} of the volume left strong ellipticity: there the answer depends on the mesh")
        highest = max(step.values.get("tissue_rise", 0.0) for step in self.steps)
        if experiment.recess is not None and experiment.stop == "end" and highest >= experiment.recess:
            recess = format_quantity(experiment.recess, "m")
            warnings.append(f"the tissue rose beyond the recess of {recess}; the inner sensor's contact is not part of this run")
        deepest = max(step.values["displacement"] for step in self.steps)
        if self._closed_form is not None and deepest > SMALL * experiment.contact_radius:
            part = deepest / experiment.contact_radius
            warnings.append(f"the displacement reached {part:.2g} of the radius; the closed form is meant for up to {SMALL:g}")
        return warnings

    def _frames(self) -> tuple[FieldFrame, ...]:
        """Fields at the first and at the last accepted step."""
        return tuple(
            section_frame(
                self.model, state.contact, time=state.time, isochoric=None if state.memory is None else state.memory.stress
            )
            for state in self._kept
        )

    def _scene(self) -> TimedIndentationScene:
        experiment = self.experiment
        return TimedIndentationScene(
            body=experiment.body,
            starting_height=self._path.height,
            recess=experiment.recess,
            solver=solver_report(self.model.problem, self.steps, rejected_steps=self._path.rejected),
            control=experiment.loading.control,
            compare=experiment.compare,
        )


def closed_form_of(experiment: TimedIndentationSetup) -> ViscoelasticAnnulus | None:
    """The closed form that the case asks to compare with, with the small-strain moduli of its material."""
    if experiment.compare is None:
        return None
    specimen = experiment.specimen
    layer = experiment.compare == "layer"
    return ViscoelasticAnnulus(
        outer_radius=experiment.contact_radius,
        radius_ratio=float(getattr(experiment.body, "inner_radius", 0.0)) / experiment.contact_radius,
        shear_compliance=shear_compliance(specimen.material),
        radius_over_thickness=experiment.contact_radius / specimen.thickness if layer else 0.0,
        base="bonded" if specimen.base == "fixed" else "slipping",
    )
