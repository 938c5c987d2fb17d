"""The JSON Schema of sweep files: it takes what the loader takes, and refuses what the loader refuses by its form."""

from __future__ import annotations

from pathlib import Path

import jsonschema
import pytest
from sweeps import TEXT

from tactsim.case.yaml_reading import read_yaml
from tactsim.dataset.sampling.json_schema import sweep_json_schema
from tactsim.shipped import CASES

NAMING = {f"sweep_{name}" for name in ("lumps", "arteries", "annulus", "rates", "closed_form")}


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft7Validator:
    schema = sweep_json_schema()
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def faults(validator: jsonschema.Draft7Validator, text: str) -> list[str]:
    return [error.message for error in validator.iter_errors(read_yaml(text).value)]


@pytest.mark.parametrize("path", sorted(CASES.glob("sweep_*.yaml")), ids=lambda path: path.stem)
def test_shipped_sweeps_pass_and_name_the_schema(validator: jsonschema.Draft7Validator, path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert faults(validator, text) == []
    if path.stem in NAMING:
        assert text.startswith("# yaml-language-server: $schema=sweep.schema.json\n")
    assert faults(validator, text.replace("tactsim/sweep/1", "tactsim/case/1"))
    assert faults(validator, text.replace("samples:", "sample:", 1))
    assert faults(validator, text.replace("uniform: [", "unifrom: [", 1))


@pytest.mark.parametrize(
    "varying",
    [
        "{uniform: [1 mm, 2 mm]}",
        "{normal: [1 mm, 0.2 mm], within: [0.5 mm, 1.5 mm]}",
        "{values: [1 mm, 2 mm], weights: [1, 2]}",
        "{range: [1 mm, 2 mm, 5]}",
        "{choice: [1 mm, {uniform: [1 mm, 2 mm]}]}",
        "1.5 mm",
    ],
)
def test_a_distribution_may_stand_for_a_quantity(validator: jsonschema.Draft7Validator, varying: str) -> None:
    assert faults(validator, TEXT.replace("{uniform: [1 mm, 2.5 mm]}", varying)) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("{uniform: [1 mm, 2.5 mm]}", "{uniform: [1 mm]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{uniform: [1, 2.5]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{uniform: [1 mm, 2.5 mm], wide: 3}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{range: [1 mm, 2 mm]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{integer: [1, 2]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{choice: [1 mm, 2]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "1.5"),
        ("inner_radius:", "iner_radius:"),
        ("kind: neo_hookean", "kind: neo_hokean"),
        ("kind: closed_form", "kind: {choice: [closed_form, grasp]}"),
        ("points: 5", "points: {uniform: [1 mm, 2 mm]}"),
        ("title: A small sweep", "title: {choice: [a, b]}"),
        ("sweep:", "output: {fields: {choice: [all, none]}}\nsweep:"),
        ("train: 0.5", "train: {uniform: [0.1, 0.5]}"),
        ("seed: 7", "seed: -7"),
        ("sweep:", "swept:"),
    ],
)
def test_what_is_written_wrongly_is_noticed(validator: jsonschema.Draft7Validator, old: str, new: str) -> None:
    assert old in TEXT
    assert faults(validator, TEXT) == []
    assert faults(validator, TEXT.replace(old, new, 1))


def test_editors_learn_units_descriptions_and_defaults(validator: jsonschema.Draft7Validator) -> None:
    radius = validator.schema["$defs"]["Annulus"]["properties"]["inner_radius"]
    assert radius["unit"] == "m"
    assert radius["description"] == "Radius of the hole."
    assert radius["default"] == "1.5 mm"
    assert validator.schema["properties"]["sweep"]["properties"]["design"]["description"] == "How the varied places are covered."
