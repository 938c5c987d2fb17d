"""The variables of a sweep's store, and the part of the data set that each specimen belongs to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from tactsim.case.loading import SWEEP_SECTION
from tactsim.case.model import Case
from tactsim.dataset.cost import COST
from tactsim.dataset.sampling.drawing import drawn_specimen, fault_of
from tactsim.dataset.sampling.places import is_distribution
from tactsim.dataset.sampling.settings import Condition
from tactsim.dataset.sampling.suitable import check_suitable
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import index_variables
from tactsim.errors import CaseError, suggestion
from tactsim.experiments.recording import recorder_for
from tactsim.experiments.recording import variables as variables_of
from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import Values
from tactsim.interfaces.variable import Variable
from tactsim.registry import kind_names
from tactsim.units import format_quantity

SPLITTING = 3
"""Stream of random numbers that deals specimens to splits."""
DEALT = 10
"""Specimens that are dealt together: shares of whole tenths are exact in each ten, and small sets have a part to test with."""
ROUND_OFF = 1e-9
"""Relative difference of two times that are equal."""
TRIED_SPECIMENS, TRIED_OF_GRID = 3, 1000
"""First specimens of which one must be possible; those of a grid are drawn once each."""


@dataclass(frozen=True)
class Layout:
    """Variables of a store in their order, and who fills them."""

    recorder: Recorder
    variables: tuple[Variable, ...]

    def named(self, name: str) -> Variable:
        """The variable of a name."""
        return next(variable for variable in self.variables if variable.name == name)


@lru_cache(maxsize=4)
def layout_of(sweep: Sweep) -> Layout:
    """The layout of a sweep, by its first possible case.

    Raises
    ------
    CaseError
        If no case is possible, nothing can be stored, or a split asks for a label that there is not.
    """
    known = kind_names(Experiment)
    if sweep.kind not in known:
        unknown = f"{sweep.kind!r}{suggestion(sweep.kind, known)}; allowed: {', '.join(sorted(known))}"
        raise sweep.error(("experiment", "kind"), unknown)
    try:
        recorder = recorder_for(sweep.kind, sweep.settings, most_inclusions(sweep.document.value))
    except CaseError as error:
        raise sweep.placed(error) from None
    experiment = first_case(sweep).experiment
    _check_times(sweep, recorder, experiment)
    recorded = variables_of(recorder, experiment)
    taken = {variable.name for variable in recorded} & COST.keys()  # by a sweep that stores them as quantities
    index = [variable for variable in index_variables(sweep.settings.splits.names) if variable.name not in taken]
    labels = [variable for variable in recorded if variable.role == "label"]
    readings = [variable for variable in recorded if variable.role == "reading"]
    variables = (*index, *varied_variables(sweep), *labels, *readings)
    names = [variable.name for variable in variables]
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise sweep.error((SWEEP_SECTION, "quantities"), f"{', '.join(repeated)} would be stored twice; leave them out")
    _check_splits(sweep, labels)
    return Layout(recorder, variables)


def _check_times(sweep: Sweep, recorder: Recorder, experiment: Any) -> None:
    """Refuses stored times that lie closer to each other than the moments that are computed."""
    steps = recorder.steps(experiment)
    if steps is not None and steps.longest > (between := steps.end / sweep.settings.times) * (1 + ROUND_OFF):
        apart, computed = (format_quantity(length, steps.unit) for length in (between, steps.longest))
        raise sweep.error(
            (SWEEP_SECTION, "times"),
            f"{sweep.settings.times}: stored times are {apart} apart, but forces are computed every {computed}, and would lie on "
            f"straight lines in between; take fewer times, or more steps, such as experiment.{steps.shorter}",
        )


@lru_cache(maxsize=4)
def first_case(sweep: Sweep) -> Case:
    """The first possible case of a sweep.

    Raises
    ------
    CaseError
        If a distribution does not suit its place, or none of the first cases is possible.
    """
    if not sweep.checked:
        check_suitable(sweep)
    fault, last = fault_of(sweep), None
    if fault:
        raise CaseError(fault)
    tried = TRIED_OF_GRID if sweep.settings.design == "grid" else TRIED_SPECIMENS
    for specimen in range(min(tried, -(-sweep.samples // sweep.per_specimen))):
        last = drawn_specimen(sweep, specimen)[0]
        if last.case is not None:
            return last.case
    raise CaseError(last.refusal if last else "the sweep has no samples")


def varied_variables(sweep: Sweep) -> list[Variable]:
    """One variable for each place: its number in SI, or the index of the option."""
    numbered = " (number of the option)"
    return [
        Variable(one.variable, one.distribution.unit or "1", one.key + (numbered if one.by_index else ""), "varied")
        for one in sweep.places
    ]


def most_inclusions(document: Any) -> int:
    """Largest number of inclusions that a document can draw."""
    experiment = document.get("experiment") if isinstance(document, dict) else None
    return _longest(experiment.get("inclusions")) if isinstance(experiment, dict) else 0


def _longest(inclusions: Any) -> int:
    """Length of the longest list that may be drawn for a value, whose options may be drawn from options in turn."""
    if isinstance(inclusions, dict) and is_distribution(inclusions):
        return max(map(_longest, inclusions.get("choice", [])), default=0)
    return len(inclusions) if isinstance(inclusions, list) else 0


def split_of(sweep: Sweep, specimen: int, labels: Iterable[Values], recorder_variables: dict[str, Variable]) -> int:
    """Number of the part that a specimen belongs to, from the labels of each of its samples, also of those beyond the last.

    One sample that satisfies the conditions of a part takes its specimen there: no other part may have such a sample, and all
    samples of a specimen belong together.
    """
    splits = sweep.settings.splits
    samples = list(labels) if splits.out_of_distribution else []
    for number, conditions in enumerate(splits.out_of_distribution.values(), 3):
        for one in samples:
            if all(_holds(condition, one, recorder_variables[name]) for name, condition in conditions.items()):
                return number
    share = _dealt(sweep.settings.seed, specimen)
    return 0 if share < splits.train else 1 if share < splits.train + splits.validation else 2


def _dealt(seed: int, specimen: int) -> float:
    """A random number in [0, 1) for a specimen; of those that are dealt together, one lies in each of as many equal parts."""
    hand, place = divmod(specimen, DEALT)
    generator = np.random.default_rng([seed, SPLITTING, hand])
    return float((generator.permutation(DEALT)[place] + generator.random(DEALT)[place]) / DEALT)


def _holds(condition: Condition, labels: Values, variable: Variable) -> bool:
    values = np.atleast_1d(np.asarray(labels[variable.name], dtype=float))
    if "inclusion" in variable.dimensions:
        values = values[: int(labels["inclusion_count"])]
    if not values.size:
        return False
    held = np.ones(values.shape, bool)
    if condition.above is not None:
        held &= values > condition.above
    if condition.below is not None:
        held &= values < condition.below
    if condition.equal is not None:
        wanted = variable.meanings.index(condition.equal) if isinstance(condition.equal, str) else condition.equal
        held &= values == wanted
    return bool(held.all() if condition.of == "all" else held.any())


def _check_splits(sweep: Sweep, labels: list[Variable]) -> None:
    known = {variable.name: variable for variable in labels}
    for split, conditions in sweep.settings.splits.out_of_distribution.items():
        for name, condition in conditions.items():
            place = (SWEEP_SECTION, "splits", "out_of_distribution", split, name)
            if name not in known:
                raise sweep.error(place, f"unknown label{suggestion(name, known)}; labels: {', '.join(known) or 'none'}")
            along = [dimension for dimension in known[name].dimensions if dimension != "inclusion"]
            if along and not sweep.checked:  # those of a store stay readable
                single = ", ".join(one.name for one in labels if set(one.dimensions) <= {"inclusion"})
                raise sweep.error(place, f"has several numbers, along {along[0]}; labels of one number: {single or 'none'}")
            if condition.empty and not sweep.checked:
                raise sweep.error(place, f"nothing is above {condition.above:g} and below {condition.below:g}")
            meanings = known[name].meanings
            if isinstance(condition.equal, str) and condition.equal not in meanings:
                raise sweep.error((*place, "equal"), f"{condition.equal!r}; allowed: {', '.join(meanings) or 'a number'}")
