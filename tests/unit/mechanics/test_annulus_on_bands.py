"""The annulus on bands of tissue: against the closed form of one band, its limits, and what the mean by area is worth."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.errors import InvalidQuantity
from tactsim.experiments.threshold.tip_model import BORDER_ERROR
from tactsim.mechanics.models.annulus_on_bands import AnnulusOnBands, Band, BandMesh

A, B, RECESS, THICK = 1e-3, 0.5e-3, 0.1e-3, 3e-3
SOFT, HARD = Band(10e3, THICK, "bonded"), Band(60e3, THICK, "bonded")
COARSE = BandMesh(finest=0.25, growth=1.2, sectors=4, width=4.0)
FAR = 0.1
"""Radius of a border that is nearly straight, in m."""
pytestmark = pytest.mark.usefixtures("one_thread")


@cache
def model(soft=SOFT, hard=HARD, mesh=COARSE):
    return AnnulusOnBands(B, A, (soft, hard), (FAR,), mesh=mesh)


@cache
def alone(k):
    """Response of the soft band (0) or the hard one (1) on its own."""
    return model().alone(k)


def closed(modulus, base="bonded"):
    """Threshold force in N and displacement in m of the closed form."""
    punch = solve_annular_punch(B / A, radius_over_thickness=A / THICK, base=base)
    displacement = RECESS / punch.rise_factor
    return 8 * modulus * A * punch.force_factor * displacement, displacement


def check_hard(response):
    """The hard band's threshold is that of the closed form."""
    force, displacement = response.threshold(RECESS)
    assert force == pytest.approx(closed(60e3)[0], rel=0.05)  # elements of a quarter radius on a piece of 4 radii
    assert displacement == pytest.approx(closed(60e3)[1], rel=0.1)  # the same; finer and wider below


def test_one_band_is_the_layer_of_the_closed_form():
    check_hard(alone(1))
    slipping = model(soft=Band(60e3, THICK, "slipping"))
    assert_kills(check_hard, soft=(alone(0),), slipping=(slipping.alone(0),))


@pytest.mark.slow
def test_a_band_of_half_the_thickness_is_seen():
    assert_kills(check_hard, thin=(model(soft=Band(60e3, THICK / 2, "bonded")).alone(0),))


def test_bands_of_one_tissue_are_one_band():
    equal = model(soft=HARD)
    one, both = equal.alone(1), equal.at(FAR - 0.3 * A)
    assert both.stiffness == pytest.approx(one.stiffness, rel=1e-8)
    assert both.rise == pytest.approx(one.rise, rel=1e-7)


def test_far_from_a_border_there_is_none():
    forces = [model().at(FAR + side * 3.5 * A).threshold(RECESS)[0] for side in (-1, 1)]
    bare = [alone(k).threshold(RECESS)[0] for k in (0, 1)]
    np.testing.assert_allclose(forces, bare, rtol=0.02)  # the stiffness decays like the distance cubed, the threshold faster
    assert bare[1] == pytest.approx(6 * bare[0], rel=1e-9), "linear in the modulus"


def test_over_a_border_the_threshold_lies_between():
    soft, hard = (alone(k).threshold(RECESS)[0] for k in (0, 1))
    forces = [model().at(FAR + part * A).threshold(RECESS)[0] for part in (-0.5, 0.0, 0.5)]
    assert soft < forces[0] < forces[1] < forces[2] < hard


def share(part):
    """Part of a disc beyond a straight border at ``part`` of its radius from the middle."""
    part = np.clip(part, -1.0, 1.0)
    return (np.arccos(part) - part * np.sqrt(1 - part**2)) / np.pi


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "worst"), [(2.0, 0.024), (6.0, 0.088)])
def test_the_mean_by_area_is_within_its_stated_error(ratio, worst):
    """Fourteen linear systems of 20 000 unknowns, about half a minute."""
    bands = model(hard=Band(10e3 * ratio, THICK, "bonded"), mesh=BandMesh())
    soft, hard = (bands.alone(k).threshold(RECESS)[0] for k in (0, 1))
    errors = []
    for part in np.array([-1.5, -1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1, 1.5]):
        force = bands.at(FAR - part * A).threshold(RECESS)[0]
        errors.append(force / (soft + share(part) * (hard - soft)) - 1)
    largest = np.abs(errors).max()
    assert largest == pytest.approx(worst, abs=0.01)
    assert largest < BORDER_ERROR * np.log(ratio)


@pytest.mark.slow
def test_finer_elements_and_a_wider_piece_near_the_closed_form():
    """Within 1.1 % in force on a piece of 7 radii, 1.6 % in displacement; half the elements' size changes 0.3 %."""
    wide = model(mesh=BandMesh(width=7.0)).alone(1).threshold(RECESS)
    assert wide[0] == pytest.approx(closed(60e3)[0], rel=0.015)
    assert wide[1] == pytest.approx(closed(60e3)[1], rel=0.02)
    default, fine = (model(mesh=BandMesh(finest=size)).alone(1).threshold(RECESS)[0] for size in (0.1, 0.05))
    assert default == pytest.approx(fine, rel=0.005)


@pytest.mark.parametrize("borders", [(), (0.1, 0.2), (0.2, 0.1)])
def test_borders_that_do_not_belong_are_refused(borders):
    with pytest.raises(InvalidQuantity, match="one border fewer"):
        AnnulusOnBands(B, A, (SOFT, HARD), borders)
