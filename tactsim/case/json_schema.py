"""JSON Schema of a case file, for completion and checking in editors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from tactsim.case.field_docstrings import SchemaWithDescriptions
from tactsim.case.model import any_experiment, case_class
from tactsim.units import format_quantity

DRAFT = "http://json-schema.org/draft-07/schema#"


def case_json_schema() -> dict[str, Any]:
    """JSON Schema (draft 7, which editors know) of a case file with every registered experiment; quantities are text."""
    schema = described(case_class(any_experiment()))
    return {"$schema": DRAFT, **schema, "title": "tactsim case"}


def described(model: type[BaseModel]) -> dict[str, Any]:
    """JSON Schema of a model: quantities as text, in the words of draft 7, members of unions told apart by their keys."""
    schema = _readable(model.model_json_schema(by_alias=True, mode="validation", schema_generator=SchemaWithDescriptions))
    for key, reference in sorted(_told_apart(schema)):
        definition = schema["$defs"][reference.rpartition("/")[2]]
        definition["required"] = list(dict.fromkeys([key, *definition.get("required", ())]))
    return schema


def _told_apart(schema: dict[str, Any]) -> set[tuple[str, str]]:
    """Keys that definitions must name, like ``kind``, with references to these: the experiments and the members of unions."""
    experiment = schema["properties"].get("experiment", {})
    return {*_union_members(schema), *([("kind", experiment["$ref"])] if "$ref" in experiment else ())}


def _union_members(fragment: Any) -> Iterator[tuple[str, str]]:
    if isinstance(fragment, dict) and "discriminator" in fragment:
        key = fragment["discriminator"]
        yield from ((key["propertyName"], reference) for reference in key.get("mapping", {}).values())
    for item in fragment.values() if isinstance(fragment, dict) else fragment if isinstance(fragment, list) else ():
        yield from _union_members(item)


def _readable(fragment: Any) -> Any:
    """The fragment with the defaults of quantities as text, in the words of draft 7."""
    if isinstance(fragment, list):
        return [_readable(item) for item in fragment]
    if not isinstance(fragment, dict):
        return fragment
    readable = {key: _readable(item) for key, item in fragment.items()}
    default, unit = readable.get("default"), _unit(readable)
    if unit and isinstance(default, int | float):
        readable["default"] = format_quantity(default, unit)
    if isinstance(readable.get("prefixItems"), list):
        readable["items"] = readable.pop("prefixItems")
    return readable


def _unit(fragment: dict[str, Any]) -> str:
    units = [part["unit"] for part in (fragment, *fragment.get("anyOf", ())) if isinstance(part.get("unit"), str)]
    return units[0] if units else ""
