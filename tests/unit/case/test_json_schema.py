"""The JSON Schema for editors."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import jsonschema
import pytest
from pretence import CASE_TEXT

from tactsim.case import case_json_schema, load_case
from tactsim.case.yaml_reading import read_yaml
from tactsim.shipped import CASES


def shipped_cases() -> Iterator[Path]:
    """Every case in the repository; tables of the thesis lie beside them."""
    return (path for path in sorted(CASES.rglob("*.yaml")) if "schema: tactsim/case/" in path.read_text(encoding="utf-8"))


@pytest.fixture
def validator(pretended: None) -> jsonschema.Draft7Validator:
    schema = case_json_schema()
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def test_a_valid_case_passes(validator: jsonschema.Draft7Validator) -> None:
    validator.validate(read_yaml(CASE_TEXT).value)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("20 mm", "20"),
        ("kind: pretence", "kind: other"),
        ("kind: soft, ", ""),
        ("radius", "raduis"),
        ("tactsim/case/1", "tactsim/case/2"),
        ("c10: 10 kPa", "c10: 10 kPa\n          exponent: 7"),
    ],
)
def test_a_wrong_case_fails(validator: jsonschema.Draft7Validator, old: str, new: str) -> None:
    assert list(validator.iter_errors(read_yaml(CASE_TEXT.replace(old, new)).value))


def test_editors_learn_units_and_descriptions(validator: jsonschema.Draft7Validator) -> None:
    specimen = validator.schema["$defs"]["Specimen"]["properties"]
    assert specimen["radius"]["unit"] == "m"
    assert specimen["radius"]["description"] == "Outer radius."
    assert specimen["radius"]["default"] == "20 mm"
    assert "examples" in specimen["radius"]


@pytest.fixture(scope="module")
def shipped_validator() -> jsonschema.Draft7Validator:
    return jsonschema.Draft7Validator(case_json_schema())


@pytest.mark.parametrize("path", list(shipped_cases()), ids=lambda path: path.name)
def test_shipped_cases_load_and_pass(path: Path, shipped_validator: jsonschema.Draft7Validator) -> None:
    load_case(path)
    shipped_validator.validate(read_yaml(path.read_text(encoding="utf-8")).value)
