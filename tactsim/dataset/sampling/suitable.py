"""Whether what a distribution draws has the type, the unit and the dimension of the place where it stands."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import ValidationError

from tactsim.case.model import case_class, experiment_class
from tactsim.case.yaml_reading import Path, Problem
from tactsim.dataset.sampling.fixed_parts import FixedParts
from tactsim.dataset.sampling.places import Place, filled
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.errors import InvalidQuantity, TactsimError, UnknownName
from tactsim.interfaces.distributions import Listed
from tactsim.refusals import as_written, details, path_in_file, refusals_of
from tactsim.schema_of_model import value_at

ENDS = (0.0, 1.0 - 2.0**-53)
"""Shares of the probability at which a distribution without options is tried."""
MOST_TRIED = 100
"""Cases that are tried: options of long lists within others are left to the drawing."""
WHOLE = "a whole number"
"""What `refusals` calls the value of a place that takes no fractions."""

DEPENDENT = {
    *("greater_than", "greater_than_equal", "less_than", "less_than_equal", "multiple_of", "too_short", "too_long"),
    *("string_too_short", "string_too_long", "extra_forbidden", "missing", "assertion_error"),
}
"""Refusals by pydantic that need not befall other draws: of bounds, and of keys that belong to another kind."""

Entry = tuple[Any, float]
BOUNDS = {"greater_than": "gt", "greater_than_equal": "ge", "less_than": "lt", "less_than_equal": "le"}
"""Refusals of numbers beyond one bound, and what pydantic calls the bound."""


@dataclass(frozen=True)
class Beyond:
    """A number that was tried at a place, the bounds of the place beyond which it lies, and the refusal in words."""

    number: float
    bounds: frozenset[tuple[str, float]]
    reason: str


def check_suitable(sweep: Sweep) -> None:
    """Check ends and options of every distribution against the field of its place.

    What is out of bounds in part, or only beside the values of other places, is left to the drawing, which draws again: a part of
    a distribution may well be impossible.

    Raises
    ------
    CaseError
        With a line for every distribution with one of its values that has another type, unit or dimension than the place, or
        whose numbers all lie beyond the same bound of the place, and for all that does not vary and is refused whatever is drawn:
        an option that is misspelt would be drawn again until another comes, and be missed when all is computed.
    """
    try:
        model = case_class(experiment_class(sweep.kind))
    except UnknownName:
        return  # drawing the samples reports it
    context = {"units": "required", "folder": sweep.document.folder}
    entries = {place.path: _tried(place) for place in sweep.places}
    before = {path: _cases_before(path, entries) for path in entries}
    cases = max(before[path] * len(tried) for path, tried in entries.items())
    beyond: dict[Path, list[Beyond]] = {}
    wrong: dict[Path, Problem] = {}
    fixed = FixedParts(sweep.document.value)
    for case in range(min(cases, MOST_TRIED)):
        drawn = {path: tried[case // before[path] % len(tried)] for path, tried in entries.items()}
        used: dict[Path, float] = {}
        value = filled(sweep.document.value, (), drawn, used)
        try:
            model.model_validate_json(json.dumps(value), strict=True, context=context)
        except ValidationError as error:
            unsuitable, reasons = _wrong_in_type(error, value), refusals_of(error, value, model)
            fixed.refuse(used, error, value, model, unsuitable)
            for path in used:
                if (in_case := _in_case(path, entries)) in unsuitable and not isinstance(drawn[path][0], dict | list):
                    wrong.setdefault(path, _refused(sweep, path, reasons[in_case]))
                    continue
                bounds = _bounds_beyond(error, value, in_case)
                reason = reasons[in_case] if bounds else ""
                beyond.setdefault(path, []).append(Beyond(drawn[path][1], bounds, reason))
        except TactsimError:
            used = {}  # of a whole case, such as a file that is gone
        else:
            fixed.accept(used)
            for path in used:
                beyond.setdefault(path, []).append(Beyond(drawn[path][1], frozenset(), ""))
    problems = [*wrong.values(), *(fixed.problems() if cases <= MOST_TRIED else ()), *_wholly_beyond(sweep, entries, beyond)]
    if problems:
        raise sweep.errors(problems)


def _wrong_in_type(error: ValidationError, value: Any) -> set[Path]:
    """Places that were refused for their type, unit or dimension by every alternative that they have."""
    by_place: dict[Path, list[bool]] = {}
    for detail in details(error):
        error_type, cause = str(detail["type"]), detail.get("ctx", {}).get("error")
        of_type = isinstance(cause, InvalidQuantity) if cause is not None else error_type not in DEPENDENT
        by_place.setdefault(path_in_file(detail["loc"], value, error_type), []).append(of_type)
    return {path for path, of_type in by_place.items() if all(of_type)}


def _wholly_beyond(sweep: Sweep, entries: Mapping[Path, list[Entry]], beyond: Mapping[Path, list[Beyond]]) -> Iterator[Problem]:
    """Numbers of which the least and the largest lie beyond the same bound, and so do all."""
    of_numbers = {place.path for place in sweep.places if not place.by_index}
    for path, tries in beyond.items():
        whole = path in of_numbers and {one.number for one in tries} == {number for _, number in entries[path]}
        if whole and frozenset.intersection(*(one.bounds for one in tries)):
            yield _refused(sweep, path, f"{tries[0].reason}, which none of its values is")


def _bounds_beyond(error: ValidationError, value: Any, path: Path) -> frozenset[tuple[str, float]]:
    """Bounds for which the value at a path was refused; none if it was refused for anything else too."""
    refused = [detail for detail in details(error) if path_in_file(detail["loc"], value, str(detail["type"])) == path]
    if not all(detail["type"] in BOUNDS for detail in refused):
        return frozenset()
    return frozenset((detail["type"], float(detail["ctx"][BOUNDS[detail["type"]]])) for detail in refused)


def _tried(place: Place) -> list[Entry]:
    """Entries that are tried for all: both ends; of options all, but of numbers the least, the largest and one that is not
    whole.
    """
    listed = place.distribution
    if not isinstance(listed, Listed):
        return [listed.value(share) for share in ENDS]
    numbers = list(range(len(listed.options)))
    if listed.numbers is not None:
        fractions = [number for number in numbers if isinstance(listed.options[number], float)]
        ends = {int(np.argmin(listed.numbers.values)), int(np.argmax(listed.numbers.values))}
        numbers = sorted({*ends, *fractions[:1]})
    return [(listed.options[number], float(number)) for number in numbers]


def _cases_before(path: Path, entries: dict[Path, list[Entry]]) -> int:
    """Number of cases in which each option of the choices around a place is drawn once."""
    cases = 1
    for length in range(len(path)):
        cases *= len(entries.get(path[:length], [None]))
    return cases


def _in_case(path: Path, entries: dict[Path, list[Entry]]) -> Path:
    """The key path of a place in a case, where an option stands in place of its choice."""
    kept: list[str | int] = []
    number = 0
    while number < len(path):
        if path[:number] in entries:
            number += 2  # the key choice and the number of the option
            continue
        kept.append(path[number])
        number += 1
    return tuple(kept)


def _refused(sweep: Sweep, path: Path, reason: str) -> Problem:
    given = as_written(value_at(sweep.document.value, path))
    hint = "; these are drawn by {integer: [first, last]} or listed by {values: [...]}" if reason.endswith(WHOLE) else ""
    return Problem(path, 0, f"{given} does not suit this place: {reason}{hint}")
