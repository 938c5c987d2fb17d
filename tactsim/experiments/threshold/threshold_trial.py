"""What a threshold sensor reports in repeated indentations: its error over speed, noise and cut-off frequency."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, Literal, Self

from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.threshold.report import SIGNAL_UNITS, TrialReport
from tactsim.experiments.threshold.sampling import SILENT, ApproachSampling, check_length
from tactsim.experiments.threshold.source import ClosedFormSource
from tactsim.experiments.threshold.trial_case import TrialCase
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.materials.library import named_material
from tactsim.results.result import StepRecord
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.threshold.threshold_trigger import ThresholdTrigger
from tactsim.units import format_quantity


class ThresholdTrial(TrialCase, Experiment):
    """Indentations at several speeds, sampled with several noises through several low passes, each many times.

    The error is that of the reported threshold force against the force on the plate at the instant at which the tissue touches
    the small sensor. It is split into: level (the small sensor must be pressed before it triggers), film (what it conducts
    against the calibration line), filter (lag of both readings), sampling (time and rounding) and noise; the five add up to the
    mean error.

    Source: thesis, 3.1.2 and the end of 3.1.1.
    """

    kind: Literal["threshold_trial"] = "threshold_trial"
    history_units: ClassVar[dict[str, str]] = {**Indentation.history_units, **SIGNAL_UNITS}

    @classmethod
    def example(cls) -> Self:
        """A thin layer of ICF, one combination."""
        source = ClosedFormSource(material=named_material("icf_stable").material, thickness=3e-3)
        return cls(source=source, speeds=(1e-3,), noises=(1e-3,), cutoffs=(10.0,), trials=10)

    def begin(self) -> Course:
        """Sample every combination; the history is one indentation of the middle one (Fig. 3.6b)."""
        report = TrialReport(self)
        return Course(self._sampled(report), report.findings, "the combinations sampled before are kept")

    def _sampled(self, report: TrialReport) -> Iterator[StepRecord]:
        """The steps of the simulation that is run first, if any, then those of the history."""
        tissue = yield from self.source.tissue()
        report.shape = tissue.shape
        triggers = [self._triggers(index, noise) for index, noise in enumerate(self.noise_levels)]
        for index, speed in enumerate(self.speeds):
            approach = tissue.approach(speed)
            words = (
                f"speeds: {format_quantity(speed, 'm/s')} takes {approach.duration:.3g} s after a lead of {self.lead:.3g} s and"
            )
            check_length(words, self.lead + approach.duration, self.sensor.chain.sampling_rate)
            sampling = ApproachSampling.settled(self.sensor, approach, tissue.shape.area, self.lead, self.low_passes)
            self._sample(report, index, sampling, triggers)
        report.complete = True
        yield from report.steps

    def _triggers(self, index: int, noise: Noise) -> list[ThresholdTrigger]:
        """The trigger for each cut-off, set at rest with one noise."""
        seeds = [[self.seed, 0, index, k] for k in range(len(self.cutoffs))]
        return [self.sensor.armed(low, noise=noise, seed=seed) for low, seed in zip(self.low_passes, seeds, strict=True)]

    def _sample(
        self, report: TrialReport, speed: int, sampling: ApproachSampling, triggers: list[list[ThresholdTrigger]]
    ) -> None:
        """Sample one speed with every noise and cut-off."""
        report.begin(sampling.approach)
        for index, noise in enumerate(self.noise_levels):
            each: dict[str, Any] = {"low_passes": self.low_passes, "triggers": triggers[index], "trials": self.trials}
            noisy = sampling.trials(noise, **each, seed=(self.seed, 1, speed, index))
            silent = sampling.trials(SILENT, **each, seed=())
            for k, low_pass in enumerate(self.low_passes):
                level = float(triggers[index][k].level)
                ideals = [sampling.ideal_error(chosen, level) for chosen in (None, low_pass)]
                line = sampling.ideal_error(None, level, films=False) if self.sensor.has_films else ideals[0]
                report.add(noisy[k], silent[k], [line, *ideals], level)
                if (speed, index, k) == report.shown:
                    report.show(sampling, noise, low_pass, triggers[index][k])
