"""``result.json``: its format, defined once for writing and reading."""

from __future__ import annotations

import json
import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict, ValidationError

from tactsim.errors import InvalidQuantity, StorageError, shown
from tactsim.outside.json_text import read_json
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, Status, StepRecord
from tactsim.results.scene import EARLIER, UnreadableScene, read_scene, written_scene
from tactsim.units import is_unit

SCHEMA_VERSION: Literal[2] = 2
EARLIER_VERSION: Literal[1] = 1
"""Its numbers are read; its ``details`` are not."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True)


def _rectangular(value: Any) -> Any:
    """Refuses what is not a number, or a nested list whose parts at each depth have the same length."""
    _shape(value)
    return value


def _shape(value: Any) -> tuple[int, ...]:
    if type(value) in SCALARS:
        return ()
    if not isinstance(value, list):
        raise ValueError(f"{type(value).__name__} found; allowed: a number, a nested list of numbers, or null")
    inner = {()} if SCALARS.issuperset(map(type, value)) else set(map(_shape, value))
    if len(inner) > 1:
        raise ValueError("lists of different lengths inside each other; allowed: a rectangular array")
    return (len(value), *inner.pop())


def _known_unit(unit: str) -> str:
    if not is_unit(unit):
        raise ValueError(f"unknown unit {shown(unit)}; allowed: an SI unit, or 1")
    return unit


SCALARS = frozenset({int, float, bool, type(None)})
"""Types of what a quantity holds; null stands for a number that is not finite."""
LONGEST_NAME = 200
"""Characters of a name, such as that of a quantity; those of this program have some forty."""
Number = Annotated[float, Strict()]
Count = Annotated[int, Strict()]
Name = Annotated[str, Field(max_length=LONGEST_NAME)]
Unit = Annotated[str, AfterValidator(_known_unit)]


class QuantityPart(_Part):
    """A quantity in SI."""

    value: Annotated[Any, AfterValidator(_rectangular)]
    """Number, nested list of numbers, or null where it is not finite."""
    unit: Unit
    description: str


class StepPart(_Part):
    """One accepted step."""

    step: Count
    newton_iterations: Count
    residual: Number | None
    values: dict[Name, Number | None]
    """History values in SI; their units stand in ``units``."""


class ResultDocument(_Part):
    """The whole file."""

    schema_version: Literal[1, 2] = SCHEMA_VERSION
    case_id: str
    kind: str
    title: str = ""
    status: Status
    reason: str
    quantities: dict[Name, QuantityPart]
    assumptions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    timing: dict[Name, Number | None] = Field(default_factory=dict)
    units: dict[Name, Unit] = Field(default_factory=dict)
    steps: tuple[StepPart, ...] = ()
    scene: dict[str, Any] | None = None
    """What later stages read; the model of the kind reads it."""


def document_text(result: Result, case_id: str) -> str:
    """The text of ``result.json``: strict JSON, a number that is not finite as null with a warning that names it.

    Raises
    ------
    StorageError
        If the scene of the result was read from a folder and cannot be read.
    InvalidQuantity
        If a quantity or the history could not be read again, such as a value that is no array of numbers.
    """
    if isinstance(result.scene, UnreadableScene):
        raise StorageError(f"a result whose scene cannot be read is not written: {result.scene.reason}")
    content = {
        "quantities": {
            name: {"value": quantity.value, "unit": quantity.unit, "description": quantity.description}
            for name, quantity in result.quantities.items()
        },
        "timing": result.timing,
        "units": result.units,
        "steps": [
            {"step": s.step, "newton_iterations": s.newton_iterations, "residual": s.residual, "values": s.values}
            for s in result.steps
        ],
        "scene": None if result.scene is None else written_scene(result.scene, result.kind),
    }
    lost: list[str] = []
    plain = {name: plain_json(value, (name,), lost) for name, value in content.items()}
    warnings = [*result.warnings, *(f"{place} is not finite and stored as null" for place in lost)]
    head = {"schema_version": SCHEMA_VERSION, "case_id": case_id, "kind": result.kind, "title": result.title}
    ending = {"status": str(result.status), "reason": result.reason}
    whole = {**head, **ending, "assumptions": list(result.assumptions), "warnings": warnings, **plain}
    order = ResultDocument.model_fields
    try:
        ResultDocument.model_validate(whole)
    except ValidationError as error:
        raise InvalidQuantity(f"the result is not written, for it could not be read again: {first_fault(error)}") from None
    return json.dumps({name: whole[name] for name in order}, indent=1, allow_nan=False) + "\n"


def plain_json(value: Any, place: tuple[str, ...], lost: list[str]) -> Any:
    """``value`` as plain JSON values; the places of numbers that are not finite are added to ``lost``.

    Raises
    ------
    TypeError
        If JSON cannot hold a value, naming its place.
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): plain_json(item, (*place, str(key)), lost) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain_json(item, (*place, str(index)), lost) for index, item in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        lost.append(".".join(place))
        return None
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"{'.'.join(place)} holds a {type(value).__name__}, which JSON cannot hold")


def parse_document(text: str, name: str) -> ResultDocument:
    """The content of ``result.json``.

    Raises
    ------
    StorageError
        If the text is not a result that this version of tactsim can read; the message begins with ``name``.
    """
    content = read_json(text, name)
    version = content.get("schema_version") if isinstance(content, dict) else None
    if type(version) is not int:  # nor true, which Python takes for 1
        raise StorageError(f"{one_line(name)} is not a result of tactsim: it has no schema_version")
    if version not in (EARLIER_VERSION, SCHEMA_VERSION):
        raise StorageError(f"{one_line(name)} has schema_version {version}; this tactsim reads {SCHEMA_VERSION}, update tactsim")
    try:
        return ResultDocument.model_validate(content)
    except ValidationError as error:
        raise StorageError(f"{one_line(name)} is damaged: {first_fault(error)}") from None


def result_of(document: ResultDocument) -> Result:
    """The result in the document, without its fields."""
    earlier = document.schema_version == EARLIER_VERSION
    return Result(
        kind=document.kind,
        status=document.status,
        reason=document.reason,
        quantities={name: Quantity(q.value, q.unit, q.description) for name, q in document.quantities.items()},
        assumptions=document.assumptions,
        warnings=document.warnings,
        timing={name: _number(value) for name, value in document.timing.items()},
        steps=tuple(
            StepRecord(s.step, s.newton_iterations, _number(s.residual), {k: _number(v) for k, v in s.values.items()})
            for s in document.steps
        ),
        units=document.units,
        title=document.title,
        scene=UnreadableScene(EARLIER) if earlier else read_scene(document.kind, document.scene),
    )


def _number(value: float | None) -> float:
    return math.nan if value is None else value
