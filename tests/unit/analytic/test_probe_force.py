"""Quasi-linear superposition against closed forms, the probe's curve, and E26: no passive tissue softens when pressed faster."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.probe_curve import CHAPTER_5
from tactsim.analytic.probe_force import probe_forces
from tactsim.analytic.quasi_linear import quasi_linear
from tactsim.errors import InvalidQuantity

MODULUS = GeneralizedMaxwell(3.0, [2.0, 5.0], [0.1, 4.0])
WIDTH = 10e-3


def test_a_ramp_is_the_integral_of_the_modulus_on_uneven_times():
    time = np.append(0.0, np.sort(np.random.default_rng(1).uniform(0, 8, 200)))
    terms = MODULUS.moduli * MODULUS.times * -np.expm1(-time[:, None] / MODULUS.times)
    expected = (3.0 * time + terms.sum(axis=1)) / 10.0
    np.testing.assert_allclose(quasi_linear(time, time, MODULUS), expected, rtol=1e-12)
    swapped = GeneralizedMaxwell(3.0, MODULUS.moduli[::-1], MODULUS.times)
    assert not np.allclose(quasi_linear(time, time, swapped), expected, rtol=1e-2, atol=0)


def test_a_jump_relaxes_by_the_modulus_and_columns_are_alone():
    time = np.linspace(0, 10, 50)
    elastic = np.column_stack([np.full(50, 2.0), np.zeros(50)])
    computed = quasi_linear(time, elastic, MODULUS)
    np.testing.assert_allclose(computed[:, 0], 2 * MODULUS.relaxation(time) / 10, rtol=1e-12)
    assert not computed[:, 1].any()


def test_a_curved_answer_converges_with_the_second_order():
    def last(samples):
        time = np.linspace(0, 2, samples + 1)
        return quasi_linear(time, time**3, MODULUS)[-1]

    errors = np.abs(np.array([last(n) for n in (50, 100, 200, 400)]) - last(20_000))
    orders = np.log2(errors[:-1] / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


@pytest.mark.parametrize("time", [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, 1.0], []])
def test_times_that_do_not_increase_are_refused(time):
    with pytest.raises(InvalidQuantity, match="increasing"):
        quasi_linear(np.array(time), np.zeros(3), MODULUS)


def pressed(rate, modulus, samples=400):
    depth = np.linspace(0, 5e-3, samples)
    return probe_forces(depth / rate, depth, curve=CHAPTER_5, modulus=modulus, width=WIDTH)


def test_an_elastic_probe_follows_its_curve_and_scales():
    computed = pressed(1e-3, GeneralizedMaxwell(1e4, [], []))
    assert computed.force[-1] == pytest.approx(1e4 * WIDTH * CHAPTER_5.force[-1], rel=1e-12)
    assert pressed(3e-3, GeneralizedMaxwell(2e4, [], [])).force == pytest.approx(2 * computed.force, rel=1e-12)
    assert (np.diff(computed.force) > 0).all()
    assert (np.diff(computed.contact_height) >= 0).all()
    assert (computed.switches[:, 0] > 0).any()
    assert not computed.switches[:, 1:].any()


def test_force_at_a_depth_grows_with_the_rate_for_any_tissue_that_relaxes():
    """E26: the force is a mean of a falling modulus over the time taken."""
    generator = np.random.default_rng(26)
    for _ in range(50):
        moduli, times = 1e4 * generator.dirichlet(np.ones(4)), np.exp(generator.uniform(-3, 4, 3))
        modulus = GeneralizedMaxwell(moduli[3], moduli[:3], times)
        forces = np.array([pressed(rate, modulus).force[1:] for rate in (0.25e-3, 0.5e-3, 1e-3, 3e-3)])
        assert (np.diff(forces, axis=0) > 0).all()


def test_contact_opens_on_the_way_back():
    time = np.linspace(0, 2, 801)
    depth = np.interp(time, [0, 1, 2], [0, 5e-3, 0])
    computed = probe_forces(time, depth, curve=CHAPTER_5, modulus=GeneralizedMaxwell(1e3, [9e3], [0.5]), width=WIDTH)
    assert computed.force.min() == 0.0
    opened = np.flatnonzero((computed.force == 0) & (time > 1))
    assert depth[opened[0]] > 0.1e-3, "before the probe is back"
    assert not computed.contact_height[opened].any()
    assert not computed.switches[opened].any()


@pytest.mark.parametrize("depth", [-1e-4, 5.1e-3])
def test_depths_beyond_the_curve_are_refused(depth):
    with pytest.raises(InvalidQuantity, match="the curve holds"):
        CHAPTER_5.at(np.array([0.0, depth]))
