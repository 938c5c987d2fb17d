"""Errors on their way from one process to another."""

from __future__ import annotations

import pickle

import pytest

from tactsim.case.yaml_reading import Problem, YamlProblems
from tactsim.errors import CaseError, ConvergenceError, Refused, StorageError, TactsimError, UnknownName
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
