"""The tissue under a tip: relaxing closed form, curves that mix, errors that are stated and used, finite elements beside it."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from nested_runs import every_end, pretend_to_end

from tactsim.case import load_case
from tactsim.errors import CaseError, ConvergenceError
from tactsim.experiments.threshold import tip_model
from tactsim.experiments.threshold.catheter_tip import CatheterTip
from tactsim.experiments.threshold.tip_contact import mixed_contacts
from tactsim.experiments.threshold.tip_model import (
    ClosedFormTip,
    FiniteElementTip,
    border_errors,
    border_factors,
    flat_errors,
    relaxing_curve,
)
from tactsim.experiments.threshold.valve_tissue import BandTissue, ValveSurface
from tactsim.interfaces.run import returned_by
from tactsim.relaxation import Relaxation
from tactsim.sensors.threshold.sensor_ring import SensorRing
from tactsim.shipped import CASES

EXAMPLE, RING = CatheterTip.example(), SensorRing()
PLACE, SPEED = (11.5e-3, 0.0), 1e-3
RELAXING = Relaxation(fractions=(0.3, 0.2), times=(0.05, 2.0))


@pytest.fixture(scope="module")
def usual():
    return EXAMPLE.run()


def tissue(name, modulus, **changes):
    return BandTissue(**{"name": name, "shear_modulus": modulus, "thickness": 3e-3} | changes)


def surface(relaxation=None):
    tissues = (tissue("leaflet", 15e3, relaxation=relaxation), tissue("annulus", 60e3), tissue("atrium", 8e3))
    return ValveSurface(tissues=tissues, borders=(13e-3, 16e-3))


def test_relaxing_tissue_has_its_mean_modulus_over_the_approach():
    """A ramp from rest: P(T) is the elastic threshold times the mean of g over [0, T], exactly."""
    relaxed, elastic = tissue("a", 15e3, relaxation=RELAXING), tissue("a", 15e3)

    def check(relaxation, speed):
        curve, alone = relaxing_curve(relaxed, RING, speed), relaxing_curve(elastic, RING, speed)
        assert curve.threshold_displacement == pytest.approx(alone.threshold_displacement, rel=1e-12)
        duration = curve.threshold_displacement / speed
        rest, parts, times = relaxation.amplitudes
        mean = rest + float((parts * times * -np.expm1(-duration / times)).sum()) / duration
        assert curve.plate[curve.touch] == pytest.approx(mean * alone.plate[alone.touch], rel=1e-9)

    for speed in (1e-4, 1e-3, 1e-2):
        check(RELAXING, speed)
    assert_kills(
        check,
        time=(Relaxation(fractions=(0.3, 0.2), times=(0.06, 2.0)), SPEED),
        fraction=(Relaxation(fractions=(0.3, 0.21), times=(0.05, 2.0)), SPEED),
    )


def test_mixed_curves_of_elastic_tissue_are_the_mixed_closed_form():
    bands = surface()
    shares = bands.shares(RING, PLACE)
    mixed = mixed_contacts([relaxing_curve(one, RING, SPEED) for one in bands.tissues], shares, np.ones((4, 2)))
    times = np.linspace(0, 1.0, 30)
    for curved, straight in zip(mixed, bands.mixed(RING, PLACE), strict=True):
        assert curved.force == pytest.approx(straight.force, rel=1e-9)
        assert curved.displacement == pytest.approx(straight.displacement, rel=1e-9)
        for one, other in zip(curved.approach(SPEED, 1e-3).at(times), straight.approach(SPEED, 1e-3).at(times), strict=True):
            np.testing.assert_allclose(one, other, rtol=0.02, atol=2e-3 * straight.force)  # tissues differ past the touch
    doubled = mixed_contacts([relaxing_curve(one, RING, SPEED) for one in bands.tissues], shares, np.full((4, 2), [2.0, 0.5]))
    assert doubled[0].force == pytest.approx(2 * mixed[0].force)
    assert doubled[0].displacement == pytest.approx(0.5 * mixed[0].displacement)


def test_slow_tips_meet_softer_tissue():
    def force(tissues, speed):
        return returned_by(ClosedFormTip().contacts(tissues, RING, (5e-3, 0.0), speed))[0].contact.force

    slow, fast = (force(surface(RELAXING), speed) for speed in (1e-4, 1e-2))
    elastic = force(surface(), SPEED)
    assert 0.5 * elastic < slow < 0.8 * fast < 0.8 * elastic


def test_the_errors_of_the_closed_form_are_stated_and_used():
    result = CatheterTip(**EXAMPLE.__dict__ | {"place": (10e-3, 0.0)}).run()
    lowest, true, highest = (result.quantities[f"threshold_{name}"].numbers for name in ("lowest", "pressure", "highest"))
    low, high = flat_errors(RING.recess / RING.outer_radius)
    np.testing.assert_allclose([lowest[1] / true[1] - 1, highest[1] / true[1] - 1], [low, high])  # far from borders
    alone = [contact.force for contact in EXAMPLE.surface.contacts(RING)]
    border = tip_model.BORDER_ERROR * np.log(alone[1] / alone[0])
    assert highest[0] / true[0] - 1 == pytest.approx(high + border)
    assert any("beside finite elements" in words for words in result.assumptions)


def test_sensors_that_the_errors_do_not_tell_apart_are_named(usual):
    near = CatheterTip(**EXAMPLE.__dict__ | {"place": (11.5e-3, 0.0), "ring": SensorRing(count=8)})
    assert 1 in near.run().quantities["possible_hardest"].value
    equal = ValveSurface(tissues=(tissue("a", 40e3), tissue("b", 41e3)), borders=(11e-3,))
    names = CatheterTip(**EXAMPLE.__dict__ | {"surface": equal, "place": (11e-3, 0.0)}).run()
    assert len(names.quantities["possible_hardest"].value) >= 2
    assert usual.quantities["possible_hardest"].value == [1]


def test_stated_errors_between_and_beyond_the_rows():
    assert flat_errors(0.1) == pytest.approx((-0.050, -0.011))
    assert flat_errors(0.075) == pytest.approx((-0.0745, -0.0505))
    assert flat_errors(0.2)[1] == pytest.approx(0.157)
    bands = surface()
    errors = border_errors(bands, RING, (0.0, 0.0), [1.0, 4.0, 0.5], factor=0.06)
    assert (errors == 0).all(), "3 mm from the middle no border is near"
    errors = border_errors(bands, RING, (10e-3, 0.0), [1.0, 4.0, 0.5], factor=0.06)
    assert errors[0] == pytest.approx(0.06 * np.log(4))


def pretended(monkeypatch, factors):
    def curve(self, one, ring, speed):
        yield from ()
        return relaxing_curve(one, ring, speed)

    monkeypatch.setattr(FiniteElementTip, "curve", curve)
    monkeypatch.setattr(tip_model, "border_factors", lambda surface, ring, place: np.array(factors, float))


def test_finite_elements_take_the_place_of_the_closed_form(usual, monkeypatch):
    pretended(monkeypatch, np.ones((4, 2)))
    same = CatheterTip(**EXAMPLE.__dict__ | {"model": FiniteElementTip()}).run()
    np.testing.assert_allclose(same.quantities["threshold_force"].numbers, usual.quantities["threshold_force"].numbers, rtol=1e-9)
    pretended(monkeypatch, [[1.1, 1], [1, 1], [1, 1], [1, 1]])
    changed = CatheterTip(**EXAMPLE.__dict__ | {"model": FiniteElementTip()}).run()
    ratio = changed.quantities["threshold_force"].numbers / same.quantities["threshold_force"].numbers
    np.testing.assert_allclose(ratio, [1.1, 1, 1, 1], rtol=1e-9)
    assert not any("linear theory" in words for words in changed.warnings)
    assert any("finite elements" in words for words in changed.assumptions)


@every_end
def test_what_ends_a_tissue_ends_the_tip(monkeypatch, error, status, reason):
    pretend_to_end(monkeypatch, tip_model.Indentation, error)
    monkeypatch.setattr(tip_model, "border_factors", lambda surface, ring, place: np.ones((4, 2)))
    seen = []
    result = CatheterTip(**EXAMPLE.__dict__ | {"model": FiniteElementTip()}).run(seen.append)
    own = "the leaflet under a sensor: " if isinstance(error, ConvergenceError) else ""
    assert result.status is status
    assert result.reason.startswith(own + reason)
    assert (len(seen), result.steps) == (1, ())


@pytest.mark.slow
@pytest.mark.parametrize(("recess", "friction"), [(0.05e-3, 0.4), (0.1e-3, 0.4), (0.1e-3, 0.0)])
def test_finite_elements_on_a_flat_tissue_are_within_the_stated_errors(one_thread, recess, friction):
    """Some seconds each; the rows of FLAT_ERRORS are rounded to a thousandth."""
    ring, one = SensorRing(recess=recess), tissue("annulus", 60e3)
    curve = returned_by(FiniteElementTip(friction=friction).curve(one, ring, SPEED))
    closed = ValveSurface(tissues=(one, tissue("b", 1e3)), borders=(1.0,)).contacts(ring)[0]
    low, high = flat_errors(recess / ring.outer_radius)
    assert low - 1e-3 <= curve.plate[curve.touch] / closed.force - 1 <= high + 1e-3


@pytest.mark.slow
def test_relaxing_and_convex_tissue_by_finite_elements(one_thread):
    """A minute: the relaxing flat tissue is the closed form's within its errors; a radius of 20 mm takes 14 % away."""
    one = tissue("annulus", 60e3, relaxation=Relaxation(fractions=(0.2,), times=(5.0,)))
    flat, convex = (returned_by(FiniteElementTip(surface_radius=radius).curve(one, RING, SPEED)) for radius in (None, 20e-3))
    closed = relaxing_curve(one, RING, SPEED)
    low, high = flat_errors(0.1)
    assert low <= flat.plate[flat.touch] / closed.plate[closed.touch] - 1 <= high
    assert convex.plate[convex.touch] / flat.plate[flat.touch] == pytest.approx(0.858, abs=0.01)


@pytest.mark.slow
def test_the_border_factors_of_the_shipped_case(one_thread):
    """Seven linear systems, half a minute: within the stated error of the mean by area, and one for the sensors far away."""
    tip = load_case(CASES / "catheter_tip_fem.yaml").experiment
    factors = border_factors(tip.surface, tip.ring, tip.place)
    alone = [contact.force for contact in tip.surface.contacts(tip.ring)]
    stated = border_errors(tip.surface, tip.ring, tip.place, alone, factor=tip_model.BORDER_ERROR)
    assert (np.abs(factors[:, 0] - 1) <= stated + 1e-12).all()
    assert (factors[3:7] == 1).all()
    assert factors[2, 0] == pytest.approx(1.066, abs=0.01)


def test_a_given_threshold_belongs_to_the_elastic_closed_form():
    bands = ValveSurface(tissues=(tissue("a", 1e4, threshold_pressure=1e4), tissue("b", 2e4)), borders=(1e-2,))
    with pytest.raises(CaseError, match="threshold_pressure"):
        CatheterTip(**EXAMPLE.__dict__ | {"surface": bands, "model": FiniteElementTip()})


def test_the_case_is_valid():
    assert load_case(CASES / "catheter_tip_fem.yaml").experiment.model.kind == "fem"
