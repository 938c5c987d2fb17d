"""The response of a stored grasp: computed once, and only for a grasp."""

import numpy as np
import pytest

from tactsim.errors import InputError, StorageError
from tactsim.experiments.film.film_test import FilmTest
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.localization import lump_sensitivity
from tactsim.experiments.localization.response_store import stored_response
from tactsim.localization.lump_response import LumpResponse
from tactsim.results import Result, Status
from tactsim.results.writing import write_result


def stored(folder, experiment):
    empty = Result(kind=experiment.kind, status=Status.CONVERGED, reason="")
    case = {"experiment": experiment.model_dump(mode="json")}
    return str(write_result(empty, folder, case_id="0" * 16, provenance={"case": case}))


@pytest.fixture
def computed(monkeypatch):
    seen = []

    def response(setup):
        seen.append(setup)
        axes = tuple(np.linspace(1e-3, side - 1e-3, 3) for side in setup.block.size)
        return LumpResponse(axes, np.array([2e-3, 4e-3]), np.ones((2, 3, 3, 3, 2, 3, 3)))

    monkeypatch.setattr(lump_sensitivity, "lump_response", response)
    return seen


def test_a_response_is_computed_once_without_the_inclusions(computed, tmp_path):
    folder = stored(tmp_path / "grasp", Grasp.example())
    first = stored_response(folder, cache=tmp_path / "cache")
    again = stored_response(folder, cache=tmp_path / "cache")
    assert len(computed) == 1
    assert computed[0].inclusions == ()
    np.testing.assert_array_equal(first.values, again.values)
    damaged = next((tmp_path / "cache").iterdir())
    damaged.write_bytes(damaged.read_bytes()[:100])
    stored_response(folder, cache=tmp_path / "cache")
    assert len(computed) == 2


def test_only_the_case_of_a_grasp_will_do(computed, tmp_path):
    with pytest.raises(InputError, match="does not tell the case of a grasp"):
        stored_response(stored(tmp_path / "film", FilmTest.example()), cache=tmp_path)
    with pytest.raises(StorageError):
        stored_response(str(tmp_path / "none"), cache=tmp_path)
    assert computed == []
