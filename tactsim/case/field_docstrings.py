"""The docstrings of fields as descriptions in a JSON Schema."""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

EXAMPLE = re.compile(r"\n\n>>> .*?(?=\n\n|\Z)", re.S)
"""Of the use from Python, which a file cannot follow."""


class SchemaWithDescriptions(GenerateJsonSchema):
    """Describes every field by the docstring below it; read here only, for it costs as much time as a run has to answer in."""

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


def field_descriptions(model: type[BaseModel]) -> dict[str, str]:
    """Field -> docstring of a model and of those that it is derived from."""
    described: dict[str, str] = {}
    for base in reversed(model.__mro__):
        if issubclass(base, BaseModel) and base is not BaseModel:
            described |= _field_docstrings(base.__module__).get(base.__qualname__, {})
    return described


@cache
def _field_docstrings(module: str) -> dict[str, dict[str, str]]:
    """Class -> field -> docstring of every class that the source of a module defines; none where there is no source."""
    try:
        tree = ast.parse(inspect.getsource(sys.modules[module]))
    except (OSError, TypeError, KeyError):  # defined in a shell
        return {}
    classes: dict[str, dict[str, str]] = {}

    def visit(node: ast.AST, prefix: str) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.ClassDef):
                classes[f"{prefix}{child.name}"] = dict(_described_fields(child))
                visit(child, f"{prefix}{child.name}.")
            elif isinstance(child, ast.FunctionDef):
                visit(child, f"{prefix}{child.name}.<locals>.")

    visit(tree, "")
    return classes


def _described_fields(cls: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for field, below in pairwise(cls.body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(below, ast.Expr):
            text = below.value.value if isinstance(below.value, ast.Constant) else None
            if isinstance(text, str):
                yield field.target.id, inspect.cleandoc(text)
