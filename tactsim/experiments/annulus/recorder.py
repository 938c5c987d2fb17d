"""The annulus in closed form."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.experiments.recording import history
from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import Values
from tactsim.interfaces.variable import Variable, label, reading
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.results.result import Result
from tactsim.sensors.force_reading import READ

HISTORY = {"displacement": ("m", "displacement of the annulus"), "force": ("N", "force on the annulus, without noise")}


class ClosedFormRecorder(Recorder):
    """Geometry and moduli; displacement and force over time, and what a sensor reads of the force."""

    kind: Literal["closed_form"] = "closed_form"
    histories: ClassVar = True
    reads_force: ClassVar = True
    quantities: ClassVar = {
        "largest_displacement": ("m", "largest displacement"),
        "largest_force": ("N", "largest force"),
        "tissue_rise_axis": ("m", "height of the tissue on the axis above the face at the end"),
        "force_factor": ("1", "kappa = P / (8 G a eps)"),
        "rise_factor": ("1", "height of the tissue on the axis over the displacement"),
    }

    def labels_of(self, experiment: Experiment) -> list[Variable]:
        """Radii and moduli."""
        variables = {
            "inner_radius": ("m", "inner radius of the annulus"),
            "outer_radius": ("m", "outer radius of the annulus"),
            "instantaneous_shear_modulus": ("Pa", "shear modulus of the tissue at once"),
            "equilibrium_shear_modulus": ("Pa", "shear modulus of the tissue after a long time"),
        }
        return [label(name, unit, words) for name, (unit, words) in variables.items()]

    def labels(self, experiment: ClosedForm) -> Values:
        """Values of these labels."""
        relaxation = shear_relaxation(experiment.material)
        values = (
            experiment.inner_radius,
            experiment.outer_radius,
            relaxation.instantaneous_modulus,
            relaxation.equilibrium_modulus,
        )
        return {v.name: np.array(value) for v, value in zip(self.labels_of(experiment), values, strict=True)}

    def readings_of(self, experiment: Any) -> list[Variable]:
        """Histories."""
        variables = {"time_s": ("s", "time since the beginning"), **HISTORY, **(READ if self.settings.reading else {})}
        times, given = self.settings.times, experiment.loading.control
        return [reading(name, unit, words, prescribed=name == given, time=times) for name, (unit, words) in variables.items()]

    def readings(self, experiment: ClosedForm, result: Result, generator: np.random.Generator) -> Values:
        """As the closed form has them at the stored times; a sensor reads a force that is straight between these and those that
        the experiment samples."""
        times, columns = history(result)
        at = self.settings.stored_times(float(times[-1]))
        displacement, force = experiment.course(at)
        if self.settings.reading:
            both, first = np.unique(np.concatenate([times, at]), return_index=True)
            read = self.settings.reading.read(both, np.concatenate([columns["force"], force])[first], at, generator)
        else:
            read = {}
        return {"time_s": at, "displacement": displacement, "force": force, **read}

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A rigid, frictionless annulus on linear viscoelastic, incompressible tissue under a prescribed history, "
            "in closed form (small displacements, bilateral contact)."
        )
