"""What repeated indentations report: errors over speed, noise and cut-off, one recording, assumptions and warnings."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tactsim.analytic.viscoelastic_annulus import SMALL_DISPLACEMENT
from tactsim.array import Array
from tactsim.experiments.threshold.contact_curve import Approach, SensorShape
from tactsim.experiments.threshold.sampling import ApproachSampling, Trials
from tactsim.experiments.threshold.scene import ThresholdCapture, ThresholdTrialScene
from tactsim.experiments.threshold.trial_case import TrialCase
from tactsim.interfaces.readings import RESOLUTION
from tactsim.interfaces.run import Findings
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord, rows
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.threshold.threshold_trigger import ThresholdTrigger
from tactsim.units import format_quantity

MOST_ROWS = 1500
"""Rows of the recording that is kept, at most about."""
SIGNAL_UNITS = {
    "time": "s",
    "displacement": "m",
    "plate_force": "N",
    "small_force": "N",
    "large_reading": "N",
    "small_reading": "N",
    "large_reading_unfiltered": "N",
    "small_reading_unfiltered": "N",
}
CELL_WORDS = {
    "force_error": ("N", "mean error of the reported threshold force"),
    "force_error_deviation": ("N", "standard deviation of the reported threshold force"),
    "pressure_error": ("Pa", "mean error of the reported threshold pressure"),
    "relative_error": ("1", "mean error over the true threshold"),
    "relative_deviation": ("1", "standard deviation over the true threshold"),
    "level_error": ("N", "part of the mean error: the small sensor must be pressed up to its level"),
    "film_error": ("N", "part of the mean error: films that do not conduct what the calibration line says"),
    "filter_error": ("N", "part of the mean error: lag of the filtered readings"),
    "sampling_error": ("N", "part of the mean error: samples in time and rounding"),
    "noise_error": ("N", "part of the mean error: noise"),
    "trigger_level": ("N", "force above rest at which the small sensor triggers"),
    "trigger_delay": ("s", "mean time from the touch to the trigger"),
    "false_rate": ("1", "part of the trials with a trigger before the touch"),
    "missed_rate": ("1", "part of the trials without a trigger"),
    "saturated_rate": ("1", "part of the trials with a converter at its end"),
}
"""Name -> unit and words of what is reported for each speed, noise and cut-off."""


class TrialReport:
    """Collects the combinations, in the order speed, noise, cut-off, and turns them into a result."""

    def __init__(self, experiment: TrialCase):
        self._experiment = experiment
        self.lengths = (len(experiment.speeds), len(experiment.noises), len(experiment.cutoffs))
        self.shown = tuple(length // 2 for length in self.lengths)
        """The combination whose recording is kept."""
        self.shape: SensorShape | None = None
        self.steps: tuple[StepRecord, ...] = ()
        self.complete = False
        """Whether every combination was sampled."""
        self._approaches: list[Approach] = []
        self._cells: list[dict[str, float | None]] = []
        self._capture: ThresholdCapture | None = None

    def begin(self, approach: Approach) -> None:
        """A new speed."""
        self._approaches.append(approach)

    def add(self, sampled: Trials, silent: Trials, ideals: list[float | None], level: float) -> None:
        """One combination: its trials, those without noise, and three errors of the ideal chain.

        The three are those of the calibration lines, of the films, and of the films behind the low pass.
        """
        mean, quiet, deviation = sampled.mean_error(), silent.mean_error(), sampled.deviation()
        assert self.shape is not None  # set before the first approach
        self._cells.append(
            {
                "force_error": mean,
                "force_error_deviation": deviation,
                "pressure_error": None if mean is None else mean / self.shape.area,
                "relative_error": None if mean is None else mean / sampled.true_force,
                "relative_deviation": None if deviation is None else deviation / sampled.true_force,
                "level_error": ideals[0],
                "film_error": _difference(ideals[1], ideals[0]),
                "filter_error": _difference(ideals[2], ideals[1]),
                "sampling_error": _difference(quiet, ideals[2]),
                "noise_error": _difference(mean, quiet),
                "trigger_level": level,
                "trigger_delay": sampled.mean_delay(),
                "false_rate": float(sampled.false.mean()),
                "missed_rate": float(sampled.missed.mean()),
                "saturated_rate": float(sampled.saturated.mean()),
            }
        )

    def show(self, sampling: ApproachSampling, noise: Noise, low_pass: LowPass, trigger: ThresholdTrigger) -> None:
        """Keep one recording of this combination."""
        sensor, approach = sampling.sensor, sampling.approach
        generator = np.random.default_rng([self._experiment.seed, 2])
        recording, touch = sampling.recorded(sensor, noise, generator, phase=0.5, copies=1)
        large, small = (values[:, 0] for values in sensor.readings(recording, low_pass))
        state, armed = sampling.captured(sensor, recording, low_pass, trigger)
        plain = [values[:, 0] for values in sensor.readings(recording, None)]
        begin = touch - approach.touch
        plate, pressed = approach.at(recording.time - begin)
        columns = (recording.time, approach.speed * (recording.time - begin), plate, pressed, large, small, *plain)
        fired = int(state.index[0]) + len(large) - len(armed) if state.triggered[0] else -1
        kept = _kept(len(columns[0]), fired)
        self.steps = rows(SIGNAL_UNITS, [column[kept] for column in columns])
        threshold = approach.threshold_force
        self._capture = ThresholdCapture(
            touch_time=touch,
            threshold_force=threshold,
            armed_time=float(armed[0]),
            trigger_level=float(trigger.rest + trigger.level),
            speed=approach.speed,
            noise=noise.white,
            cutoff=low_pass.cutoff,
            large_bears=sensor.large_bears,
            capture=sensor.capture,
            trigger_time=float(recording.time[fired]) if fired >= 0 else None,
            captured_force=float(state.force[0]) if fired >= 0 else None,
        )

    def findings(self) -> Findings:
        """What everything that was sampled says."""
        return Findings(
            f"every combination sampled {self._experiment.trials} times",
            self.steps,
            quantities=self._quantities() if self._cells else {},
            assumptions=self._assumptions(),
            warnings=self._warnings(),
            units=SIGNAL_UNITS,
            scene=ThresholdTrialScene(
                speeds=self._experiment.speeds,
                noises=self._experiment.noises,
                cutoffs=self._experiment.cutoffs,
                complete=self.complete,
                capture=self._capture,
            ),
        )

    def _quantities(self) -> dict[str, Quantity]:
        assert self.shape is not None  # there are cells
        area = self.shape.area
        force = [approach.threshold_force for approach in self._approaches]
        axes = "[speed, noise, cut-off]"
        quantities = {
            "threshold_force": Quantity(force, "N", "true threshold force [speed]"),
            "threshold_pressure": Quantity([f / area for f in force], "Pa", "true threshold force over the annular area [speed]"),
            "annular_area": Quantity(area, "m^2", "area of the face"),
            "force_rate": Quantity([_rate(a) for a in self._approaches], "N/s", "growth of the force at the touch [speed]"),
        }
        return quantities | {
            name: Quantity(self.grid(name), unit, f"{words} {axes}") for name, (unit, words) in CELL_WORDS.items()
        }

    def grid(self, name: str) -> list[list[list[float | None]]]:
        """A value over speed, noise and cut-off, null where no trial was valid or nothing was sampled yet."""
        values = np.full(self.lengths, None, dtype=object)
        for place, cell in zip(np.ndindex(*self.lengths), self._cells, strict=False):
            values[place] = cell[name]
        return values.tolist()

    def _assumptions(self) -> Iterator[str]:
        yield from self._experiment.source.assumptions()
        sensor = self._experiment.sensor
        if sensor.large_bears == "plate_and_small":
            yield "the small sensor lies on the large one (Fig. 3.2), which bears the forces on both"
        if sensor.small.calibration == sensor.large.calibration:
            yield "the small sensor is read by the line of the large one; the thesis prints one line"
        level = (
            format_quantity(sensor.trigger.force, "N") if sensor.trigger.force else f"{sensor.trigger.multiple:g} times the noise"
        )
        yield f"the small sensor triggers {level} above its value at rest; the thesis gives no number"
        yield "constant speed from before the touch on"

    def _warnings(self) -> Iterator[str]:
        low = sorted({a.threshold_force for a in self._approaches if a.threshold_force < RESOLUTION})
        if low:
            least, resolved = format_quantity(low[0], "N"), format_quantity(RESOLUTION, "N")
            yield f"the true threshold, {least} at least, is below the resolution of {resolved} that 3.1.2 states (erratum E27)"
        if self._experiment.source.kind == "closed_form" and self.shape is not None:
            deepest = max((a.speed * a.touch for a in self._approaches), default=0.0) / self.shape.outer_radius
            if deepest > SMALL_DISPLACEMENT:
                limit = f"linear theory is meant for up to {SMALL_DISPLACEMENT:g}"
                yield f"the threshold lies at a displacement of {deepest:.3g} of the outer radius; {limit}"
        for name, words in (
            ("false_rate", "trigger before the touch: take a higher level or a lower cut-off"),
            ("missed_rate", "never trigger: take a lower level or follow the displacement further"),
            (
                "saturated_rate",
                "have a converter at its end: widen its range; for a film, which rests at 0 V, let it begin below",
            ),
        ):
            rates = [float(cell[name] or 0.0) for cell in self._cells]
            if any(rates):
                share, few = f"{100 * max(rates):.0f} %", np.count_nonzero(rates)
                yield f"up to {share} of the trials of {few} of {len(rates)} combinations {words}"


def _kept(count: int, trigger: int) -> Array:
    """Numbers (n,) of every so many-th of ``count`` samples, that of the trigger included if it is not negative."""
    kept = np.arange(0, count, max(1, -(-count // MOST_ROWS)))
    return np.union1d(kept, [trigger]) if trigger >= 0 else kept


def _rate(approach: Approach) -> float:
    """Growth in N/s of the force on the plate before the touch, over a thousandth of the time to it."""
    step = 1e-3 * approach.touch
    plate = approach.at(np.array([approach.touch - step, approach.touch]))[0]
    return float(np.diff(plate)[0] / step)


def _difference(one: float | None, other: float | None) -> float | None:
    return None if one is None or other is None else one - other
