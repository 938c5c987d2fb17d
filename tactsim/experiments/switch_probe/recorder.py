"""A touch by the probe with switches."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.experiments.switch_probe.setup import COUNT
from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import Values
from tactsim.interfaces.variable import Variable, label, reading
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.results.result import Result

LABELS = {
    "rate": ("m/s", "rate of indentation"),
    "depth": ("m", "depth at which the probe turns back"),
    "instantaneous_shear_modulus": ("Pa", "shear modulus of the tissue at once"),
    "equilibrium_shear_modulus": ("Pa", "shear modulus of the tissue after a long time"),
}


class SwitchProbeRecorder(Recorder):
    """Rate and moduli of one touch; when its switches closed, at which force, and the rate that is read from them."""

    kind: Literal["switch_probe"] = "switch_probe"
    noise_seed: ClassVar = ("seed",)

    def labels_of(self, experiment: Experiment) -> list[Variable]:
        """Rate, depth and moduli."""
        return [label(name, unit, words) for name, (unit, words) in LABELS.items()]

    def labels(self, experiment: Any) -> Values:
        """Values of these labels.

        Raises
        ------
        InvalidQuantity
            If a sample is more than one touch.
        """
        if len(experiment.tissues) != 1 or len(experiment.rates) != 1:
            raise InvalidQuantity("a sample of a switch_probe is one touch: one tissue and one rate; let them vary instead")
        moduli = shear_relaxation(experiment.tissues[0].material)
        values = (experiment.rates[0], experiment.depth, moduli.instantaneous_modulus, moduli.equilibrium_modulus)
        return {name: np.array(value) for name, value in zip(LABELS, values, strict=True)}

    def readings_of(self, experiment: Experiment) -> list[Variable]:
        """Forces and switches."""
        return [
            reading("largest_force", "N", "largest force on the probe, without noise"),
            reading("contact_height", "m", "largest height that the tissue touches on the sides", optional=True),
            reading("closed_switches", "1", "switches that closed"),
            reading(
                "switching_time",
                "s",
                "time since the touch at which each switch closed, NaN after the last",
                optional=True,
                switch=COUNT,
            ),
            reading("switching_force", "N", "force read when each switch closed, with noise", optional=True, switch=COUNT),
            reading("mean_rate", "m/s", "rate read from the switches by eq. 5.2.2; NaN if not all closed", optional=True),
        ]

    def readings(self, experiment: Any, result: Result, generator: np.random.Generator) -> Values:
        """Values of these readings."""
        values = {name: quantity.value for name, quantity in result.quantities.items()}
        readings = {name: np.array(values.get(f"{name}_1", np.nan)) for name in ("largest_force", "contact_height", "mean_rate")}
        readings["closed_switches"] = np.array(float(values.get("closed_switches_1", 0)))
        for name in ("switching_time", "switching_force"):
            padded = np.full(COUNT, np.nan)
            closed = np.atleast_1d(np.asarray(values.get(f"{name}s_1", ()), dtype=float))[:COUNT]
            padded[: len(closed)] = closed
            readings[name] = padded
        return readings

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A trapezoidal probe with five switches and a force sensor, pressed into relaxing tissue at a constant rate and "
            "drawn back (thesis, chapter 5)."
        )
