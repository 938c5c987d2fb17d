"""A rigid body pressed into tissue; for the annulus, up to the threshold where the tissue touches the inner sensor."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.experiments.indentation.path import indentation_path
from tactsim.experiments.indentation.record import IndentationRecord
from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.mechanics.specimen import Specimen


class Indentation(IndentationSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen along its axis."""

    kind: Literal["indentation"] = "indentation"

    history_units: ClassVar[dict[str, str]] = IndentationRecord.UNITS

    @classmethod
    def example(cls) -> Self:
        """A thin specimen under the sensor of chapter 3."""
        return cls(specimen=Specimen(material="icf_stable", thickness=4e-3, radius=8e-3), recess=0.8e-3, displacement=2e-3)

    def begin(self) -> Course:
        """Press until the threshold or the displacement; see ``IndentationRecord`` for what is reported."""
        model = self.model()
        record = IndentationRecord(self, model)
        states = indentation_path(self, model, record)
        return Course((record.accept(state, threshold=event) for state, event in states), record.findings, setup_is_timed=True)
