"""Turns what a model refused into sentences: the key path, the value, and what is allowed there."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core.core_schema import ErrorType

from tactsim.errors import Refused, shown, suggestion
from tactsim.outside.text import one_line
from tactsim.schema_of_model import Path, keys_of, members_of, resolved, schema_at, schema_of, tag_of, tags_of, value_at
from tactsim.units import DECIMAL_POINT, format_quantity

_TYPES = {
    "string": "a text",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
    "array": "a list",
    "object": "a mapping",
    "null": "null",
}
_BOUNDS = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most", "multiple_of": "a multiple of"}
_PYDANTIC_TYPES = frozenset(get_args(ErrorType))
_MISSING = object()
LONGEST_PLACE = 200
"""Characters of a place that `first_fault` shows."""
OF_KEY = "[key]"
"""What the validator appends to the location of a key that it refuses."""


def refusals_of(error: ValidationError, value: Any, model: type[BaseModel]) -> dict[Path, str]:
    """Key path -> message for every place of ``value``, plain data, that the model refused."""
    schema = schema_of(model)
    messages: dict[Path, list[str]] = {}
    for detail in details(error):
        path = path_in_file(detail["loc"], value, str(detail["type"]))
        if detail["type"] in ("too_short", "too_long") and _fits(detail.get("ctx", {}), value_at(value, path)):
            continue  # pydantic counts only the valid entries, and the others have their own message
        place, message = _explained(detail, path, value, schema)
        of_place = messages.setdefault(place, [])
        if message not in of_place:
            of_place.append(message)
    return {path: "; or ".join(of_place) for path, of_place in messages.items()}


def first_fault(error: ValidationError) -> str:
    """The first place that a model refused and why, on one line: of a file that no user writes, where one tells enough."""
    first = next(details(error))
    place = one_line(".".join(map(str, first["loc"])), LONGEST_PLACE)
    reason = one_line(_reason(first))
    return f"{place}: {reason}" if place else reason


def details(error: ValidationError, location: tuple[str | int, ...] = ()) -> Iterator[dict[str, Any]]:
    """Every single refusal; a validator that itself validated a model wraps the refusals of that model."""
    for detail in error.errors(include_url=False):
        place = (*location, *detail["loc"])
        inner = detail.get("ctx", {}).get("error")
        inner = inner.reasons if isinstance(inner, Refused) else inner
        if isinstance(inner, ValidationError):
            yield from details(inner, place)
        else:
            yield {**detail, "loc": place}


def _reason(detail: dict[str, Any]) -> str:
    """Why a validator refused, without the name of pydantic's error before it."""
    by_validator = detail["type"] in ("value_error", "assertion_error")
    return str(detail["ctx"]["error"] if by_validator else detail["msg"])


def as_written(value: Any) -> str:
    """``value`` as a case file writes it, shortened."""
    words = {None: "null", True: "true", False: "false"}
    return words[value] if value is None or isinstance(value, bool) else shown(value)


def path_in_file(location: tuple[str | int, ...], value: Any, error_type: str) -> Path:
    """The key path without the names of union members that the validator puts into a location."""
    path: list[str | int] = []
    for position, key in enumerate(location):
        if isinstance(value, dict) and key in value and not _is_member(key, location[position + 1 :], value):
            value = value[key]
        elif isinstance(value, list) and isinstance(key, int):
            value = value[key] if key < len(value) else _MISSING
        elif not (isinstance(value, dict) and position == len(location) - 1 and error_type == "missing"):
            continue
        path.append(key)
    return tuple(path)


def _is_member(key: str | int, rest: tuple[str | int, ...], value: dict[str, Any]) -> bool:
    """Whether ``key`` is the tag of a union although the mapping has a key of the same name."""
    return value.get("kind") == key and bool(rest) and rest[0] in value and not isinstance(value[str(key)], dict | list)


def _explained(detail: dict[str, Any], path: Path, root: Any, schema: dict[str, Any]) -> tuple[Path, str]:
    """The key path to blame and the message for one refusal."""
    error_type, context = str(detail["type"]), detail.get("ctx", {})
    if detail["loc"][-1:] == (OF_KEY,):
        names = schema_at(schema, root, path[:-1]).get("propertyNames", {})
        return path, f"the key {as_written(path[-1])} is not allowed; expected {names.get('description', detail['msg'])}"
    value = value_at(root, path)
    fragment = schema_at(schema, root, path)
    if error_type == "extra_forbidden":
        allowed = keys_of(schema_at(schema, root, path[:-1]), schema)
        comma = f"; {DECIMAL_POINT}" if str(path[-1]).isdecimal() else ""
        meant = _deeper(path, root, schema, allowed) or suggestion(str(path[-1]), allowed)
        return path, f"unknown key{meant}; allowed: {', '.join(allowed) or 'none'}{comma}"
    if error_type == "missing":
        return path, f"missing; expected {_expectation(fragment, schema)}"
    if error_type == "union_tag_not_found":
        place = _tag_path(context, path)
        return place, f"missing; choices: {', '.join(tags_of(fragment, schema, str(place[-1])))}"
    if error_type == "union_tag_invalid":
        tag, choices = str(context["tag"]), re.findall(r"'([^']*)'", context["expected_tags"])
        place = _tag_path(context, path)
        return place, f"unknown {place[-1]} {as_written(tag)}{suggestion(tag, choices)}; choices: {', '.join(choices)}"
    if error_type in ("value_error", "assertion_error") or error_type not in _PYDANTIC_TYPES:
        return _blamed_within(path, value, _reason(detail))
    if error_type == "finite_number":
        return path, f"{as_written(value)} is not finite; expected {_expectation(fragment, schema)}"
    if error_type in ("literal_error", "enum"):
        choices = re.findall(r"'([^']*)'", context["expected"])
        return path, f"{as_written(value)} is not allowed{suggestion(str(value), choices)}; choices: {context['expected']}"
    return path, _out_of_bounds(
        context, value, fragment
    ) or f"{as_written(value)} is not allowed; expected {_wanted(detail, fragment, schema)}{_instead(value)}"


def _deeper(path: Path, root: Any, schema: dict[str, Any], allowed: Sequence[str]) -> str:
    """What to say of an unknown key that is one of a mapping beside it, as ``recess`` is of ``experiment``."""
    *above, key = path
    beside = [name for name in allowed if key in keys_of(schema_at(schema, root, (*above, name)), schema)]
    return f" (did you mean {'.'.join(map(str, (*above, beside[0], key)))!r}?)" if beside else ""


def _instead(value: Any) -> str:
    """What to say of a text that would be a number with a decimal point, or without its percent sign."""
    if not isinstance(value, str):
        return ""
    if percent := re.fullmatch(r"([-+]?\d+(?:\.\d+)?)\s*%", value):
        return f", {float(percent[1]) / 100:.15g} for {value}"
    return f"; {DECIMAL_POINT}" if re.fullmatch(r"[-+]?\d*,\d+", value) else ""


def _blamed_within(path: Path, value: Any, message: str) -> tuple[Path, str]:
    """The key path and the message of a check of a whole mapping, which may begin with the keys within it that are to blame."""
    keys, colon, words = message.partition(": ")
    within: Path = ()
    for key in keys.split(".") if colon else ():
        step = int(key) if isinstance(value, list) and key.isdecimal() else key
        try:
            value = value[step]
        except (LookupError, TypeError):
            return path, message
        within = (*within, step)
    return (*path, *within), words if within else message


def _out_of_bounds(context: dict[str, Any], value: Any, fragment: dict[str, Any]) -> str:
    """The message for a number beyond its bound or a list or text of the wrong length, else an empty string."""
    for name, words in _BOUNDS.items():
        if name in context:
            unit = next((one["unit"] for one in (fragment, *fragment.get("anyOf", ())) if "unit" in one), "")
            bound = format_quantity(context[name], unit) if unit else f"{context[name]}"
            return f"{as_written(value)} is out of range; must be {words} {bound}"
    for name, words in (("min_length", "at least"), ("max_length", "at most")):
        if name in context:
            one, several = ("character", "characters") if isinstance(value, str) else ("entry", "entries")
            counted = f"{context[name]} {one if context[name] == 1 else several}"
            return f"{as_written(value)} has the wrong length; expected {words} {counted}"
    return ""


def _fits(context: dict[str, Any], value: Any) -> bool:
    length = len(value) if isinstance(value, list | dict | str) else 0
    return int(context.get("min_length") or 0) <= length <= int(context.get("max_length") or length)


def _wanted(detail: dict[str, Any], fragment: dict[str, Any], schema: dict[str, Any]) -> str:
    described = _expectation(fragment, schema)
    return described if described != "a value" else str(detail["msg"]).removeprefix("Input should be ")


def _expectation(fragment: dict[str, Any], schema: dict[str, Any]) -> str:
    """What a fragment of the schema accepts, in words."""
    fragment = resolved(fragment, schema)
    if "const" in fragment:
        return as_written(fragment["const"])
    if "enum" in fragment:
        return "one of " + ", ".join(map(shown, fragment["enum"]))
    if "unit" in fragment:
        return f"a quantity with its unit, such as {fragment['examples'][0]!r}"
    members = list(members_of(fragment, schema))
    tags = tags_of(fragment, schema)
    if len(members) > 1 or tags:
        words = [_expectation(member, schema) for member in members if not tag_of(member)]
        return " or ".join(dict.fromkeys([*words, *([f"a mapping with a kind of {', '.join(tags)}"] if tags else [])]))
    if fragment.get("type") == "object" and "properties" in fragment:
        return f"a mapping with {', '.join(fragment['properties'])}"
    return _TYPES.get(str(fragment.get("type")), "a value")


def _tag_path(context: dict[str, Any], path: Path) -> Path:
    return (*path, str(context["discriminator"]).strip("'"))
