"""Distributions of a sweep file."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy

from tactsim.dataset.sampling.places import filled, places_of
from tactsim.errors import InvalidQuantity
from tactsim.interfaces.distributions import distribution

SHARES = (np.arange(2000) + 0.5) / 2000


def drawn(written: dict[str, Any]) -> np.ndarray:
    """Stored numbers at even shares of the probability."""
    return np.array([distribution(written).value(share)[1] for share in SHARES])


def test_quantities_are_written_in_their_unit_and_stored_in_si() -> None:
    assert distribution({"uniform": ["2 mm", "0.6 cm"]}).value(0.5) == ("4 mm", pytest.approx(4e-3, rel=1e-14))
    assert distribution({"uniform": ["2 mm", "0.6 cm"]}).unit == "m"
    assert distribution({"uniform": [1, 3]}).value(0.25) == (1.5, 1.5)
    assert distribution({"values": ["3 kPa", "4000 Pa"]}).value(0.9) == ("4000 Pa", 4000.0)
    assert type(distribution({"values": [1, 2]}).value(0.1)[0]) is int
    assert distribution({"integer": [2, 4]}).value(0.999)[0] == 4
    assert distribution({"range": ["1 mm", "2 mm", 3]}).options == ("1 mm", "1.5 mm", "2 mm")


def test_moments_are_those_of_the_distribution() -> None:
    # tolerances: error of the midpoint rule with 2000 points
    assert drawn({"uniform": [2, 4]}).std() == pytest.approx(2 / np.sqrt(12), rel=1e-3)
    assert np.log(drawn({"log_uniform": [1, 100]})).mean() == pytest.approx(np.log(10), rel=1e-3)
    normal = drawn({"normal": [5, 2]})
    assert (normal.mean(), normal.std()) == (pytest.approx(5, abs=1e-3), pytest.approx(2, rel=2e-3))
    truncated = drawn({"normal": [0, 1], "within": [0, 10]})
    assert truncated.min() >= 0
    assert truncated.mean() == pytest.approx(np.sqrt(2 / np.pi), rel=2e-3)


def test_the_tail_of_a_normal_distribution_above_its_mean_mirrors_that_below() -> None:
    """Probabilities near one have digits for three values beyond eight standard deviations."""
    above, below = drawn({"normal": [0, 1], "within": [8, 12]}), drawn({"normal": [0, 1], "within": [-12, -8]})
    np.testing.assert_allclose(above, -below[::-1], rtol=1e-14)
    assert len(set(above)) == len(above)
    assert above.mean() == pytest.approx(scipy.stats.truncnorm(8, 12).mean(), rel=1e-5)


def test_a_wrong_law_would_be_noticed() -> None:
    """The moment by which each law is known is not that of the other over the same range."""
    assert np.log(drawn({"uniform": [1, 100]})).mean() != pytest.approx(np.log(10), rel=1e-3)
    assert drawn({"log_uniform": [2, 4]}).std() != pytest.approx(2 / np.sqrt(12), rel=1e-3)


def test_weights_count() -> None:
    chosen = drawn({"choice": ["icf_stable", "b1a_stable"], "weights": [3, 1]})
    assert chosen.mean() == pytest.approx(0.25)


def test_places_within_options_have_values_only_if_chosen() -> None:
    document = {"a": {"choice": [{"kind": "x", "r": {"uniform": [0, 1]}}, "none"]}, "b": [{"integer": [1, 2]}]}
    places = places_of(document, ())
    assert [place.key for place in places] == ["a", "a.choice.0.r", "b.0"]
    used: dict = {}
    values = {place.path: place.distribution.value(0.1) for place in places}
    assert filled(document, (), values, used) == {"a": {"kind": "x", "r": 0.1}, "b": [1]}
    values[("a",)] = places[0].distribution.value(0.9)
    used.clear()
    assert filled(document, (), values, used) == {"a": "none", "b": [1]}
    assert set(used) == {("a",), ("b", 0)}


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ({"uniform": [2, 1]}, "must increase"),
        ({"uniform": [float("nan"), 1]}, "nan is not a finite number"),
        ({"values": [1, float("inf")]}, "inf is not a finite number"),
        ({"uniform": ["1 mm", 2]}, "mixes plain numbers and quantities"),
        ({"uniform": ["1 mm", "2 kPa"]}, "wrong dimension"),
        ({"uniform": [1]}, r"list of 2, \[least, largest\]"),
        ({"uniform": 3}, "takes a list"),
        ({"uniform": [1, 2], "weights": [1, 1]}, "not one distribution: 'weights' beside uniform; allowed: nothing"),
        ({"normal": [1, 2], "least": 0}, "'least' beside normal; allowed: within"),
        ({"normal": {"mean": 1, "sd": 1}}, r"takes a list, \[mean, standard deviation\], not"),
        ({"log_uniform": [0, 2]}, "must be positive"),
        ({"normal": [0, 0]}, "must be positive"),
        ({"normal": [0, 1], "within": [50, 60]}, "hold a part"),
        ({"integer": [1.5, 2]}, "whole numbers"),
        ({"integer": [True, 2]}, "whole numbers"),
        ({"range": [1, 2, 1]}, "number of values"),
        ({"values": ["icf_stable"]}, "not a number or a quantity"),
        ({"choice": []}, "takes a list"),
        ({"choice": [1, 2], "weights": [0, 0]}, "not all zero"),
        ({"choice": [1, 2], "weights": [1]}, "list of 2"),
    ],
)
def test_what_cannot_be_drawn_from_is_refused(written: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidQuantity, match=words):
        distribution(written)
