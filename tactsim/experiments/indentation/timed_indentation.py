"""A rigid body pressed into tissue by a history of force or displacement; tissue may relax."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.contact.coulomb import Coulomb
from tactsim.experiments.indentation.timed_path import TimedIndentationPath
from tactsim.experiments.indentation.timed_record import TimedRecord
from tactsim.experiments.indentation.timed_setup import TimedIndentationSetup
from tactsim.fem.time_steps import TimeEvent
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.materials.library import named_material
from tactsim.mechanics.history_path import TimedState
from tactsim.mechanics.loading import DisplacementLoading
from tactsim.mechanics.specimen import Specimen


class TimedIndentation(TimedIndentationSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen by a prescribed history."""

    kind: Literal["timed_indentation"] = "timed_indentation"

    history_units: ClassVar[dict[str, str]] = TimedRecord.UNITS

    @classmethod
    def example(cls) -> Self:
        """Atrial tissue under the annulus, its displacement held."""
        held = DisplacementLoading.model_validate(
            {"control": "displacement", "pieces": [{"kind": "jump", "to": 0.1e-3, "duration": 1.0}]}
        )
        specimen = Specimen(material=named_material("atrial").material, thickness=10e-3, radius=15e-3)
        return cls(specimen=specimen, contact=Coulomb(friction=0.0), loading=held)

    def begin(self) -> Course:
        """Follow the history to its end or to the touch; see ``TimedRecord`` for what is reported."""
        model = self.model()
        path = TimedIndentationPath(self, model)
        record = TimedRecord(self, model, path)
        event = None
        if self.stop == "touch":
            recess = float(self.recess or 0.0)
            event = TimeEvent[TimedState](lambda state: record.rise(state)[0] - recess)
        steps = (record.accept(state, touched=touched) for state, touched in path.states(event))
        return Course(steps, record.findings, setup_is_timed=True)
