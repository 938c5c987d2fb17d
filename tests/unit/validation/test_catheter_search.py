"""How often sensors around a tip find the annulus: what is counted, by a surface that leaves no doubt, and what is refused."""

from __future__ import annotations

from functools import cache

import pytest

from tactsim.errors import InputError
from tactsim.shipped import CASES
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities import catheter
from tactsim.validation.quantities.catheter import catheter_search, catheter_search_over_sensors

FEW = {"places": 3, "touches": 5}


@pytest.fixture(scope="module", autouse=True)
def _searched_once():
    """The same places are touched once, whatever number is asked of them."""
    runs = catheter._runs

    @cache
    def known(*given, **settings):
        return list(runs(Inputs(folder=CASES), *given, **settings))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(catheter, "_runs", lambda inputs, *given, **settings: known(*given, **settings))
        yield


def search(number, *, case="catheter_tip.yaml", tissue="annulus", sensors=4, **changes):
    return catheter_search(Inputs(folder=CASES), number, case, tissue, sensors=sensors, **FEW | changes)


def test_more_sensors_reach_the_annulus_more_often():
    """The same places, of which eight sensors miss none that two meet."""
    reached = [search("reached", sensors=count, places=10, touches=1) for count in (2, 8)]
    assert 0 < reached[0] < reached[1] <= 1
    found = search("found", sensors=8, places=10, touches=1)
    assert found <= reached[1], "a sensor can only be named on the annulus where one lies on it"


def test_where_no_sensor_lies_on_the_annulus_nothing_counts():
    """Of ten places two sensors reach some: the share of what is found there is the share of all over that of the places."""
    settings = {"sensors": 2, "places": 10, "touches": 2}
    reached, found, there = (search(number, **settings) for number in ("reached", "found", "found_where_reached"))
    assert 0 < reached < 1
    assert found == pytest.approx(reached * there)
    assert there > found


def test_the_right_sensor_and_the_bias():
    assert 0.5 < search("named") <= 1
    assert 0.2 < search("bias") < 1.5, "the trigger fires after the touch, so that thresholds are reported high"
    drawn = catheter_search_over_sensors(Inputs(folder=CASES), "t", "catheter_tip.yaml", "annulus", sensors=(3, 4), **FEW)
    assert [len(curve["x"]) for curve in drawn["panels"][0]["curves"]] == [2, 2, 2]


def test_other_cases_and_tissues_are_refused():
    with pytest.raises(InputError, match="needed: a catheter_tip"):
        search("found", case="film_creep.yaml")
    with pytest.raises(InputError, match="between two others"):
        search("found", tissue="leaflet")
