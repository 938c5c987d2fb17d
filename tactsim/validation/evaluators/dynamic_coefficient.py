"""The coefficients of the response to the static and the harmonic load, eq. 4.7.2."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.units import Force
from tactsim.validation.atrial_units import truncated, units_by_speed
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.evaluators.load_transform import DELAY, FREQUENCY, STATIC

OMEGA = 2 * np.pi * FREQUENCY
STEP = 0.01e-6
"""Last digit that the thesis writes, 0.01 N/MPa, in N/Pa."""
DYNAMIC = ("cosine", "sine", "first", "second", "slow")


class DynamicCoefficient(Evaluator):
    r"""A coefficient of 4 ro kappa eps0 in N/Pa; 4.7.2 prints N/MPa. With x_i = 1 / tau_i, amplitude A, static force F:

    .. math::
        -A \sum_i \frac{J_i \omega x_i}{\omega^2 + x_i^2} \text{ (cosine)}, \quad
        A \Big(J_0 + \sum_i \frac{J_i x_i^2}{\omega^2 + x_i^2}\Big) \text{ (sine)}, \quad
        \frac{A J_i \omega x_i e^{2 x_i}}{\omega^2 + x_i^2}, \quad -F J_i, \quad F \Big(J_0 + \sum_i J_i\Big)

    ``first`` and ``second`` are the transients of the two fast units, ``slow`` those of the six slow ones together, at 2 s;
    ``static_first`` and ``static_second`` are the creep of the fast units, ``static_rest`` what remains of the
    static response without the creep of the six slow units.
    """

    unit: ClassVar[str] = "N/Pa"
    kind: Literal["dynamic_coefficient"] = "dynamic_coefficient"
    coefficient: Literal["cosine", "sine", "first", "second", "slow", "static_first", "static_second", "static_rest"]
    """Which coefficient."""
    amplitude: Annotated[Force, Field(gt=0)] = 0.25
    """Amplitude of the harmonic load: 0.25 N in 4.7.1, 0.2 N in the text."""
    truncated_parts: bool = False
    """Whether every part loses its digits below 0.01 N/MPa before the parts are added, as in the thesis."""

    @classmethod
    def example(cls) -> Self:
        """The part in phase."""
        return cls(coefficient="sine")

    def found(self, inputs: Inputs) -> float:
        """In N/Pa."""
        parts = self._dynamic() if self.coefficient in DYNAMIC else self._static()
        return float(np.sum(truncated(parts, STEP) if self.truncated_parts else parts))

    def _dynamic(self) -> np.ndarray:
        """Parts whose sum is the coefficient."""
        model = units_by_speed({"cosine": "all", "sine": "all", "slow": "slow"}.get(self.coefficient, "fast"))
        rates = 1 / model.times
        transients = self.amplitude * model.compliances * OMEGA * rates / (OMEGA**2 + rates**2)
        if self.coefficient == "sine":
            in_phase = self.amplitude * model.compliances * rates**2 / (OMEGA**2 + rates**2)
            return np.append(in_phase, self.amplitude * model.glassy_compliance)
        if self.coefficient in ("first", "second"):
            return self._chosen(transients * np.exp(DELAY * rates))
        return -transients if self.coefficient == "cosine" else transients

    def _static(self) -> np.ndarray:
        """Parts whose sum is the coefficient; the rest is the whole at infinite time less the creep of the six slow units."""
        fast, slow, whole = (units_by_speed(chosen) for chosen in ("fast", "slow", "all"))
        if self.coefficient != "static_rest":
            return self._chosen(-STATIC * fast.compliances)
        return np.append(-STATIC * slow.compliances, STATIC * whole.equilibrium_compliance)

    def _chosen(self, values: np.ndarray) -> np.ndarray:
        return values[[0]] if self.coefficient.endswith("first") else values[[1]]
