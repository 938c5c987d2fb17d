"""Strict JSON of others as plain values: finite numbers, bounded in count and depth before anything walks through them."""

from __future__ import annotations

import json
import math
from typing import Any

from tactsim.errors import StorageError
from tactsim.outside.text import one_line

MOST_VALUES = 10_000_000
"""Values of a text, each of which may take 70 bytes in memory: twice those of matrices of 256 x 256 taxels over twenty steps."""
DEEPEST = 32
"""Lists and mappings inside each other; those of a result are at most eight deep."""
LONGEST_INTEGER = 40
"""Digits: more than any count or seed has, and few enough to become a float."""
_NESTING = (dict, list)


def read_json(text: str, name: str, *, deepest: int = DEEPEST) -> Any:
    """The values in a JSON text.

    Parameters
    ----------
    name : how messages call it
    deepest : levels of lists and mappings inside each other that are allowed

    Raises
    ------
    StorageError
        If it is no JSON, holds a number that is not finite, or is larger or deeper than anything of tactsim.
    """
    if sum(map(text.count, ",[{")) > MOST_VALUES:
        raise StorageError(f"{one_line(name)} is damaged: it holds more than {MOST_VALUES} values")
    try:
        content = json.loads(text, parse_constant=_no_number, parse_float=_float, parse_int=_integer)
    except RecursionError:
        raise _too_deep(name, deepest) from None
    except ValueError as error:
        raise StorageError(f"{one_line(name)} is damaged: {one_line(error)}") from None
    _check_depth(content, name, deepest)
    return content


def _check_depth(content: Any, name: str, deepest: int) -> None:
    level = [content] if isinstance(content, _NESTING) else []
    for _ in range(deepest):
        inner = [value.values() if isinstance(value, dict) else value for value in level]
        level = [item for items in inner for item in items if isinstance(item, _NESTING)]
        if not level:
            return
    raise _too_deep(name, deepest)


def _too_deep(name: str, deepest: int) -> StorageError:
    return StorageError(f"{one_line(name)} is damaged: more than {deepest} lists and mappings inside each other")


def _float(text: str) -> float:
    value = float(text)
    return value if math.isfinite(value) else _no_number(text)


def _integer(text: str) -> int:
    return int(text) if len(text) <= LONGEST_INTEGER else _no_number(text)


def _no_number(text: str) -> Any:
    raise ValueError(f"{one_line(text, LONGEST_INTEGER)} is not a finite number of JSON")
