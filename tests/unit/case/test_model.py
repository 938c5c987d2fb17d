"""Identity and resolved form of a case."""

from __future__ import annotations

import inspect
import json
import pydoc
import re
from pathlib import Path

import pytest
from pretence import CASE_TEXT, Pretence, Soft, Specimen

from tactsim import field_docstrings, schema_of_model
from tactsim.case import SCHEMA, Case, load_case
from tactsim.errors import CaseError
from tactsim.field_docstrings import docstrings_alone
from tactsim.validation.table import Row


def identity(path: Path, text: str) -> str:
    path.write_text(text, encoding="utf-8")
    return load_case(path).case_id


def test_the_spelling_does_not_change_the_identity(case_file: Path) -> None:
    other = """
experiment:
  specimen: {layers: [{material: {modulus: 0.003 MPa, kind: soft}, thickness: 1 cm},
                      {material: {kind: stiff, exponent: 2, c10: 10000 Pa}, thickness: 2000 um}], radius: 0.02m}
  friction: 0.4   # the default
  kind: pretence
title: A pretended case
schema: tactsim/case/1
"""
    assert identity(case_file, other) == identity(case_file, CASE_TEXT)


@pytest.mark.parametrize(
    "change", [("20 mm", "20.0001 mm"), ("3 kPa", "3.1 kPa"), ("kind: pretence", "kind: pretence\n  steps: 4")]
)
def test_a_change_of_value_changes_the_identity(case_file: Path, change: tuple[str, str]) -> None:
    assert identity(case_file, CASE_TEXT.replace(*change)) != identity(case_file, CASE_TEXT)


def test_the_identity_is_sixteen_hexadecimal_digits(case_file: Path) -> None:
    assert re.fullmatch("[0-9a-f]{16}", load_case(case_file).case_id)


def test_the_resolved_case_is_plain_json_in_si(case_file: Path) -> None:
    resolved = load_case(case_file).resolved()
    assert json.loads(json.dumps(resolved, allow_nan=False)) == resolved
    assert resolved["schema"] == SCHEMA
    assert resolved["experiment"]["specimen"]["radius"] == 0.02
    assert resolved["experiment"]["specimen"]["layers"][1]["material"] == {"kind": "stiff", "c10": 1e4, "exponent": 2}


def test_a_case_made_in_python_keeps_the_fields_of_its_experiment(pretended: None) -> None:
    case = Case(schema=SCHEMA, experiment=Pretence.example())
    assert case.resolved()["experiment"]["specimen"]["layers"][0]["material"]["modulus"] == 3e3


@pytest.mark.parametrize(
    "experiment",
    [
        3,
        {},
        {"kind": "graps"},
        {"kind": "closed_form", "outer_radius": "4 kPa"},
        {"kind": "film_test", "thickness": "1 mm"},
    ],
)
def test_a_mapping_for_the_experiment_is_refused_as_in_a_file(experiment: object) -> None:
    with pytest.raises(CaseError) as of_file:
        load_case({"schema": SCHEMA, "experiment": experiment})
    with pytest.raises(CaseError) as of_python:
        Case(schema=SCHEMA, experiment=experiment)
    sentences = [[line.partition(": ")[2] for line in str(error.value).splitlines()] for error in (of_file, of_python)]
    if isinstance(experiment, dict):
        assert sentences[0] == sentences[1]
    assert "TypeError" not in sentences[1][0]


def test_a_mapping_for_the_experiment_is_taken(pretended: None) -> None:
    experiment = Pretence.example()
    assert Case(schema=SCHEMA, experiment=experiment.model_dump()) == Case(schema=SCHEMA, experiment=experiment)


def test_the_signature_names_the_keys_of_a_file(pretended: None) -> None:
    assert "schema" in inspect.signature(Case).parameters
    assert Case(SCHEMA, "A title", Pretence.example()).title == "A title"


def test_a_key_that_is_a_word_of_the_language_has_a_signature():
    assert "from_" in inspect.signature(Row).parameters


def test_help_tells_fields_with_units_and_defaults() -> None:
    """It showed ``radius: float = 0.02``, and no word of what that is."""
    section = (
        "Parameters\n----------\nradius : m, 20 mm by default\n    Outer radius.\nlayers\n    From the bottom up.\nhole : m\n"
    )
    assert section in inspect.getdoc(Specimen)
    assert " |  radius : m, 20 mm by default\n |      Outer radius.\n" in pydoc.plain(pydoc.render_doc(Specimen))
    assert inspect.getdoc(Soft).startswith(
        "A material with one modulus.\n\nParameters\n----------\nmodulus : Pa\n    Shear modulus."
    )
    with docstrings_alone():
        assert Specimen.__doc__ == "A stack of layers."


def test_a_refusal_reads_no_docstrings_of_fields(case_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They take a third as long as all else of a refused grasp."""
    monkeypatch.setattr(
        field_docstrings, "_parameters_section", lambda model, fields: pytest.fail(f"read those of {model.__name__}")
    )
    schema_of_model._schema_with.cache_clear()
    case_file.write_text(CASE_TEXT.replace("radius", "radios"), encoding="utf-8")
    with pytest.raises(CaseError, match="did you mean 'radius'"):
        load_case(case_file)
