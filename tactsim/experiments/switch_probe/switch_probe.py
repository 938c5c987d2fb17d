"""Chapter 5's probe on tissues at several rates: force, switches, and the rate that it reads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np

from tactsim.experiments.switch_probe.setup import HISTORY_UNITS, ProbeTissue, SwitchProbeSetup
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.relaxation import Relaxation
from tactsim.results.result import StepRecord

if TYPE_CHECKING:
    from tactsim.experiments.switch_probe.report import SwitchProbeReport


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

    def begin(self) -> Course:
        """Every tissue at every rate; the noise of each touch depends on the seed and on its place in the list only."""
        from tactsim.experiments.switch_probe.report import SwitchProbeReport

        report = SwitchProbeReport(self)
        return Course(self._touched(report), report.findings, "the touches made before are kept, the run is incomplete")

    def _touched(self, report: SwitchProbeReport) -> Iterator[StepRecord]:
        from tactsim.experiments.switch_probe.run import touched

        pairs = [(tissue, rate) for tissue in self.tissues for rate in self.rates]
        for number, (tissue, rate) in enumerate(pairs):
            yield from report.add(touched(self, tissue, rate, np.random.default_rng([self.seed, number])))
