"""What of an experiment a data set keeps: the settings of a sweep, and what every recorder shares."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.errors import CaseError, InvalidQuantity, UnknownName
from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import Recording, Values
from tactsim.interfaces.variable import Variable, reading
from tactsim.registry import kind_class, kinds
from tactsim.results.result import Result
from tactsim.sensors.force_reading import ForceReading
from tactsim.units import conversion


class RecordingSettings(Recording):
    """What of a result is stored."""

    reading: ForceReading | None = None
    """Film, electronics and calibration through which a stored force is read as well, with noise; null reads none."""


def variables(recorder: Recorder, experiment: Experiment) -> list[Variable]:
    """Labels, then readings; sizes as those of this experiment."""
    return [*recorder.labels_of(experiment), *_scalars(recorder), *recorder.readings_of(experiment)]


def numbers(recorder: Recorder, result: Result) -> Values:
    """The stored numbers of the result, NaN where it has none.

    Raises
    ------
    CaseError
        If the result has none of that name, its unit has another dimension, or it is not one number.
    """
    return {variable.name: _number(recorder, variable, result) for variable in _scalars(recorder)}


def _scalars(recorder: Recorder) -> list[Variable]:
    if recorder.settings.quantities is not None:
        named = recorder.settings.quantities.items()
        return [reading(name, unit, name.replace("_", " "), optional=True) for name, unit in named]
    quantities = recorder.quantities.items()
    return [reading(name, unit, words, optional=name in recorder.optional) for name, (unit, words) in quantities]


def _number(recorder: Recorder, variable: Variable, result: Result) -> Array:
    quantity = result.quantities.get(variable.name)
    if quantity is None or quantity.value is None:
        if quantity is None and recorder.settings.quantities is not None:
            known = ", ".join(sorted(result.quantities)) or "none"
            raise CaseError(f"sweep.quantities.{variable.name}: the result has no such quantity; it has {known}")
        return np.array(np.nan)
    value = quantity.numbers
    if value.size != 1:
        raise CaseError(f"sweep.quantities.{variable.name}: the result has {value.size} values; needed: one number")
    try:
        return np.asarray(value.reshape(()) * conversion(quantity.unit, variable.unit))
    except InvalidQuantity as error:
        raise CaseError(f"sweep.quantities.{variable.name}: {error}; expected a unit of its dimension") from None


def history(result: Result, along: str = "time") -> tuple[Array, dict[str, Array]]:
    """Times (n,) in s, or what else grows, and the history values (n,) by name, with their beginning at 0 if the result begins
    later."""
    times, columns = result.history_values(along), {name: result.history_values(name) for name in result.units}
    if times[0] > 0:
        times = np.append(0.0, times)
        columns = {name: np.append(0.0, column) for name, column in columns.items()}
    return times, columns


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
    own = _recorder_of(kind)
    if own is None and settings.quantities is None:
        raise CaseError(
            f"sweep.quantities: missing; of an experiment of kind {kind} a sweep stores the quantities that you name with their "
            "units, those that tactsim run reports of one such case; as in quantities: {max_penetration: m}; "
            f"kinds that need none: {', '.join(sorted(recorders()))}"
        )
    recorder = own or NamedQuantities
    if settings.times > 1 and not recorder.histories:
        raise CaseError(
            f"sweep.times: {settings.times}, but of an experiment of kind {kind} only the end is stored; leave it out"
        )
    if settings.reading is not None and not recorder.reads_force:
        able = ", ".join(sorted(name for name, one in recorders().items() if one.reads_force))
        raise CaseError(f"sweep.reading: an experiment of kind {kind} has no force for it; leave it out; kinds that have: {able}")
    return recorder(kind=kind, settings=settings, most_inclusions=most_inclusions)


def seed_place(kind: str) -> tuple[str, ...]:
    """Where an experiment of a kind keeps the seed of its noise; empty if it keeps none."""
    recorder = _recorder_of(kind)
    return () if recorder is None else recorder.noise_seed


def _recorder_of(kind: str) -> type[Recorder] | None:
    """The recorder of a kind of experiment, if it has one; the modules of other kinds are not loaded for it."""
    try:
        recorder: type[Recorder] = kind_class(Recorder, kind)
    except UnknownName:
        return None
    return recorder


class NamedQuantities(Recorder):
    """Only the quantities that the sweep names."""

    def describe(self) -> str:
        """The kind."""
        return f"experiments of kind {self.kind}"
