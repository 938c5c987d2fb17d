"""A rigid body pressed into tissue; for the annulus, up to the threshold where the tissue touches the inner sensor."""

from __future__ import annotations

import time
from typing import ClassVar, Literal, Self

from tactsim.experiments.collecting import ended_early
from tactsim.experiments.indentation.path import indentation_path
from tactsim.experiments.indentation.record import IndentationRecord
from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.interfaces import Experiment, Progress
from tactsim.mechanics.specimen import Specimen
from tactsim.results.result import Result, Status
from tactsim.units import format_quantity


class Indentation(IndentationSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen along its axis."""

    kind: Literal["indentation"] = "indentation"

    history_units: ClassVar[dict[str, str]] = IndentationRecord.UNITS

    @classmethod
    def example(cls) -> Self:
        """A thin specimen under the sensor of chapter 3."""
        return cls(specimen=Specimen(material="icf_stable", thickness=4e-3, radius=8e-3), recess=0.8e-3, displacement=2e-3)

    def run(self, progress: Progress) -> Result:
        """Press until the threshold or the displacement; see ``IndentationRecord`` for what is reported."""
        begin = time.perf_counter()
        model = self.model()
        record = IndentationRecord(self, model, begin)
        states = indentation_path(self, model, record)
        early = ended_early(record, (record.accept(state, threshold=event) for state, event in states), progress)
        if early is not None:
            return early
        if self.stop == "threshold" and not record.has_threshold:
            reached = format_quantity(self.displacement, "m")
            return record.result(Status.FAILED, f"the threshold was not reached within the displacement of {reached}")
        return record.result(Status.CONVERGED, "threshold reached" if self.stop == "threshold" else "displacement reached")
