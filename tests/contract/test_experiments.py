"""Every registered experiment, from its example: case file, JSON Schema, history; those without a long solution are run."""

from __future__ import annotations

import json
import pickle
import re
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from ruamel.yaml import YAML
from scenes import cut_words, unmarked_figures

from tactsim.case.json_schema import case_json_schema
from tactsim.case.loading import load_case
from tactsim.case.writing import save_case
from tactsim.errors import CaseError
from tactsim.interfaces import Experiment
from tactsim.plotting.canvas import encoded
from tactsim.registry import kinds
from tactsim.results.result import Status, StepRecord
from tactsim.results.scene import Scene, read_scene, written_scene
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


ASKED = re.compile(r"experiment\.([\w.]+): .* has no unit; expected text such as (?:'[^']+' or )?'[^ ]+ ([^']+)'")
"""What a message says about a number without a unit: the last of its examples is in SI."""


def with_units(case: dict[str, Any], path: Path) -> None:
    """Write a case of numbers in SI to a file, each with the unit that the reader asks for."""
    for _ in range(100):
        with path.open("w", encoding="utf-8") as file:
            YAML().dump(case, file)
        try:
            load_case(path)
        except CaseError as error:
            asked = ASKED.findall(str(error))  # some twenty at a time
            if not asked:
                raise
            for place, unit in asked:
                *outer, last = [int(key) if key.isdigit() else key for key in place.split(".")]
                part = reduce(getitem, outer, case["experiment"])
                part[last] = f"{part[last]!r} {unit}"
            continue
        return


def rounded(value: Any) -> Any:
    """Numbers to 13 digits: the reader of units keeps 15."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return float(f"{value:.13g}") if isinstance(value, float) else value


@every_kind
def test_a_case_file_gives_it_back_and_passes_the_schema(kind: str, tmp_path: Path, schema: dict[str, Any]) -> None:
    experiment = KINDS[kind].example()
    dumped = experiment.model_dump(mode="json")
    fields = KINDS[kind].model_fields
    defaults = {
        name for name, field in fields.items() if getattr(experiment, name) == field.get_default(call_default_factory=True)
    }
    written = json.loads(experiment.model_dump_json(by_alias=True, exclude=defaults - {"kind"}))
    case = {"schema": "tactsim/case/1", "title": "example", "experiment": written}
    path = tmp_path / "case.yaml"
    with_units(case, path)
    jsonschema.Draft7Validator(schema).validate(case)
    assert rounded(load_case(path).experiment.model_dump(mode="json")) == rounded(dumped)
    assert list(jsonschema.Draft7Validator(schema).iter_errors(case | {"experiment": case["experiment"] | {"unheard_of": 1}}))


@every_kind
def test_a_case_goes_to_another_process(kind: str, tmp_path: Path) -> None:
    case = load_case(save_case(KINDS[kind].example(), tmp_path / "case.yaml"))
    again = pickle.loads(pickle.dumps(case))
    assert (again, again.case_id) == (case, case.case_id)


@every_kind
def test_every_field_of_the_schema_is_described(kind: str, schema: dict[str, Any]) -> None:
    definition = schema["$defs"][KINDS[kind].__name__]
    assert definition["description"]
    for name, field in definition["properties"].items():
        assert name == "kind" or field.get("description"), name


def test_a_scene_is_that_of_an_experiment() -> None:
    assert set(kinds(Scene)) <= set(KINDS)


@every_kind
def test_history_has_units(kind: str) -> None:
    units = getattr(KINDS[kind].example(), "history_units", {})
    assert all(unit == "1" or is_unit(unit) for unit in units.values()), units


@pytest.mark.parametrize("kind", sorted(set(KINDS) - LONG))
def test_the_example_runs_and_is_drawn(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    steps: list[StepRecord] = []
    experiment = KINDS[kind].example()
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
    if result.scene is not None:
        assert read_scene(kind, json.loads(json.dumps(written_scene(result.scene, kind)))) == result.scene
    assert unmarked_figures(result) == []
    figures = result.plot()
    assert cut_words(figures) == []
    for figure in list(figures.values())[:1]:  # every figure was drawn to find the places of its words
        assert encoded(figure).startswith(b"\x89PNG\r\n\x1a\n")
