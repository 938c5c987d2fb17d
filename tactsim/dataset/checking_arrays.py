"""Whether the arrays and attributes of a store are those that its sweep writes: names, types, shapes, units, words."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

from tactsim.dataset.array_description import ArrayDescription
from tactsim.interfaces.variable import Variable
from tactsim.outside.text import one_line

WORDS = ("long_name", "flag_meanings")
"""Attributes whose wording may change from one version of tactsim to the next."""


def differences(array: ArrayDescription, variable: Variable) -> Iterator[tuple[str, str]]:
    """What an array says, and how it differs from the variable that it holds; the number of samples is not looked at."""
    expected: dict[str, Any] = {
        "dtype": variable.dtype,
        "shape": [*variable.sizes],
        "dimension_names": ["sample", *variable.dimensions],
        "fill_value": "NaN" if variable.dtype.startswith("f") else variable.fill,
        **variable.attributes(),
    }
    found: dict[str, Any] = {
        "dtype": array.dtype,
        "shape": [*array.shape[1:]],
        "dimension_names": [*array.dimensions],
        "fill_value": array.told["fill_value"],
        **array.attributes,
    }
    for key in sorted(expected.keys() | found.keys()):
        if key not in expected:
            yield key, f"{key} is {_shown(found[key])}, which tactsim does not write"
        elif key not in found:
            yield key, f"{key} is missing; expected: {_shown(expected[key])}"
        elif found[key] != expected[key]:
            yield key, f"{key} is {_shown(found[key])}; expected: {_shown(expected[key])}"


def wrong_arrays(arrays: Iterable[ArrayDescription], variables: Iterable[Variable]) -> Iterator[tuple[str, str]]:
    """Name of an array -> how it differs, but for the wording."""
    known = {variable.name: variable for variable in variables}
    for array in arrays:
        if array.name in known:
            for key, words in differences(array, known[array.name]):
                if key not in WORDS:
                    yield array.name, words


def earlier_words(names: Iterable[str]) -> str:
    """What is told of a store that never had some arrays."""
    return (
        f"an earlier version of tactsim began this data set, which did not store {', '.join(names)}; it can be read, and the "
        "long_name of each of its arrays says what that holds, but it can neither be gone on with nor checked by this version"
    )


def _shown(value: Any) -> str:
    return one_line(json.dumps(value), 160)
