"""A defect is traced to the innermost line that is no library's."""

from __future__ import annotations

import json

import pytest

from tactsim.outside.defect_place import unless_own


def test_the_line_that_called_a_library_is_named_not_that_of_the_library() -> None:
    def not_json() -> None:
        json.loads("{")

    with pytest.raises(ValueError, match="property name") as caught:
        not_json()
    line = not_json.__code__.co_firstlineno + 1
    assert unless_own(caught.value) == f", unless line {line} of {__name__} is your own"


def test_an_error_that_was_never_raised_has_no_line() -> None:
    assert unless_own(ValueError("x")) == ""
