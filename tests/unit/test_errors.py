"""Errors on their way from one process to another, and the names that they suggest."""

from __future__ import annotations

import pickle

import pytest

from tactsim.case.yaml_reading import Problem, YamlProblems
from tactsim.errors import CaseError, ConvergenceError, Refused, StorageError, TactsimError, UnknownName, suggestion
from tactsim.outside.files import Unreadable


@pytest.mark.parametrize(
    "error",
    [
        CaseError("a case"),
        ConvergenceError("gave up", [1.0, 0.5]),
        Refused("a part", ("why",)),
        StorageError("a file"),
        UnknownName("case", "annulus_icv", ["annulus_icf"]),
        Unreadable("a file", "missing"),
        YamlProblems(Problem((), 1, "a line"), Problem(("key",), 2, "another")),
    ],
    ids=lambda error: type(error).__name__,
)
def test_a_process_pool_hands_an_error_back_as_it_was_raised(error: TactsimError) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), again.args, vars(again)) == (type(error), str(error), error.args, vars(error))


@pytest.mark.parametrize(
    ("given", "allowed", "meant"),
    [
        ("centre", ["kind", "center", "radius"], "center"),
        ("centre_line", ["kind", "center", "radius"], "center"),
        ("center_line", ["kind", "centre_line", "wall"], "centre_line"),
        ("center", ["kind", "centre_line", "wall"], "centre_line"),
        ("size_x", ["kind", "size", "wall"], "size"),
    ],
)
def test_a_key_of_another_shape_and_of_the_other_spelling_is_suggested(given: str, allowed: list[str], meant: str) -> None:
    """``center`` of a ball is ``centre_line`` of a tube."""
    assert suggestion(given, allowed) == f" (did you mean {meant!r}?)"


def test_what_resembles_no_name_is_not_suggested() -> None:
    assert suggestion("mass", ["kind", "center", "radius"]) == ""
