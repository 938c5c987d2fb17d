"""Threshold sensors around the tip of a catheter search the hardest tissue below them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.experiments.threshold.catheter_case import CatheterCase
from tactsim.experiments.threshold.catheter_report import SENSOR_UNITS, CatheterReport, Reading
from tactsim.experiments.threshold.sampling import ApproachSampling
from tactsim.experiments.threshold.tip_contact import SensorContact
from tactsim.experiments.threshold.valve_tissue import BandTissue, ValveSurface
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.results.result import StepRecord
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor
from tactsim.sensors.threshold.threshold_trigger import ThresholdTrigger


class CatheterTip(CatheterCase, Experiment):
    """A tip with sensors pressed on a surface of several tissues; the sensor with the highest threshold pressure is found.

    Source: thesis, 7.3 and Fig. 7.1.
    """

    kind: Literal["catheter_tip"] = "catheter_tip"
    history_units: ClassVar[dict[str, str]] = TimedIndentation.history_units | SENSOR_UNITS

    @classmethod
    def example(cls) -> Self:
        """Four sensors at the border of an annulus."""
        tissues = (
            BandTissue(name="leaflet", shear_modulus=15e3, thickness=2e-3),
            BandTissue(name="annulus", shear_modulus=60e3, thickness=3e-3),
            BandTissue(name="atrium", shear_modulus=8e3, thickness=3e-3),
        )
        quiet = ThresholdSensor(chain=SignalChain(low_pass=LowPass(cutoff=10.0), noise=Noise(white=1e-3)))
        surface = ValveSurface(tissues=tissues, borders=(13e-3, 16e-3))
        return cls(surface=surface, place=(11.5e-3, 0.0), sensor=quiet, trials=10)

    def begin(self) -> Course:
        """Touch with every sensor; one step for each."""
        report = CatheterReport(self)
        return Course(self._touched(report), report.findings, "the sensors read before are kept")

    def _touched(self, report: CatheterReport) -> Iterator[StepRecord]:
        low_pass, noise = self.sensor.chain.low_pass, self.sensor.chain.noise
        trigger = self.sensor.armed(low_pass, noise=noise, seed=[self.seed, 0])
        lags = self.ring.lag(self.tilt, self.tilt_direction)
        contacts = yield from self.model.contacts(self.surface, self.ring, self.place, self.speed)
        for index, (met, lag) in enumerate(zip(contacts, lags, strict=True)):
            yield report.add(self._reading(index, met.contact, float(lag), trigger), met)

    def _reading(self, index: int, contact: SensorContact, lag: float, trigger: ThresholdTrigger) -> Reading:
        """What a sensor reports that touches after a displacement ``lag`` in m; nothing if the tip ends before."""
        depth = self.press - lag
        if depth <= 0:
            return Reading.nothing(lag, self.trials)
        approach = contact.approach(self.speed, depth)
        noise, low_pass = self.sensor.chain.noise, self.sensor.chain.low_pass
        sampling = ApproachSampling.settled(self.sensor, approach, self.ring.area, self.lead + lag / self.speed, [low_pass])
        (trials,) = sampling.trials(noise, [low_pass], [trigger], trials=self.trials, seed=(self.seed, 1, index))
        return Reading.of_trials(lag, trials, reached=bool(np.isfinite(approach.touch)), trials=self.trials)
