"""Sensors around a tip: what they meet, the hardest found, the chance of a wrong answer, tilt, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from drawn import text_of

from tactsim.case import load_case
from tactsim.errors import CaseError
from tactsim.experiments.threshold.catheter_tip import CatheterTip
from tactsim.experiments.threshold.figures.catheter_tip import CatheterTipFigures
from tactsim.experiments.threshold.valve_tissue import BandTissue, ValveSurface
from tactsim.plotting import figures_for
from tactsim.results import Status
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.threshold.sensor_ring import SensorRing
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor

ROOT = Path(__file__).parents[4]
RING = SensorRing()
EXAMPLE = CatheterTip.example()


def tip(**changes):
    return CatheterTip(**({name: getattr(EXAMPLE, name) for name in CatheterTip.model_fields} | changes))


def run(**changes):
    return tip(**changes).run()


@pytest.fixture(scope="module")
def usual():
    return run()


def noisy(white):
    return ThresholdSensor(chain=SignalChain(noise=Noise(white=white), low_pass=SignalChain().low_pass))


def bands(*moduli, **common):
    tissues = tuple(BandTissue(name=f"t{k}", shear_modulus=g, thickness=3e-3, **common) for k, g in enumerate(moduli))
    return ValveSurface(tissues=tissues, borders=(13e-3, 16e-3))


def test_the_annulus_is_found_where_it_lies():
    for orientation, sensor in ((0.0, 1), (np.pi / 2, 4), (np.pi, 3)):
        result = run(ring=SensorRing(orientation=orientation))
        assert result.status is Status.CONVERGED
        assert result.quantities["hardest_sensor"].value == sensor
        assert result.quantities["hardest_angle"].value == pytest.approx(0.0, abs=1e-12)
        assert result.quantities["chance_of_wrong"].value == 0
        assert result.quantities["margin"].value > 0


def test_shares_are_areas_and_mixed_thresholds_lie_between():
    surface = bands(10e3, 40e3, 5e3)
    shares = surface.shares(RING, (13e-3 - RING.radius, 0.0))
    np.testing.assert_allclose(shares.sum(axis=1), 1)
    # half of the disc but for the curvature of the border: a^3 / (3 * 13 mm) * 2 / (pi a^2) times 3/4
    assert shares[0, 0] == pytest.approx(0.5, abs=0.02)
    alone = [c.force for c in surface.contacts(RING)]
    mixed = surface.mixed(RING, (13e-3 - RING.radius, 0.0))
    np.testing.assert_allclose([c.force for c in mixed], shares @ alone)
    assert alone[0] < mixed[0].force < alone[1]


def test_straddling_and_small_thresholds_are_reported():
    result = run(place=(10e-3, 0.0))
    assert result.scene.straddles == (True, False, False, False)
    assert any("over two tissues: 1" in warning for warning in result.warnings)
    assert any("E27" in warning for warning in result.warnings)


def test_a_tip_on_one_tissue_and_wrong_units_are_reported():
    far = run(place=("11 m", "0 mm"))
    assert any("every sensor stands on the atrium" in warning for warning in far.warnings)
    assert not any("every sensor stands" in warning or "unit" in warning for warning in run().warnings)
    tissues = [
        {"name": name, "shear_modulus": modulus, "thickness": "3 mm"} for name, modulus in (("a", "20 GPa"), ("b", "20 kPa"))
    ]
    hard = run(surface={"tissues": tissues, "borders": ["13 mm"]})
    assert any("tissue a has a shear modulus of 20 GPa" in warning for warning in hard.warnings)


def test_a_threshold_from_a_simulation_replaces_that_of_the_closed_form():
    area = np.pi * (RING.outer_radius**2 - RING.inner_radius**2)
    closed, given = bands(10e3, 40e3, 5e3), bands(10e3, 40e3, 5e3, threshold_pressure=1e4)
    assert given.contacts(RING)[0].force == pytest.approx(1e4 * area)
    assert closed.contacts(RING)[0].displacement == given.contacts(RING)[0].displacement
    assert closed.contacts(RING)[1].force == pytest.approx(4 * closed.contacts(RING)[0].force), "linear in the modulus"


def test_a_wrong_answer_becomes_likelier_with_the_noise():
    near = bands(40e3, 42e3, 5e3)
    quiet, loud = (run(surface=near, sensor=noisy(white), trials=100) for white in (1e-5, 5e-3))
    assert quiet.quantities["chance_of_wrong"].value == 0
    assert loud.quantities["chance_of_wrong"].value > 0.2
    assert loud.quantities["chance_of_wrong_tissue"].value == loud.quantities["chance_of_wrong"].value


def test_between_equally_hard_tissues_no_answer_is_wrong():
    assert run(surface=bands(20e3, 20e3, 20e3), sensor=noisy(5e-3), trials=50).quantities["chance_of_wrong"].value == 0


def test_touches_without_a_usable_threshold_are_reported(usual):
    assert any("touches report no usable threshold" in words for words in run(sensor=noisy(1.0)).warnings)
    assert not any("touches report no usable threshold" in words for words in usual.warnings)
    assert tip(tilt="30 deg").tilt == pytest.approx(np.pi / 6)


def test_a_tilted_tip_leaves_sensors_without_contact(usual):
    result = run(tilt=0.2, tilt_direction=np.pi, press=0.8e-3)
    assert result.scene.state == ("no contact", "threshold not reached", "measured", "threshold not reached")
    assert result.quantities["reported_force"].value[0] is None
    assert result.quantities["valid_rate"].value[:2] == [0, 0]
    assert result.quantities["chance_of_wrong"].value == 1, "the hardest place is not touched"
    assert any("sensor 1: no contact" in warning for warning in result.warnings)
    assert usual.scene.state == ("measured",) * 4
    np.testing.assert_allclose(RING.lag(0.2, np.pi), np.tan(0.2) * RING.radius * np.array([2, 1, 0, 1]))


def test_a_tip_that_is_not_pressed_enough_has_no_answer():
    result = run(press=0.05e-3)
    assert result.quantities["chance_of_no_answer"].value == 1
    assert "hardest_sensor" not in result.quantities
    assert "no sensor found" in text_of(CatheterTipFigures().figure(result))


def test_the_same_seed_gives_the_same_result(usual):
    assert run().steps == usual.steps
    assert run(seed=2).steps != usual.steps


def test_figure(usual):
    drawings = figures_for(usual)
    assert list(drawings) == ["catheter_tip.png"]
    assert drawings["catheter_tip.png"]().startswith(b"\x89PNG")
    words = text_of(CatheterTipFigures().figure(usual))
    for label in ("hardest at sensor 1", "leaflet", "annulus", "atrium", "threshold pressure in kPa"):
        assert label in words
    best, second = sorted((one for one in usual["reported_pressure"].value if one is not None), reverse=True)[:2]
    assert f"the second reads {100 * (1 - second / best):.2g} % less" in words
    none = run(press=0.05e-3)
    assert figures_for(none)["catheter_tip.png"]().startswith(b"\x89PNG")


def test_an_interrupted_run_keeps_the_sensors_before():
    seen = []

    def stop(step):
        seen.append(step)
        if len(seen) == 2:
            raise KeyboardInterrupt

    result = tip().run(stop)
    assert result.status is Status.INTERRUPTED
    assert len(result.steps) == 2
    assert "hardest_sensor" not in result.quantities
    assert figures_for(result)["catheter_tip.png"]().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"count": 1}, "at least 2"),
        ({"count": 16}, "overlap"),
        ({"outer_radius": 2.5e-3}, "overlap"),
        ({"inner_radius": 1e-3}, "at most 0.99"),
        ({"recess": 0.0}, "greater than 0"),
    ],
)
def test_impossible_rings_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        SensorRing(**changes)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"speed": 0.0}, "greater than 0"),
        ({"press": 2.5e-3}, "press 2.5 mm must be smaller than the thickness of the leaflet, 2 mm"),
        ({"ring": SensorRing(recess=2.5e-3)}, "ring.recess 2.5 mm must be smaller than the thickness"),
        ({"tilt": 1.0}, "at most"),
        ({"tilt": "30.001 deg"}, "at most"),
        ({"lead": 1e4}, "shorten the lead"),
        ({"trials": 0}, "at least 1"),
        ({"surface": {"tissues": [{"name": "a", "shear_modulus": 1e3, "thickness": 1e-2}], "borders": []}}, "at least 2"),
    ],
)
def test_impossible_tips_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        tip(**changes)


@pytest.mark.parametrize(
    ("names", "borders", "words"),
    [("ab", (1e-2, 2e-2), "need 1 borders"), ("abc", (2e-2, 1e-2), "increase"), ("aba", (1e-2, 2e-2), "name of its own")],
)
def test_impossible_surfaces_are_refused(names, borders, words):
    tissues = [BandTissue(name=name, shear_modulus=1e4, thickness=3e-3) for name in names]
    with pytest.raises(CaseError, match=words):
        ValveSurface(tissues=tuple(tissues), borders=borders)


def test_the_case_is_valid():
    experiment = load_case(ROOT / "cases/catheter_tip.yaml").experiment
    assert isinstance(experiment, CatheterTip)
    assert [tissue.name for tissue in experiment.surface.tissues] == ["leaflet", "annulus", "atrium"]
