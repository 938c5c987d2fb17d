"""What of an experiment a data set keeps: one small class for each kind, in the module ``recorder`` of its folder."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from tactsim.errors import CaseError
from tactsim.interfaces import Experiment, Kind
from tactsim.interfaces.variable import Variable, reading
from tactsim.registry import kinds
from tactsim.results.result import Result
from tactsim.sensors.force_reading import ForceReading
from tactsim.units import FrozenModel

Array = np.ndarray
PACKAGE = "tactsim.experiments.recordings"
Values = dict[str, Array]


class RecordingSettings(FrozenModel):
    """What of a result is stored."""

    times: Annotated[int, Field(ge=1, le=100_000)] = 1
    """Stored times of a history, evenly spaced up to its end; 1 stores the end."""
    quantities: dict[str, str] | None = None
    """Name -> unit of the numbers of a result that are stored; by default those that the kind of experiment declares."""
    reading: ForceReading | None = None
    """Film, electronics and calibration through which a stored force is read as well, with noise; null reads none."""


class Recorder(Kind):
    """The labels and readings of one kind of experiment; subclass it with that kind as default."""

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.recorder"
    settings: RecordingSettings
    most_inclusions: int = 0
    """Largest number of inclusions that the sweep can draw."""
    quantities: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """Name of a number of the result -> unit and description; stored as they are."""
    optional: ClassVar[tuple[str, ...]] = ()
    """Those of them that a result may lack."""
    noise_seed: ClassVar[tuple[str, ...]] = ()
    """Where such an experiment keeps the seed of its noise; one that keeps none is read with noise of the sweep's own."""
    histories: ClassVar[bool] = False
    """Whether `readings` are stored at several times."""
    reads_force: ClassVar[bool] = False
    """Whether a force is read through the sensor of the sweep."""

    def variables(self, experiment: Experiment) -> list[Variable]:
        """Labels, then readings; sizes as those of this experiment."""
        return [*self.labels_of(experiment), *self._scalars(), *self.readings_of(experiment)]

    def labels_of(self, experiment: Experiment) -> list[Variable]:
        """What is known before the experiment is run."""
        return []

    def readings_of(self, experiment: Experiment) -> list[Variable]:
        """What its result holds beside ``quantities``."""
        return []

    def labels(self, experiment: Any) -> Values:
        """Values of `labels_of`."""
        return {}

    def readings(self, experiment: Any, result: Result, generator: np.random.Generator) -> Values:
        """Values of `readings_of`; the generator makes noise."""
        return {}

    def numbers(self, result: Result) -> Values:
        """The stored numbers of the result, NaN where it has none.

        Raises
        ------
        CaseError
            If the result has none of that name, calls it by another unit, or it is not one number.
        """
        return {variable.name: self._number(variable, result) for variable in self._scalars()}

    def _scalars(self) -> list[Variable]:
        if self.settings.quantities is not None:
            named = self.settings.quantities.items()
            return [reading(name, unit, name.replace("_", " "), optional=True) for name, unit in named]
        told = self.quantities.items()
        return [reading(name, unit, words, optional=name in self.optional) for name, (unit, words) in told]

    def _number(self, variable: Variable, result: Result) -> Array:
        found = result.quantities.get(variable.name)
        if found is None or found.value is None:
            if found is None and self.settings.quantities is not None:
                known = ", ".join(sorted(result.quantities)) or "none"
                raise CaseError(f"sweep.quantities.{variable.name}: the result has no such quantity; it has {known}")
            return np.array(np.nan)
        value = np.asarray(found.value, dtype=float)
        if value.size != 1 or found.unit != variable.unit:
            told = f"{value.size} values in {found.unit}"
            raise CaseError(f"sweep.quantities.{variable.name}: {told}; needed: one number in {variable.unit}")
        return value.reshape(())

    def history(self, result: Result) -> tuple[Array, dict[str, Array]]:
        """Times (n,) in s and the history values (n,) by name, with their beginning at 0 s if the result begins later."""
        times = np.array([step.values["time"] for step in result.steps])
        columns = {name: np.array([step.values.get(name, np.nan) for step in result.steps]) for name in result.units}
        if times[0] > 0:
            times = np.append(0.0, times)
            columns = {name: np.append(0.0, column) for name, column in columns.items()}
        return times, columns

    def stored_times(self, end: float) -> Array:
        """The stored times in s of a history that ends at ``end``."""
        return np.arange(1, self.settings.times + 1) * end / self.settings.times

    @property
    def reading(self) -> ForceReading | None:
        """The sensor through which a force is read."""
        return self.settings.reading

    @abstractmethod
    def describe(self) -> str:
        """What is simulated, for the card of the data set."""


def recorders() -> dict[str, type[Recorder]]:
    """Recorder by kind of experiment."""
    return kinds(Recorder)


def recorder_for(kind: str, settings: RecordingSettings, most_inclusions: int = 0) -> Recorder:
    """The recorder of a kind of experiment; a kind without one needs ``sweep.quantities``.

    Raises
    ------
    CaseError
        If the kind has no recorder and no quantities are named.
    """
    known = recorders()
    if kind not in known and settings.quantities is None:
        raise CaseError(
            f"sweep.quantities: missing; an experiment of kind {kind} stores what you name, such as quantities: "
            f"{{max_penetration: m}}; kinds that need none: {', '.join(sorted(known))}"
        )
    recorder = known.get(kind, NamedQuantities)
    if settings.times > 1 and not recorder.histories:
        raise CaseError(
            f"sweep.times: {settings.times}, but of an experiment of kind {kind} only the end is stored; leave it out"
        )
    if settings.reading is not None and not recorder.reads_force:
        able = ", ".join(sorted(name for name, one in known.items() if one.reads_force))
        raise CaseError(f"sweep.reading: an experiment of kind {kind} has no force for it; leave it out; kinds that have: {able}")
    return recorder(kind=kind, settings=settings, most_inclusions=most_inclusions)


def seed_place(kind: str) -> tuple[str, ...]:
    """Where an experiment of a kind keeps the seed of its noise; empty if it keeps none."""
    known = recorders()
    return known[kind].noise_seed if kind in known else ()


class NamedQuantities(Recorder):
    """Only the quantities that the sweep names."""

    def describe(self) -> str:
        """The kind."""
        return f"experiments of kind {self.kind}"
