"""Random and damaged inputs: refused in words, never with another exception."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from pretence import CASE_TEXT, pretended_result

from tactsim.case import Case, load_case
from tactsim.errors import CaseError, InvalidQuantity, StorageError, TactsimError
from tactsim.results import Status, StepRecord
from tactsim.results.document import ResultDocument, document_text, parse_document
from tactsim.units import parse_quantity

FUZZ = settings(derandomize=True, deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
TOKENS = [
    "- ",
    ": ",
    "? ",
    "[",
    "]",
    "{",
    "}",
    "&a ",
    "*a",
    "!!x ",
    "|",
    ">",
    "'",
    '"',
    "#",
    "\n",
    "  ",
    "\t",
    "---\n",
    "...\n",
    "%YAML 1.1\n",
]
WORDS = [
    "schema",
    "tactsim/case/1",
    "experiment",
    "kind",
    "pretence",
    "specimen",
    "layers",
    "3 mm",
    "1",
    ".nan",
    "<<",
    "\\",
    "é",
    "\u2028",
]
RESULT_TEXT = document_text(pretended_result(Status.CONVERGED, "x", (StepRecord(1, 1, 0.0, {"displacement": 1.0}),)), "id")


def loaded(path: Path, content: bytes) -> None:
    """Loads the content as a case file: a case or an error of ours."""
    path.write_bytes(content)
    with suppress(TactsimError):
        assert isinstance(load_case(path), Case)


@FUZZ
@given(st.binary(max_size=300))
@example(b"\xef\xbb\xbf")
@example(b"\x00")
def test_any_bytes(case_file: Path, content: bytes) -> None:
    loaded(case_file, content)


@FUZZ
@given(st.lists(st.sampled_from(TOKENS + WORDS), max_size=40).map("".join))
@example("? ? ? ?")
@example("&a *a")
@example("- &a [*a]\n- *a")
@example("%TAG ! tag:x,2000:\n---\n!x a")
def test_yaml_like_text(case_file: Path, text: str) -> None:
    loaded(case_file, text.encode())


@FUZZ
@given(st.integers(0, len(CASE_TEXT)), st.integers(0, 12), st.text(max_size=6) | st.sampled_from(TOKENS + WORDS))
def test_a_damaged_case(case_file: Path, start: int, length: int, inserted: str) -> None:
    text = CASE_TEXT[:start] + inserted + CASE_TEXT[start + length :]
    loaded(case_file, text.encode("utf-8", "surrogatepass"))


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["kind", "modulus", "x", ""]), inner, max_size=3),
    max_leaves=6,
)
PLACES = ["title", "experiment", "experiment.specimen", "experiment.specimen.layers", "experiment.specimen.layers.0.material"]


@FUZZ
@given(
    st.sampled_from([*PLACES, "experiment.kind", "experiment.friction", "output", "schema", "experiment.element_size"]), VALUES
)
def test_any_value_in_any_place(case_file: Path, place: str, value: object) -> None:
    import json

    with suppress(CaseError):
        assert isinstance(load_case(case_file, [f"{place}={json.dumps(value)}"]), Case)


@FUZZ
@given(st.text(max_size=30))
def test_any_override(case_file: Path, override: str) -> None:
    with suppress(CaseError):
        load_case(case_file, [override])


@FUZZ
@given(st.text(max_size=20) | st.tuples(st.floats().map(str), st.text("mkPas*/^-+ 0123456789()_%µ°", max_size=12)).map("".join))
def test_any_quantity(text: str) -> None:
    with suppress(InvalidQuantity):
        assert isinstance(parse_quantity(text, "m"), float)


@FUZZ
@given(st.integers(0, len(RESULT_TEXT)), st.integers(0, 9), st.text(max_size=4))
def test_a_damaged_result(start: int, length: int, inserted: str) -> None:
    with suppress(StorageError):
        assert isinstance(parse_document(RESULT_TEXT[:start] + inserted + RESULT_TEXT[start + length :], "r"), ResultDocument)


def test_a_result_cut_anywhere_is_refused() -> None:
    for length in range(0, len(RESULT_TEXT) - 2, 10):
        with pytest.raises(StorageError):
            parse_document(RESULT_TEXT[:length], "r")
