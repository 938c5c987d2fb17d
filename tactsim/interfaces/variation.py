"""An experiment of which some places vary: what a sweep of many samples is made from in Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from tactsim.errors import CaseError, InvalidQuantity, shown, suggestion
from tactsim.model import FrozenModel, plain
from tactsim.schema_of_model import unit_at
from tactsim.units import parse_quantity, written

EXAMPLE = "{'key.path': tactsim.uniform(low, high)}"
"""What `vary` takes, as messages show it."""


@dataclass(frozen=True)
class Variation:
    """An experiment and, by key path within it, the distributions of what varies, as a sweep file writes them."""

    experiment: Any
    places: Mapping[str, Any]
    case: Any = None
    """The case that the experiment is of, whose title and output the samples have; None of an experiment alone."""

    def __repr__(self) -> str:
        """The kind and what varies: the whole experiment would fill a page of a notebook."""
        varied = ", ".join(f"{place}={shown(distribution)}" for place, distribution in self.places.items())
        return f"<Variation of {self.experiment.kind}: {varied or 'nothing varies'}>"


def uniform(low: Any, high: Any) -> dict[str, Any]:
    """Evenly distributed between two numbers or quantities such as ``"2 mm"``.

    >>> import tactsim as ts
    >>> ts.uniform("2 mm", "6 mm")
    {'uniform': ['2 mm', '6 mm']}

    Raises
    ------
    InvalidQuantity
        If the two do not increase, or are not of one dimension.
    """
    return _checked({"uniform": written([low, high])})


def log_uniform(low: Any, high: Any) -> dict[str, Any]:
    """Evenly distributed in the logarithm between two positive numbers or quantities.

    >>> import tactsim as ts
    >>> ts.log_uniform("6 kPa", "100 kPa")
    {'log_uniform': ['6 kPa', '100 kPa']}

    Raises
    ------
    InvalidQuantity
        If the two do not increase, are not positive, or are not of one dimension.
    """
    return _checked({"log_uniform": written([low, high])})


def normal(mean: Any, deviation: Any, *, low: Any = None, high: Any = None) -> dict[str, Any]:
    """Normal with a mean and a standard deviation, cut off below ``low`` and above ``high``: give both bounds or neither.

    >>> import tactsim as ts
    >>> ts.normal("4 mm", "1 mm", low="2 mm", high="6 mm")
    {'normal': ['4 mm', '1 mm'], 'within': ['2 mm', '6 mm']}

    Raises
    ------
    InvalidQuantity
        If the deviation is not positive, one bound is missing, or the values are not of one dimension.
    """
    if (low is None) != (high is None):
        raise InvalidQuantity(f"normal: low is {shown(low)} and high is {shown(high)}; give both bounds or neither")
    return _checked({"normal": written([mean, deviation])} | ({} if low is None else {"within": written([low, high])}))


def choice(*options: Any, weights: Iterable[float] | None = None) -> dict[str, Any]:
    """One of the options, numbers, quantities, names, or models such as materials; equally probable without weights.

    >>> import tactsim as ts
    >>> ts.choice("icf_stable", "b1a_stable", weights=(3, 1))
    {'choice': ['icf_stable', 'b1a_stable'], 'weights': [3, 1]}

    Raises
    ------
    InvalidQuantity
        If there is no option, the options stand in a list, or the weights do not fit them.
    """
    if not options or (len(options) == 1 and isinstance(options[0], list | tuple)):
        given = f"{shown(options[0])} is one option" if options else "no option is given"
        raise InvalidQuantity(f"choice: {given}; give the options one by one, such as choice('2 mm', '4 mm')")
    given_weights = list(weights) if isinstance(weights, Iterable) else weights
    return _checked({"choice": plain(options)} | ({} if weights is None else {"weights": written(given_weights)}))


def check_places(experiment: FrozenModel, places: Mapping[str, Any]) -> None:
    """Check that an experiment has the places that vary, and that they take the units of what is drawn; what lies in a part that
    itself varies is left to the sweep, as are ranges and options.

    Raises
    ------
    CaseError
        If they are no mapping of key paths, or with the key path, the key that is unknown, and those that are known, or the
        quantity whose dimension is wrong.
    """
    check_key_paths(places)
    for place, distribution in places.items():
        keys = place.split(".")
        outer = {".".join(keys[:length]) for length in range(1, len(keys))}
        if not places.keys() & (outer | {f"{part}.kind" for part in outer}):
            _check_unit(place, distribution, _unit_at(experiment, keys))


def check_key_paths(places: object) -> None:
    """Check that what shall vary is a mapping from key paths.

    Raises
    ------
    CaseError
        With what it is instead.
    """
    if not isinstance(places, Mapping):
        raise CaseError(f"vary: {shown(places)} is not a mapping from key paths to distributions; expected {EXAMPLE}")
    for place in places:
        if not isinstance(place, str):
            raise CaseError(f"vary: {shown(place)} is not a key path, which is a text; expected {EXAMPLE}")


def _check_unit(place: str, distribution: Any, unit: str) -> None:
    """Check that drawn quantities are of a unit; an empty one is that of a place without unit, or whose unit is not known."""
    if not unit or not isinstance(distribution, dict):
        return
    for entry in (one for entries in distribution.values() if isinstance(entries, list) for one in entries):
        if isinstance(entry, str) and entry.lstrip()[:1] in tuple("+-.0123456789"):  # no name, which a place may take as well
            try:
                parse_quantity(entry, unit)
            except InvalidQuantity as error:
                raise CaseError(f"vary: {place}: {error}") from None


def _unit_at(value: Any, keys: list[str]) -> str:
    """The SI unit of a place of an experiment, empty where there is none or it is not known yet.

    Raises
    ------
    CaseError
        If there is no such place.
    """
    owner, above = value, 0
    for number, key in enumerate(keys):
        where = ".".join(("vary", *keys[:number])).replace("vary.", "vary: ", 1)
        if isinstance(value, FrozenModel):
            entries = {field.alias or name: getattr(value, name) for name, field in type(value).model_fields.items()}
            if key not in entries:
                raise CaseError(f"{where}: unknown key {key!r}{suggestion(key, entries)}; allowed: {', '.join(entries)}")
            owner, above, value = value, number, entries[key]
        elif isinstance(value, list | tuple):
            if key not in (allowed := [str(index) for index in range(len(value))]):
                raise CaseError(f"{where}: a list without an entry {key!r}; entries: {', '.join(allowed) or 'none'}")
            value = value[int(key)]
        elif isinstance(value, dict) and key in value:
            value = value[key]
        elif value is None or isinstance(value, dict):
            return ""  # what a sweep makes there is checked with its first sample
        else:
            raise CaseError(f"{where}: {shown(value)} has no entry {key!r}")
    return unit_at(type(owner), {}, tuple(int(key) if key.isdecimal() else key for key in keys[above:]))


def _checked(distribution: dict[str, Any]) -> dict[str, Any]:
    """The distribution, refused if a sweep would refuse it."""
    from tactsim.interfaces.distributions import distribution as read  # loads scipy

    name = next(iter(distribution))
    try:
        read(distribution)
    except InvalidQuantity as error:
        raise InvalidQuantity(f"{name}: {str(error).removeprefix(f'{name}: ')}") from None
    return distribution
