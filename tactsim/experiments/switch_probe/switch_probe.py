"""Chapter 5's probe on tissues at several rates: force, switches, and the rate that it reads."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.errors import Unfinished
from tactsim.experiments.collecting import failure
from tactsim.experiments.switch_probe.report import HISTORY_UNITS, SwitchProbeReport
from tactsim.experiments.switch_probe.run import touched
from tactsim.experiments.switch_probe.setup import ProbeTissue, SwitchProbeSetup
from tactsim.interfaces import Experiment, Progress
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.relaxation import Relaxation
from tactsim.results.result import Result, Status


class SwitchProbe(SwitchProbeSetup, Experiment):
    """A trapezoidal probe with five switches and one force sensor, pressed into tissues at constant rates.

    Source: thesis, chapter 5.
    """

    kind: Literal["switch_probe"] = "switch_probe"

    history_units: ClassVar[dict[str, str]] = HISTORY_UNITS

    @classmethod
    def example(cls) -> Self:
        """One tissue at one rate."""
        material = NeoHookean(c10=5e3, relaxation=Relaxation(fractions=(0.5,), times=(2.0,)))
        return cls(tissues=(ProbeTissue(name="tissue", material=material),))

    def run(self, progress: Progress) -> Result:
        """Every tissue at every rate; the noise of each touch depends on the seed and on its place in the list only."""
        report = SwitchProbeReport(self, self.kind)
        pairs = [(tissue, rate) for tissue in self.tissues for rate in self.rates]
        try:
            for number, (tissue, rate) in enumerate(pairs):
                for step in report.add(touched(self, tissue, rate, np.random.default_rng([self.seed, number]))):
                    progress(step)
        except Unfinished as error:
            return report.result(Status.FAILED, failure(error))
        except KeyboardInterrupt:
            return report.result(Status.INTERRUPTED, "interrupted; the touches made before are kept, the run is incomplete")
        return report.result(Status.CONVERGED, f"{len(pairs)} touches")
