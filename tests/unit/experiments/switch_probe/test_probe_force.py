"""The fast model of the probe: its curve, where contact opens, and E26: no passive tissue softens when pressed faster."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.errors import InvalidQuantity
from tactsim.experiments.switch_probe.probe_curve import CHAPTER_5
from tactsim.experiments.switch_probe.probe_force import probe_forces

WIDTH = 10e-3


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
