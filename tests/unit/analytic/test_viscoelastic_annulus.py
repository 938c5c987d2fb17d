"""The annulus on viscoelastic tissue: elastic limit, inverse, rise, touching, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.analytic.atrial import TIMES, atrial_shear_compliance
from tactsim.analytic.force_factor import force_factor, rise_factor
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.histories import harmonic, ramp, sampled, step
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus, creep_time
from tactsim.errors import InvalidQuantity, UnknownName

SOLID = GeneralizedKelvin(2e-4, [1e-4, 3e-4], [0.1, 5.0])
RADIUS = 3e-3
ROUND_OFF = 1e-12
"""Relative, of sums over three terms and of the interconversion."""


def annulus(ratio=0.4, tissue=SOLID, **settings):
    return ViscoelasticAnnulus(RADIUS, ratio, tissue, **settings)


def agree(computed, expected):
    np.testing.assert_allclose(computed, expected, rtol=ROUND_OFF)


def test_without_delay_it_is_the_elastic_annulus():
    tissue = GeneralizedKelvin(1 / 5e3, [], [])
    elastic = annulus(tissue=tissue)
    expected = 0.7 / (8 * 5e3 * RADIUS * force_factor(0.4))
    agree(elastic.displacement(step(0.7), [0.0, 3.0]), expected)
    agree(elastic.force(step(float(expected)), [0.0, 3.0]), 0.7)
    with pytest.raises(AssertionError):
        agree(annulus(tissue=tissue, formula="thesis_4_2_21").displacement(step(0.7), 3.0), expected)


def test_a_step_creeps_like_the_compliance():
    t = np.logspace(-3, 2, 20)
    agree(annulus().displacement(step(2.0), t), 2 * SOLID.creep(t) / annulus().length)
    agree(annulus().creep_displacement([[1.0], [2.0]], t)[1], annulus().displacement(step(2.0), t))


@pytest.mark.parametrize("times", TIMES)
def test_force_undoes_displacement(times):
    """The displacement under a ramp, sampled at 4000 points, brings back the force; linear interpolation errs like its square."""
    tissue = annulus(tissue=atrial_shear_compliance(times))
    t = np.linspace(0, 2, 4001)
    history = sampled(t, tissue.displacement(ramp(0.5, 1.0), t))
    expected = 0.5 * np.minimum(t, 1.0)
    computed = tissue.force(history, t)
    error = np.abs(computed - expected).max()
    # The moduli over a time step of 0.5 ms change by less than a percent; so does the largest force
    assert error < 0.01 * 0.5
    other = annulus(tissue=atrial_shear_compliance(times, "half_shear"))
    assert np.abs(other.force(history, t) - expected).max() > 0.01 * 0.5, "another reading of the compliance is seen"


def test_the_contact_opens_where_the_force_is_negative():
    """A displacement taken back faster than the tissue follows needs a pull."""
    force = annulus().force(sampled([0.0, 1.0, 1.1], [0.0, 1e-4, 0.0]), [1.0, 1.1])
    assert force[0] > 0 > force[1]


def test_the_rise_is_that_of_the_exact_contact():
    for formula in ("exact", "thesis_4_2_21"):
        agree(annulus(formula=formula).rise([1e-3, 2e-3]), np.array([1e-3, 2e-3]) * rise_factor(0.4))
    assert annulus(0).rise(1.0) == 0


def test_a_layer_takes_its_factors_from_the_solved_contact():
    punch = solve_annular_punch(0.4, radius_over_thickness=0.75, base="slipping")
    layer = annulus(radius_over_thickness=0.75, base="slipping")
    agree([layer.force_factor, layer.rise_factor], [punch.force_factor, punch.rise_factor])
    assert layer.rise_factor > annulus().rise_factor


def test_a_small_sensor_is_touched_where_the_tissue_stands_highest():
    """On the axis of a half-space; off it on a layer of a quarter of the radius, by 13 % (ring patches of 200: 1.9914)."""
    half_space, thin = annulus(0.5), annulus(0.5, radius_over_thickness=4.0)
    assert half_space.touch_factor == half_space.rise_factor
    assert thin.touch_factor == pytest.approx(1.9914, rel=1e-4)
    assert thin.rise_factor < 0.9 * thin.touch_factor
    punch = solve_annular_punch(0.5, radius_over_thickness=4.0)
    assert thin.touch_factor == pytest.approx(punch.rise(np.linspace(0, 0.499, 500)).max(), rel=1e-5)


def test_nothing_is_touched_beyond_the_base_of_a_layer():
    """The annulus has gone through a layer of 3 mm / 2 before tissue rises by twice that: no force, no time."""
    thin = annulus(0.4, radius_over_thickness=2.0)
    reached = thin.touch_factor * thin.thickness
    assert thin.thickness == pytest.approx(thin.outer_radius / 2)
    for recess, touched in ((0.99 * reached, True), (1.01 * reached, False)):
        numbers = thin.touch_displacement(recess), thin.force_to_touch(recess, 1.0), thin.time_to_touch(recess, 1e9)
        assert [bool(np.isfinite(number)) for number in numbers] == [touched] * 3


@pytest.mark.parametrize("times", TIMES)
def test_force_and_time_to_touch_are_each_others_inverse(times):
    sensor = annulus(0.1, atrial_shear_compliance(times))
    recess, t = np.array([[0.1e-3], [0.7e-3]]), np.array([0.01, 0.5, 10.0])
    force = sensor.force_to_touch(recess, t)
    assert force.shape == (2, 3)
    agree(sensor.rise(sensor.creep_displacement(force, t)), np.broadcast_to(recess, (2, 3)))
    agree(sensor.time_to_touch(recess, force), np.broadcast_to(t, (2, 3)))
    with pytest.raises(AssertionError):
        agree(sensor.time_to_touch(recess, force * (1 + 1e-10)), np.broadcast_to(t, (2, 3)))


def test_touching_at_once_and_never():
    assert creep_time(SOLID, [1e-4, 2e-4, 6e-4, 1.0]).tolist() == [0, 0, np.inf, np.inf]
    assert annulus(0).force_to_touch(1e-3, 1.0) == np.inf
    assert annulus(0).time_to_touch(1e-3, 1.0) == np.inf


def test_a_fluid_always_touches():
    fluid = GeneralizedKelvin(2e-4, [1e-4], [0.1], fluidity=1e-5)
    wanted = np.array([2.1e-4, 5e-4, 1.0])
    agree(fluid.creep(creep_time(fluid, wanted)), wanted)


def test_histories_with_harmonics_are_taken():
    t = np.linspace(2, 3, 5)
    computed = annulus().displacement(harmonic(-0.2, 1.0, start=2.0, mean=0.2), t)
    still = annulus().displacement(step(0.2), t)
    assert computed[0] == pytest.approx(still[0], rel=ROUND_OFF)
    assert computed[1] < still[1]


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"ratio": 1.0}, InvalidQuantity),
        ({"radius_over_thickness": -1.0}, InvalidQuantity),
        ({"radius_over_thickness": 1.0, "formula": "thesis_4_2_21"}, InvalidQuantity),
        ({"radius_over_thickness": 1.0, "base": "loose"}, UnknownName),
        ({"formula": "printed"}, UnknownName),
    ],
)
def test_what_is_out_of_range_is_refused(settings, error):
    with pytest.raises(error):
        annulus(**settings)


def test_a_negative_recess_or_force_is_refused():
    with pytest.raises(InvalidQuantity, match="recess"):
        annulus().force_to_touch(-1e-3, 1.0)
    with pytest.raises(InvalidQuantity, match="force"):
        annulus().time_to_touch(1e-3, 0.0)
    with pytest.raises(InvalidQuantity, match="compliance"):
        creep_time(SOLID, 0.0)
