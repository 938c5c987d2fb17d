"""JSON Schema of a case file, for completion and checking in editors."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from tactsim.case.model import any_experiment, case_class
from tactsim.field_docstrings import docstrings_alone, field_descriptions
from tactsim.units import format_quantity

DRAFT = "http://json-schema.org/draft-07/schema#"
EXAMPLE = re.compile(r"\n\n>>> .*?(?=\n\n|\Z)", re.S)
"""Of the use from Python, which a file cannot follow."""


class SchemaWithDescriptions(GenerateJsonSchema):
    """Describes every field by the docstring below it."""

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """The schema of a model, its fields described, without the example of its docstring."""
        fragment = super().model_schema(schema)
        if "description" in fragment:
            fragment["description"] = EXAMPLE.sub("", fragment["description"])
        described = field_descriptions(schema["cls"])
        for name, field in schema["cls"].model_fields.items():
            entry = fragment.get("properties", {}).get(field.alias or name)
            if entry is not None and name in described and "description" not in entry:
                entry["description"] = described[name]
        return fragment


def case_json_schema() -> dict[str, Any]:
    """JSON Schema (draft 7, which editors know) of a case file with every registered experiment; quantities are text."""
    schema = described(case_class(any_experiment()))
    return {"$schema": DRAFT, **schema, "title": "tactsim case"}


def described(model: type[BaseModel]) -> dict[str, Any]:
    """JSON Schema of a model: quantities as text, in the words of draft 7, members of unions told apart by their keys."""
    with docstrings_alone():
        made = model.model_json_schema(by_alias=True, mode="validation", schema_generator=SchemaWithDescriptions)
    schema = _readable(made)
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
