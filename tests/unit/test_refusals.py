"""What a model refused, in words."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError, field_validator

import tactsim
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.refusals import first_fault

IN_WORDS = {"first_fault", "refusals_of", "problems_of"}
"""Functions that turn what pydantic raises into sentences."""


class Even(BaseModel):
    number: int
    inner: Any = None

    @field_validator("number")
    @classmethod
    def _even(cls, number: int) -> int:
        assert number < 10, "too large"
        if number % 2:
            raise ValueError("odd")
        return number

    @field_validator("inner")
    @classmethod
    def _material(cls, inner: Any) -> NeoHookean:
        return NeoHookean(**inner)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"number": 1}, "number: odd"),
        ({"number": 12}, "number: too large"),
        ({"number": "a"}, "number: Input should be a valid integer, unable to parse string as an integer"),
        ({"number": 2, "inner": {"c10": "3 kg"}}, "inner.c10: '3 kg' has the wrong dimension; expected a pressure"),
    ],
)
def test_a_fault_is_said_without_the_name_of_pydantics_error(fields: dict[str, Any], words: str) -> None:
    """A fit that is no material said ``Value error,``."""
    with pytest.raises(ValidationError) as caught:
        Even.model_validate(fields)
    assert first_fault(caught.value).startswith(words)


def test_no_message_shows_what_pydantic_wrote() -> None:
    """Whoever catches pydantic's error asks for it in words."""
    room, caught = Path(tactsim.__file__).parent, 0
    for place in room.rglob("*.py"):
        if "ValidationError" not in (text := place.read_text()):
            continue
        for handler in ast.walk(ast.parse(text)):
            if isinstance(handler, ast.ExceptHandler) and handler.type and "ValidationError" in ast.unparse(handler.type):
                caught += 1
                inside = [node for part in handler.body for node in ast.walk(part)]
                called = {ast.unparse(node.func) for node in inside if isinstance(node, ast.Call)}
                assert called & IN_WORDS, f"{place.relative_to(room)}:{handler.lineno}"
    assert caught > 10
