"""The format of ``result.json``."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from pretence import PretendedScene, pretended_result

from tactsim.errors import InputError, StorageError
from tactsim.registry import register
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.document import document_text, parse_document, plain_json, result_of

RECORDS = (StepRecord(1, 4, 1e-11, {"displacement": 1e-4}), StepRecord(2, 5, 1e-12, {"displacement": 2e-4}))


def test_the_outside_contract() -> None:
    content = json.loads(document_text(pretended_result(Status.FAILED, "no", RECORDS), "0123456789abcdef"))
    assert {"schema_version", "case_id", "status", "reason", "quantities", "assumptions", "warnings", "timing", "steps"} <= set(
        content
    )
    assert content["schema_version"] == 2
    assert content["status"] == "failed"
    assert content["quantities"]["displacement"] == {"value": 2e-4, "unit": "m", "description": "displacement of the annulus"}
    assert content["quantities"]["taxel_force_upper"]["value"] == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert content["steps"][1] == {"step": 2, "newton_iterations": 5, "residual": 1e-12, "values": {"displacement": 2e-4}}


def test_a_result_comes_back_as_it_was() -> None:
    register(PretendedScene)
    result = replace(pretended_result(Status.CONVERGED, "done", RECORDS), title="A title")
    again = result_of(parse_document(document_text(result, "x"), "result.json"))
    plain = {name: Quantity(np.asarray(q.value).tolist(), q.unit, q.description) for name, q in result.quantities.items()}
    assert again == replace(result, quantities=plain, frames=())


def test_a_scene_that_is_not_that_of_the_kind_is_reported_when_it_is_asked_for() -> None:
    register(PretendedScene)
    result = pretended_result(Status.CONVERGED, "done", RECORDS)
    content = json.loads(document_text(result, "x"))
    assert content["scene"] == {"profile": [1.0, 2.0]}
    for scene, words in (({"profile": "x"}, r"scene\.profile: .*array"), ({}, r"scene\.profile: Field required")):
        again = result_of(parse_document(json.dumps(content | {"scene": scene}), "result.json"))
        assert again.history_values("displacement").tolist() == [1e-4, 2e-4]
        with pytest.raises(StorageError, match=f"{words}.*; run the case again"):
            again.scene_as(PretendedScene)
        with pytest.raises(StorageError, match="is not written"):
            document_text(again, "x")
    foreign = result_of(parse_document(json.dumps(content | {"kind": "unheard_of"}), "result.json"))
    with pytest.raises(StorageError, match="unknown scene kind 'unheard_of'"):
        foreign.scene_as(PretendedScene)
    with pytest.raises(InputError, match="'pretence' holds no PretendedScene"):
        replace(result, scene=None).scene_as(PretendedScene)


def test_of_a_result_of_an_earlier_version_the_numbers_are_read() -> None:
    content = json.loads(document_text(pretended_result(Status.CONVERGED, "done", RECORDS), "x"))
    del content["scene"], content["title"]
    earlier = content | {"schema_version": 1, "details": {"title": "A title", "profile": [1.0, 2.0]}}
    result = result_of(parse_document(json.dumps(earlier), "result.json"))
    assert result.quantities["displacement"].value == 2e-4
    with pytest.raises(StorageError, match=r"earlier version of tactsim \(schema_version 1\).*run the case again"):
        result.scene_as(PretendedScene)


def test_numbers_that_are_not_finite_become_null_with_a_warning() -> None:
    result = Result(
        kind="k",
        status=Status.FAILED,
        reason="",
        quantities={"f": Quantity(np.array([1.0, np.nan]), "N", "")},
        steps=(StepRecord(1, 1, math.inf, {}),),
    )
    text = document_text(result, "x")
    content = json.loads(text, parse_constant=pytest.fail)
    assert content["quantities"]["f"]["value"] == [1.0, None]
    assert content["warnings"] == [
        "quantities.f.value.1 is not finite and stored as null",
        "steps.0.residual is not finite and stored as null",
    ]
    assert math.isnan(result_of(parse_document(text, "x")).steps[0].residual)


def test_numpy_values_are_written_as_numbers() -> None:
    values = {"a": np.float32(0.5), "b": np.int64(3), "c": np.bool_(True), "d": (1, 2), "e": "text", "f": None}
    assert plain_json(values, (), []) == {"a": 0.5, "b": 3, "c": True, "d": [1, 2], "e": "text", "f": None}
    with pytest.raises(TypeError, match="x holds a set"):
        plain_json({"x": {1}}, (), [])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is damaged"),
        ("{", "is damaged"),
        ("[" * 100_000, "is damaged"),
        ('{"schema_version": NaN}', "NaN is not a finite number of JSON"),
        ("[]", "not a result of tactsim"),
        ("{}", "not a result of tactsim"),
        ('{"schema_version": 3}', "this tactsim reads 2, update tactsim"),
        ('{"schema_version": 2}', "is damaged: case_id"),
        ('{"schema_version": 2, "case_id": "x", "kind": "k", "status": "fine"}', "is damaged: status"),
    ],
)
def test_what_is_no_result_is_reported(text: str, words: str) -> None:
    with pytest.raises(StorageError, match=r"^place/result\.json") as caught:
        parse_document(text, "place/result.json")
    assert words in str(caught.value)
