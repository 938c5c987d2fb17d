"""The JSON Schema of a model, and which part of it describes a place of a document."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

from pydantic import BaseModel

from tactsim.field_docstrings import docstrings_alone
from tactsim.marked_functions import MarkedFunction, functions_outside
from tactsim.registry import registered_outside

Path = tuple[str | int, ...]
"""Keys and numbers that lead to a value of a case."""
PACKAGE = "tactsim"
"""What is defined in it does not change while a process runs."""


def schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """The JSON Schema of a model with every kind that is known now, also those that a notebook has defined since; only read."""
    return _schema_with(model, tuple(registered_outside(PACKAGE)), functions_outside(PACKAGE))


@lru_cache(maxsize=64)
def _schema_with(model: type[BaseModel], classes: tuple[type, ...], functions: tuple[MarkedFunction, ...]) -> dict[str, Any]:
    """It takes long to make."""
    with docstrings_alone():
        return model.model_json_schema(by_alias=True)


def value_at(value: Any, path: Path) -> Any:
    """What plain data hold at a key path, None where they hold nothing."""
    for key in path:
        try:
            value = value[key]
        except (LookupError, TypeError):
            return None
    return value


def resolved(fragment: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    """The fragment that a reference stands for; any other as it is."""
    while "$ref" in fragment:
        fragment = schema["$defs"][fragment["$ref"].rpartition("/")[2]]
    return fragment


def members_of(fragment: dict[str, Any], schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The fragment itself, or the members of a union at any depth."""
    fragment = resolved(fragment, schema)
    inner = [*fragment.get("anyOf", ()), *fragment.get("oneOf", ()), *fragment.get("allOf", ())]
    if not inner:
        yield fragment
    for member in inner:
        yield from members_of(member, schema)


def tags_of(fragment: dict[str, Any], schema: dict[str, Any], key: str = "kind") -> list[str]:
    """What tells the members of a union from each other, sorted."""
    return sorted({tag for member in members_of(fragment, schema) if (tag := tag_of(member, key))})


def tag_of(member: dict[str, Any], key: str = "kind") -> str:
    """What tells a member of a union from the others, the constant of its ``kind`` or of another key; empty if it has none."""
    return str(member.get("properties", {}).get(key, {}).get("const", ""))


def keys_of(fragment: dict[str, Any], schema: dict[str, Any]) -> list[str]:
    """The keys of a fragment or of any member of a union, each once, in their order."""
    return list(dict.fromkeys(key for member in members_of(fragment, schema) for key in member.get("properties", {})))


def unit_at(model: type[BaseModel], value: Any, path: Path) -> str:
    """The SI unit of the quantity at a key path of ``value``, empty where there is none."""
    fragment = schema_at(schema_of(model), value, path)
    return next((str(member["unit"]) for member in members_of(fragment, schema_of(model)) if "unit" in member), "")


def schema_at(schema: dict[str, Any], root: Any, path: Path) -> dict[str, Any]:
    """The part of the schema for a key path, in every union of the member whose ``kind`` or ``control`` the file names."""
    fragment = _narrowed(schema, schema, root)
    for position, key in enumerate(path):
        fragment = _entry(fragment, key)
        fragment = _narrowed(fragment, schema, value_at(root, path[: position + 1]))
    return fragment


def _entry(fragment: dict[str, Any], key: str | int) -> dict[str, Any]:
    for part in fragment.get("anyOf", [fragment]):
        if isinstance(key, int):
            prefix = part.get("prefixItems", [])
            entry = prefix[key] if key < len(prefix) else part.get("items")
        else:
            entry = part.get("properties", {}).get(key) or part.get("additionalProperties")
        if isinstance(entry, dict):
            return entry
    return {}


def _narrowed(fragment: dict[str, Any], schema: dict[str, Any], value: Any) -> dict[str, Any]:
    members = list(members_of(fragment, schema))
    if isinstance(value, dict) and len(members) > 1:
        kind = value.get("kind")
        agreeing = [m for m in members if _agrees(m, value)]
        fitting = [m for m in agreeing if (tag_of(m) == kind if kind else set(m.get("required", ["kind"])) <= value.keys())]
        members = fitting if len(fitting) == 1 else members
    return members[0] if len(members) == 1 else {**resolved(fragment, schema), "anyOf": members}


def _agrees(member: dict[str, Any], value: dict[str, Any]) -> bool:
    """Whether a mapping has what a member of a union has as constants, such as ``control``, where it has these keys."""
    constants = {key: entry["const"] for key, entry in member.get("properties", {}).items() if "const" in entry}
    return all(value[key] == constant for key, constant in constants.items() if key in value)
