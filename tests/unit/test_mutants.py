"""The helper that holds checks to their mutants names those that survive and lets other errors through."""

from __future__ import annotations

import pytest
from mutants import assert_kills


def check(value, expected=1.0):
    assert value == expected


def test_a_check_that_fails_with_every_mutant_passes():
    assert_kills(check, wrong=(2.0,), swapped=(2.0, 1.0))


def test_survivors_are_named():
    with pytest.raises(AssertionError, match=r"wrong models: equal, same"):
        assert_kills(check, equal=(1.0,), wrong=(2.0,), same=(2.0, 2.0))


def test_a_mutant_that_breaks_the_check_is_no_failure_of_it():
    with pytest.raises(TypeError):
        assert_kills(check, broken=(1.0, 2.0, 3.0))
