"""What the docstrings below the fields of a model say of them; read when it is asked for, as it takes the time of a short run."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from itertools import pairwise
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from tactsim.units import format_quantity

_ALONE: ContextVar[bool] = ContextVar("alone", default=False)


@contextmanager
def docstrings_alone() -> Iterator[None]:
    """A block in which the docstring of a model is its own text: a JSON Schema describes the fields in a place of their own."""
    before = _ALONE.set(True)
    try:
        yield
    finally:
        _ALONE.reset(before)


def with_fields(text: str, model: type[BaseModel], fields: dict[str, FieldInfo]) -> str:
    """The docstring of a model and a section of its fields, but within `docstrings_alone`."""
    return text if _ALONE.get() or not fields else f"{inspect.cleandoc(text)}\n\n{_parameters_section(model, fields)}"


def summary(cls: type) -> str:
    """The first line of a class's own docstring, for which its fields are not read; empty without one."""
    return (vars(cls)["__doc__"] or "").partition("\n")[0].strip()


def _parameters_section(model: type[BaseModel], fields: dict[str, FieldInfo]) -> str:
    """A section of a docstring: every field by its key, its unit in Python, its default, and what its docstring says."""
    described = field_descriptions(model)
    texts = {field.alias or name: described.get(name, field.description or "") for name, field in model.model_fields.items()}
    lines = ["Parameters", "----------"]
    for key, field in fields.items():
        lines.append(" : ".join(filter(None, [key, _unit_and_default(field)])))
        lines += [f"    {line}" for line in texts[key].splitlines()]
    return "\n".join(lines)


def _unit_and_default(field: FieldInfo) -> str:
    """Such as ``m, 1.5 mm by default``; empty without a unit."""
    units = dict.fromkeys(_units(field.annotation, field.json_schema_extra))
    if len(units) != 1:
        return ""
    (unit,) = units
    return f"{unit}, {format_quantity(field.default, unit)} by default" if isinstance(field.default, float) else unit


def _units(annotation: Any, extra: Any = None) -> Iterator[str]:
    """The units in a type and what stands beside it, as `tactsim.units.quantity_type` leaves them."""
    if isinstance(extra, dict) and "unit" in extra:
        yield extra["unit"]
    for part in get_args(annotation):
        yield from _units(part, part.json_schema_extra if isinstance(part, FieldInfo) else None)


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
