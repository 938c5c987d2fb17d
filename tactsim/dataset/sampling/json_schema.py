"""JSON Schema of a sweep file: that of a case whose experiment may have a distribution for any value, with the section sweep."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pydantic import TypeAdapter

from tactsim.case.json_schema import DRAFT, case_json_schema, described
from tactsim.case.loading import SWEEP_SCHEMA, SWEEP_SECTION
from tactsim.case.model import Output
from tactsim.dataset.sampling.settings import SweepSettings
from tactsim.interfaces.distributions import MOST_OPTIONS
from tactsim.units import Length

Fragment = dict[str, Any]
PREFIX = "sweep_settings_"
"""Of the definitions of the section, in which nothing varies."""
QUANTITY = {key: value for key, value in TypeAdapter(Length).json_schema().items() if key in ("type", "pattern")}
"""Any text with a unit."""
ITEMS: dict[str, Fragment] = {"quantity": QUANTITY, "number": {"type": "number"}, "integer": {"type": "integer"}}
ANNOTATIONS = ("title", "description", "default", "examples", "unit")
VARYING = {"quantity": "varying_quantity", "number": "varying_number", "integer": "varying_integer"}
"""What may vary -> definition of its distributions."""


def sweep_json_schema() -> Fragment:
    """JSON Schema (draft 7) of a sweep file with every registered experiment."""
    case, settings = case_json_schema(), _prefixed(described(SweepSettings))
    defined = case["$defs"].items()
    definitions = {name: one if name == Output.__name__ else _inner(one, f"#/$defs/{name}") for name, one in defined}
    definitions |= {VARYING[kind]: _distributions(kind, item) for kind, item in ITEMS.items()}
    definitions |= {f"{PREFIX}{name}": definition for name, definition in settings.pop("$defs", {}).items()}
    properties = {
        "schema": case["properties"]["schema"] | {"const": SWEEP_SCHEMA, "description": "Version of the sweep format."},
        "title": case["properties"]["title"],
        "experiment": _inner(case["properties"]["experiment"], "#/properties/experiment"),
        "output": case["properties"]["output"],
        SWEEP_SECTION: settings,
    }
    whole = case | {
        "$schema": DRAFT,
        "title": "tactsim sweep",
        "description": "A case in which values of the experiment vary.",
        "$defs": definitions,
    }
    return whole | {"properties": properties, "required": [*case["required"], SWEEP_SECTION]}


def _distributions(kind: str, item: Fragment) -> Fragment:
    """Every distribution of one kind of number."""
    pair = {"type": "array", "items": item, "minItems": 2, "maxItems": 2}
    spread = {"type": "array", "items": [item, item, {"type": "integer", "minimum": 2}], "minItems": 3, "maxItems": 3}
    listed = _mapping("values", {"type": "array", "items": item, "minItems": 1, "maxItems": MOST_OPTIONS}, weights=_WEIGHTS)
    members = [listed, _mapping("range", spread | {"description": "First, last, number of values."})]
    if kind == "integer":
        members.append(_mapping("integer", pair | {"description": "First and last whole number."}))
    else:
        members += [_mapping(name, pair | {"description": "Least and largest."}) for name in ("uniform", "log_uniform")]
        members.append(_mapping("normal", pair | {"description": "Mean and standard deviation."}, within=pair))
    members.append(_choice({"anyOf": [item, {"$ref": f"#/$defs/{VARYING[kind]}"}]}))
    return {"description": f"A distribution of a {kind}.", "anyOf": members}


_WEIGHTS: Fragment = {"type": "array", "items": {"type": "number", "minimum": 0}}


def _mapping(name: str, entries: Fragment, **others: Fragment) -> Fragment:
    properties = {name: entries, **others}
    return {"type": "object", "properties": properties, "required": [name], "additionalProperties": False}


def _inner(fragment: Any, pointer: str) -> Any:
    """The fragment at ``pointer`` of the schema with a distribution allowed for every value within it."""
    if isinstance(fragment, list):
        return [_inner(item, f"{pointer}/{number}") for number, item in enumerate(fragment)]
    if not isinstance(fragment, dict):
        return fragment
    varying = dict(fragment)
    for key, value in fragment.items():
        if key == "properties":
            escaped = {name: name.replace("~", "~0").replace("/", "~1") for name in value}
            varying[key] = {name: _place(item, f"{pointer}/{key}/{escaped[name]}") for name, item in value.items()}
        elif key in ("items", "additionalProperties", "patternProperties") and not isinstance(value, bool):
            several = isinstance(value, list)
            varying[key] = (
                [_place(item, f"{pointer}/{key}/{n}") for n, item in enumerate(value)]
                if several
                else _place(value, f"{pointer}/{key}")
            )
        elif key in ("anyOf", "oneOf", "allOf"):
            varying[key] = _inner(value, f"{pointer}/{key}")
    return varying


def _place(value: Fragment, pointer: str) -> Fragment:
    """A value, or a distribution of it; what discriminates members of a union is fixed."""
    if "const" in value:
        return value
    annotations = {key: value[key] for key in ANNOTATIONS if key in value}
    content = {key: item for key, item in value.items() if key not in annotations}
    kinds = sorted(set(_kinds(value)))
    if content == QUANTITY:
        return {**annotations, "anyOf": [QUANTITY, {"$ref": f"#/$defs/{VARYING['quantity']}"}]}
    varying = [*({"$ref": f"#/$defs/{VARYING[kind]}"} for kind in kinds), _choice({"$ref": pointer})]
    return {**annotations, "anyOf": [_inner(content, f"{pointer}/anyOf/0"), *varying]}


def _choice(option: Fragment) -> Fragment:
    options = {"type": "array", "items": option, "minItems": 1, "maxItems": MOST_OPTIONS}
    return _mapping("choice", options, weights=_WEIGHTS)


def _kinds(value: Fragment) -> Iterator[str]:
    """Which kinds of numbers a value can be."""
    if value.get("type") == "string" and "unit" in value:
        yield "quantity"
    elif value.get("type") in ("number", "integer"):
        yield str(value["type"])
    for member in (*value.get("anyOf", ()), *value.get("oneOf", ())):
        yield from _kinds(member)


def _prefixed(fragment: Any) -> Any:
    """The schema with references to definitions of the section."""
    if isinstance(fragment, list):
        return [_prefixed(item) for item in fragment]
    if not isinstance(fragment, dict):
        return re.sub(r"^#/\$defs/", f"#/$defs/{PREFIX}", fragment) if isinstance(fragment, str) else fragment
    return {key: _prefixed(item) for key, item in fragment.items()}
