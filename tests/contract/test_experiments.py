"""Every registered experiment, from its example: case file, JSON Schema, history; those without a long solution are run."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args, get_origin

import jsonschema
import numpy as np
import pytest
from pydantic import BaseModel
from ruamel.yaml import YAML

from tactsim.case.json_schema import case_json_schema
from tactsim.case.loading import load_case
from tactsim.errors import StorageError
from tactsim.interfaces import Experiment
from tactsim.plotting import figures_for
from tactsim.registry import kinds
from tactsim.results.result import Status, StepRecord
from tactsim.units import is_unit

KINDS = kinds(Experiment)
LONG = {
    "annulus_design",
    "closed_form",
    "detectability",
    "durometer",
    "elastomer_ranking",
    "indentation",
    "indentation_3d",
    "timed_indentation",
}
"""More than a few seconds; their own tests run them."""
every_kind = pytest.mark.parametrize("kind", sorted(KINDS))


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    return case_json_schema()


def unit_in(annotation: Any, extra: Any = None) -> str:
    """Unit of a number of this type, empty if it has none."""
    told = [extra, *(getattr(one, "json_schema_extra", None) for one in getattr(annotation, "__metadata__", ()))]
    units = [one["unit"] for one in told if isinstance(one, dict) and "unit" in one]
    return next((unit for unit in (*units, *(unit_in(inner) for inner in get_args(annotation))) if unit), "")


def sequence_in(annotation: Any) -> tuple[Any, ...]:
    """Types of the items of a tuple, or of the values of a mapping, among what an annotation allows."""
    if get_origin(annotation) in (tuple, dict):
        return get_args(annotation)
    return next((found for inner in get_args(annotation) if (found := sequence_in(inner))), ())


def written(value: Any, annotation: Any = None, extra: Any = None) -> Any:
    """A value in SI as a case file writes it: numbers with the unit of their field."""
    if isinstance(value, BaseModel):
        fields = type(value).model_fields.items()
        return {
            field.alias or name: written(getattr(value, name), field.annotation, field.json_schema_extra)
            for name, field in fields
        }
    if isinstance(value, tuple):
        items = sequence_in(annotation) or (None, ...)
        own = (items[0],) * len(value) if items[-1] is ... else items
        return [written(item, one) for item, one in zip(value, own, strict=True)]
    if isinstance(value, dict):
        return {key: written(item, (sequence_in(annotation) or (None,))[-1]) for key, item in value.items()}
    unit = unit_in(annotation, extra)
    return f"{value!r} {unit}" if isinstance(value, float) and unit else value


@every_kind
def test_a_case_file_gives_it_back_and_passes_the_schema(kind: str, tmp_path: Path, schema: dict[str, Any]) -> None:
    experiment = KINDS[kind].example()
    told = experiment.model_dump(mode="json")
    case = {"schema": "tactsim/case/1", "title": "example", "experiment": written(experiment)}
    jsonschema.Draft7Validator(schema).validate(case)
    path = tmp_path / "case.yaml"
    with path.open("w", encoding="utf-8") as file:
        YAML().dump(case, file)
    assert load_case(path).experiment.model_dump(mode="json") == told
    assert list(jsonschema.Draft7Validator(schema).iter_errors(case | {"experiment": case["experiment"] | {"unheard_of": 1}}))


@every_kind
def test_every_field_of_the_schema_is_described(kind: str, schema: dict[str, Any]) -> None:
    definition = schema["$defs"][KINDS[kind].__name__]
    assert definition["description"]
    for name, field in definition["properties"].items():
        assert name == "kind" or field.get("description"), name


@every_kind
def test_history_has_units(kind: str) -> None:
    units = getattr(KINDS[kind].example(), "history_units", {})
    assert all(unit == "1" or is_unit(unit) for unit in units.values()), units


@pytest.mark.parametrize("kind", sorted(set(KINDS) - LONG))
def test_the_example_runs_and_is_drawn(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    steps: list[StepRecord] = []
    experiment = KINDS[kind].example()
    if "results/" in experiment.model_dump_json():
        with pytest.raises(StorageError, match="results/"):  # it needs a result that was stored before
            experiment.run(steps.append)
        return
    result = experiment.run(steps.append)
    assert result.kind == kind
    assert result.status is Status.CONVERGED
    assert result.reason
    assert tuple(steps) == result.steps
    known = getattr(KINDS[kind].example(), "history_units", {})
    assert result.units.items() <= known.items() or not result.steps
    for step in result.steps:
        assert set(step.values) <= set(result.units)
    for name, quantity in result.quantities.items():
        assert quantity.description, name
        assert quantity.unit == "1" or is_unit(quantity.unit), name
    drawings = figures_for(result)
    assert all(np.frombuffer(draw()[:8], np.uint8).tobytes() == b"\x89PNG\r\n\x1a\n" for draw in drawings.values())
