"""What a threshold sensor reports in repeated indentations: its error over speed, noise and cut-off frequency."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tactsim.errors import InvalidQuantity
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.threshold.contact_curve import Approach
from tactsim.experiments.threshold.report import SIGNAL_UNITS, TrialReport
from tactsim.experiments.threshold.sampling import FINER, SILENT, ApproachSampling
from tactsim.experiments.threshold.source import AnySource, ClosedFormSource
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, run_within_another
from tactsim.materials.library import named_material
from tactsim.results.result import StepRecord
from tactsim.sensors.low_pass import LowPass
from tactsim.sensors.noise import Noise
from tactsim.sensors.threshold_sensor import ThresholdSensor
from tactsim.sensors.threshold_trigger import ThresholdTrigger
from tactsim.units import Frequency, Speed, Time, Voltage, check_increasing, format_quantity

MOST_SAMPLES = 500_000
"""Longest recording of one approach, in samples."""


class ThresholdTrial(Experiment):
    """Indentations at several speeds, sampled with several noises through several low passes, each many times.

    The error is that of the reported threshold force against the force on the plate at the instant at which the tissue touches
    the small sensor. It is told apart: level (the small sensor must be pressed before it triggers), film (what it conducts
    against the calibration line), filter (lag of both readings), sampling (time and rounding) and noise; the five add up to the
    mean error.

    Source: thesis, 3.1.2 and the end of 3.1.1.
    """

    kind: Literal["threshold_trial"] = "threshold_trial"
    source: AnySource
    """Where the forces come from."""
    sensor: ThresholdSensor = ThresholdSensor()
    """The sensor and its electronics; ``cutoffs`` and ``noises`` replace the cut-off and the white noise in it."""
    speeds: Annotated[tuple[Annotated[Speed, Field(gt=0)], ...], Field(min_length=1)]
    """Speeds of indentation, increasing."""
    noises: Annotated[tuple[Annotated[Voltage, Field(ge=0)], ...], Field(min_length=1)]
    """Root mean squares of the white noise of a sample, increasing; the line pick-up is that of the chain."""
    cutoffs: Annotated[tuple[Annotated[Frequency, Field(gt=0)], ...], Field(min_length=1)]
    """Cut-off frequencies of the low pass, increasing."""
    trials: Annotated[int, Field(ge=1, le=10_000)] = 50
    """Indentations of each combination."""
    lead: Annotated[Time, Field(gt=0)] = 0.5
    """Recording before the tissue is touched, in which a trigger is already false."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Seed of the noise."""

    history_units: ClassVar[dict[str, str]] = {**Indentation.history_units, **SIGNAL_UNITS}

    @model_validator(mode="after")
    def _possible(self) -> Self:
        check_increasing(speeds=self.speeds, noises=self.noises, cutoffs=self.cutoffs)
        if self.sensor.chain.low_pass is None:
            raise ValueError("the chain has no low pass whose cut-off could vary; set sensor.chain.low_pass")
        for low_pass in self.low_passes:
            low_pass.check(self.sensor.chain.sampling_rate)
            low_pass.check(FINER * self.sensor.chain.sampling_rate)  # of the ideal chain that the errors are told against
        return self

    @classmethod
    def example(cls) -> Self:
        """A thin layer of ICF, one combination."""
        source = ClosedFormSource(material=named_material("icf_stable").material, thickness=3e-3)
        return cls(source=source, speeds=(1e-3,), noises=(1e-3,), cutoffs=(10.0,), trials=10)

    @property
    def low_passes(self) -> list[LowPass]:
        """The low pass at each cut-off."""
        order = self.sensor.chain.low_pass.order if self.sensor.chain.low_pass else 1
        return [LowPass(cutoff=cutoff, order=order) for cutoff in self.cutoffs]

    @property
    def noise_levels(self) -> list[Noise]:
        """The noise at each level."""
        return [self.sensor.chain.noise.model_copy(update={"white": white}) for white in self.noises]

    def begin(self) -> Course:
        """Sample every combination; the history is one indentation of the middle one (Fig. 3.6b)."""
        report = TrialReport(self)
        return Course(self._sampled(report), report.findings, "the combinations sampled before are kept")

    def _sampled(self, report: TrialReport) -> Iterator[StepRecord]:
        """The steps of the simulation that is run first, if any, then those of the history."""
        first = self.source.simulation
        simulated = None if first is None else (yield from run_within_another(first))
        tissue = self.source.tissue(simulated)
        report.shape = tissue.shape
        triggers = [self._triggers(index, noise) for index, noise in enumerate(self.noise_levels)]
        for index, speed in enumerate(self.speeds):
            approach = tissue.approach(speed)
            self._check_length(approach)
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
            found = sampling.trials(noise, **each, seed=(self.seed, 1, speed, index))
            silent = sampling.trials(SILENT, **each, seed=())
            for k, low_pass in enumerate(self.low_passes):
                level = float(triggers[index][k].level)
                ideals = [sampling.ideal_error(chosen, level) for chosen in (None, low_pass)]
                line = sampling.ideal_error(None, level, films=False) if self.sensor.has_films else ideals[0]
                report.add(found[k], silent[k], [line, *ideals], level)
                if (speed, index, k) == report.shown:
                    report.show(sampling, noise, low_pass, triggers[index][k])

    def _check_length(self, approach: Approach) -> None:
        needed = (self.lead + approach.duration) * self.sensor.chain.sampling_rate
        if needed > MOST_SAMPLES:
            speed = format_quantity(approach.speed, "m/s")
            raise InvalidQuantity(
                f"speeds: {speed} takes {approach.duration:.3g} s after a lead of {self.lead:.3g} s and {needed:.3g} samples; "
                f"allowed: up to {MOST_SAMPLES}; press faster, shorten the lead or sample more slowly"
            )
