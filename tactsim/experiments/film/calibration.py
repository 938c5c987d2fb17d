"""Calibration of a force sensor: the line C = m F + n from forces and voltages, with intervals and linearity."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import nullcontext
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.experiments.film.force_calibration_source import MeasuredCalibration, SyntheticCalibration
from tactsim.experiments.film.scene import CalibrationScene
from tactsim.identification.calibration_line import CalibrationFit, fit_calibration_line
from tactsim.identification.columns import of_file
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.units import Force, Positive, format_quantity

FOLLOWING = 3.0
"""Correlation of the residuals with their neighbours in force, in its standard deviations, from which they are said to follow
a curve."""


class ForceCalibration(Experiment):
    r"""Least-squares line of each of several piezoresistive sensors and what it leaves.

    .. math:: C = m F + n, \qquad C = \frac{1}{(V^+/V_o - 1) R}

    Source: thesis, 2.2.1 and 3.1.2 (Fig. 3.4: F = 20.94 C - 0.132 with C in mS, +3.9 % and -6.15 % of full scale).
    """

    kind: Literal["calibration"] = "calibration"
    data: Annotated[SyntheticCalibration | MeasuredCalibration, Field(discriminator="kind")] = SyntheticCalibration()
    """Where the readings come from."""
    chain: SignalChain = SignalChain()
    """Supply and load resistor of the divider, range of the converter; synthetic readings pass through all of it."""
    confidence: Annotated[float, Field(ge=0.5, le=0.999)] = 0.95
    """Of the intervals and of the band."""
    full_scale: Positive[Force] | None = None
    """Force that the linearity refers to; null is the largest force applied."""

    history_units: ClassVar[dict[str, str]] = {
        "sensor": "1",
        "force": "N",
        "voltage": "V",
        "conductance": "S",
        "line": "S",
        "line_lower": "S",
        "line_upper": "S",
        "force_error": "N",
        "used": "1",
    }

    @classmethod
    def example(cls) -> Self:
        """The line of 3.1.2 through a chain without noise."""
        return cls()

    def begin(self) -> Course:
        """Fit the line of every sensor; one step per reading of a sensor."""
        force, voltage, saturated = self.data.readings(self.chain)
        with of_file(self.data.path) if isinstance(self.data, MeasuredCalibration) else nullcontext():
            fit = fit_calibration_line(
                force,
                voltage,
                supply=self.chain.supply,
                load=self.chain.load_resistor,
                saturated=saturated,
                confidence=self.confidence,
                full_scale=self.full_scale,
            )
        lines = "line" if fit.slope.size == 1 else f"{fit.slope.size} lines"
        return Course.computed(
            Findings(
                f"{lines} through {np.count_nonzero(fit.used)} readings",
                tuple(self._steps(force, voltage, fit)),
                quantities=self._quantities(fit),
                assumptions=self._assumptions(),
                warnings=self._warnings(force, fit),
                scene=CalibrationScene(full_scale=float(fit.full_scale.max()), confidence=self.confidence),
            )
        )

    def _steps(self, force: Array, voltage: Array, fit: CalibrationFit) -> Iterator[StepRecord]:
        """Readings sensor by sensor; a saturated one has no conductance."""
        line, half = np.multiply.outer(force, fit.slope) + fit.intercept, fit.band(force)
        conductance = self.chain.conductance(np.where(fit.used, voltage, 0.0))
        sensor, applied = np.broadcast_arrays(np.arange(1, fit.slope.size + 1), force[:, None])
        columns = (sensor, applied, voltage, conductance, line, line - half, line + half, fit.force_error, fit.used)
        for number, values in enumerate(zip(*(column.T.ravel() for column in columns), strict=True), 1):
            named = dict(zip(self.history_units, map(float, values), strict=True))
            if not named["used"]:
                del named["conductance"], named["force_error"]
            yield StepRecord(number, 0, 0.0, named)

    def _quantities(self, fit: CalibrationFit) -> dict[str, Quantity]:
        sure, scaled = f"{100 * self.confidence:g} % interval", "over the full scale"
        quantities = {
            "slope": (fit.slope, "S/N", "m of C = m F + n"),
            "slope_interval": (fit.slope_interval, "S/N", f"{sure} of m, lower and upper [bound]"),
            "intercept": (fit.intercept, "S", "n of C = m F + n"),
            "intercept_interval": (fit.intercept_interval, "S", f"{sure} of n, lower and upper [bound]"),
            "linearity_positive": (fit.linearity_positive, "1", f"largest of read minus applied force, {scaled}"),
            "linearity_negative": (fit.linearity_negative, "1", f"smallest of read minus applied force, {scaled}"),
            "rms": (fit.rms, "N", "root mean square of read minus applied force"),
            "noise": (fit.noise, "V", "standard deviation of a reading, from the residuals"),
            "readings": (np.count_nonzero(fit.used, axis=0), "1", "readings that were fitted"),
            "excluded": (fit.excluded, "1", "saturated readings that were left out"),
        }
        truth = self.data.truth()
        if truth is not None:
            quantities["slope_error"] = (fit.slope / truth[0] - 1, "1", "m over its true value, less one")
            quantities["intercept_error"] = (fit.intercept - truth[1], "S", "n less its true value")
        each = "" if len(fit.slope) == 1 else " [sensor]"
        return {name: Quantity(_alone(value), unit, words + each) for name, (value, unit, words) in quantities.items()}

    def _assumptions(self) -> list[str]:
        assumptions = ["the applied forces are exact; the noise is independent, Gaussian and alike in voltage at every force"]
        if isinstance(self.data, SyntheticCalibration):
            assumptions.append("synthetic readings of a declared line: the data of Fig. 3.4 are not printed")
        supply, load = format_quantity(self.chain.supply, "V"), format_quantity(self.chain.load_resistor, "ohm")
        assumptions.append(f"supply {supply} (0.5 V in 3.1.2, 5 V in 2.2: E27) and load resistor {load} (not printed)")
        return assumptions

    def _warnings(self, force: Array, fit: CalibrationFit) -> list[str]:
        warnings = []
        excluded = int(fit.excluded.sum())
        if excluded:
            warnings.append(f"{excluded} of {fit.used.size} readings are saturated and were left out")
        if isinstance(self.data, SyntheticCalibration):
            warnings += self._unsettled(self.data)
        curved = [k + 1 for k in range(fit.slope.size) if self._curved(force, fit, k)]
        if curved:
            which = "" if fit.slope.size == 1 else f" of sensor {', '.join(map(str, curved))}"
            warnings.append(f"the residuals{which} follow a curve: the intervals, which allow for noise alone, are too narrow")
        return warnings

    def _unsettled(self, data: SyntheticCalibration) -> list[str]:
        """What the low pass keeps from a reading, if the converter sees it."""
        lag, low_pass = data.lag(self.chain), self.chain.low_pass
        if low_pass is None or lag <= self.chain.converter.step:
            return []
        step, kept = (format_quantity(float(f"{value:.3g}"), "V") for value in (self.chain.converter.step, lag))
        cutoff, hold = format_quantity(low_pass.cutoff, "Hz"), format_quantity(data.hold, "s")
        longer = data.settled_hold(self.chain)
        higher = longer / data.hold * low_pass.cutoff
        advice = f"{_rounded_up(longer):g} s or raise chain.low_pass.cutoff to {_rounded_up(higher):g} Hz"
        return [
            f"the low pass of {cutoff} is up to {kept} behind at the end of a hold of {hold}, where a step of the converter is "
            f"{step}: slope and intercept are those of readings that have not settled; lengthen data.hold to {advice}"
        ]

    def _curved(self, force: Array, fit: CalibrationFit, sensor: int) -> bool:
        """Whether neighbouring residuals of a sensor are more alike than noise beyond a step of the converter makes them."""
        used = fit.used[:, sensor]
        error = fit.force_error[used, sensor][np.argsort(force[used], kind="stable")]
        alike = float((error[1:] * error[:-1]).sum() / max((error**2).sum(), np.finfo(float).tiny))
        return alike * np.sqrt(error.size) > FOLLOWING and float(fit.noise[sensor]) > self.chain.converter.step


def _rounded_up(value: float) -> float:
    """A positive number to two digits, not less than it was."""
    digit = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(f"{np.ceil(value / digit) * digit:.2g}")


def _alone(value: Array) -> Any:
    """Values of shape (..., sensors) without the last axis if there is one sensor."""
    values = value[..., 0] if value.shape[-1] == 1 else value
    return values.item() if values.ndim == 0 else values
