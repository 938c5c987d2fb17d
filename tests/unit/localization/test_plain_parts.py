"""The readings beside an estimate say whether the reference is of the tissue that was read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import LAYOUT, NOISE, SIZE, plain_forces, response

from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.hypotheses import HypothesesEstimator
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.plain_parts import plain_parts, plain_parts_warning

PLAIN = plain_forces(np.array([1e-3]))[0]
CORNER = (10e-3, 10e-3, 10e-3)
NOTHING = Estimate(False, (), "nothing")
LUMP = Estimate(True, (EstimatedInclusion("sphere", CORNER, 4e-3),), "a lump")


def read(forces: np.ndarray, seed: int = 1) -> Readings:
    noise = NOISE * np.random.default_rng(seed).standard_normal((2, *forces.shape))
    return Readings(forces + noise[0], LAYOUT, SIZE, reference=PLAIN + noise[1], noise=NOISE)


def with_lump() -> np.ndarray:
    return PLAIN + 10.0 * response().signal(np.array([CORNER]), np.array([4e-3]))[0]


def test_plain_tissue_fits_its_reference() -> None:
    assert all(plain_parts_warning(read(PLAIN, seed), NOTHING) is None for seed in range(50))


def test_stiffer_tissue_is_a_warning_with_its_factor() -> None:
    parts = plain_parts(read(1.25 * PLAIN), NOTHING)
    assert parts is not None
    assert parts.common > 3 * parts.limits[0]
    assert parts.apart < parts.limits[1]
    assert parts.fits_scaled
    assert parts.factor == pytest.approx(1.25, abs=5e-3)
    words = plain_parts_warning(read(1.25 * PLAIN), NOTHING)
    assert words is not None
    assert "1.25 times as large" in words
    assert "allows for no such factor, and may take it for an inclusion" in words
    assert "allows for one common factor" in str(plain_parts_warning(read(1.25 * PLAIN), replace(NOTHING, factor=1.25)))


def test_a_factor_of_four_deviations_is_a_warning_however_many_taxels_share_it() -> None:
    """What friction 0.4 in place of 0.6 does to the reference of a plain grasp: 9 % less everywhere, seen by 8 taxels or 18."""
    middle = Estimate(True, (EstimatedInclusion("unknown", (20e-3, 20e-3, 10e-3)),), "the middle")
    for estimate in (NOTHING, middle):
        assert "1.09 times as large" in str(plain_parts_warning(read(1.09 * PLAIN), estimate))
        assert plain_parts_warning(read(1.04 * PLAIN), estimate) is None


def test_readings_in_another_unit_are_a_multiple_of_the_reference() -> None:
    given = read(PLAIN)
    parts = plain_parts(replace(given, forces=1e3 * given.forces), NOTHING)
    assert parts is not None
    assert parts.factor == pytest.approx(1e3, rel=5e-3)
    assert parts.fits_scaled, "the factor multiplies the errors too"


def test_readings_of_the_opposite_sign_are_named() -> None:
    given = read(-PLAIN)
    words = plain_parts_warning(given, replace(NOTHING, factor=-1.0))
    assert words is not None
    assert "opposite sign; forces are positive where the tissue presses" in words
    estimate = ModelBasedEstimator().estimate(replace(given, response=response()))
    assert "opposite sign" in estimate.reason
    assert "gain" not in estimate.reason


def test_a_lump_is_not_held_against_the_reference() -> None:
    assert plain_parts_warning(read(with_lump()), LUMP) is None
    missed = plain_parts_warning(read(with_lump()), NOTHING)
    assert missed is not None
    assert "nor any multiple of it" in missed
    parts = plain_parts(read(PLAIN), LUMP)
    assert parts is not None
    assert parts.taxels == 2 * 6  # without the lump's own column of taxels, and the two beside it


@pytest.mark.parametrize("wrong", [pytest.param(0.05, marks=pytest.mark.slow), -0.05, 0.5])
def test_a_finding_that_rests_on_one_taxel_is_a_warning_that_names_it(wrong: float) -> None:
    forces = PLAIN.copy()
    forces[1, 0, 2] += wrong
    given = replace(read(forces), response=response())
    for estimator in (HypothesesEstimator(), ModelBasedEstimator()):
        words = str(plain_parts_warning(given, estimator.estimate(given)))
        assert words.startswith("all readings but that of taxel L1,3 (lower jaw, row 1, column 3) fit the reference")
    valid = np.ones(forces.shape, bool)
    valid[1, 0, 2] = False
    left_out = replace(given, valid=valid)
    estimate = HypothesesEstimator().estimate(left_out)
    assert (estimate.present, plain_parts_warning(left_out, estimate)) == (False, None), "as dead it finds nothing"


def test_two_taxels_that_change_alike_are_no_lone_one() -> None:
    """A lump half way between the jaws raises the taxels above and below it by the same."""
    alike = PLAIN.copy()
    alike[:, 1, 1] += 0.05
    given = Readings(alike, LAYOUT, SIZE, reference=PLAIN, noise=NOISE)
    assert "all readings but that of" not in str(plain_parts_warning(given, NOTHING))


def test_a_lump_rests_on_more_than_one_taxel() -> None:
    generator = np.random.default_rng(5)
    for seed in range(60):
        place, radius = generator.uniform([8e-3, 8e-3, 5e-3], [32e-3, 32e-3, 15e-3]), generator.uniform(2e-3, 5e-3)
        lump = PLAIN + 3.0 * response().signal(place[None], np.array([radius]))[0]
        assert "all readings but that of" not in str(plain_parts_warning(read(lump, seed), NOTHING))


def test_nothing_is_said_without_a_reference_or_plain_parts() -> None:
    assert plain_parts(Readings(PLAIN, LAYOUT, SIZE), NOTHING) is None
    everywhere = tuple(EstimatedInclusion("unknown", (x, y, 10e-3)) for x in (10e-3, 30e-3) for y in (10e-3, 30e-3))
    lumps = Estimate(True, everywhere, "lumps", factor=1.04)
    assert plain_parts(read(PLAIN), lumps) is None
    assert plain_parts_warning(read(PLAIN), lumps) is None
    assert plain_parts(replace(read(PLAIN), valid=np.arange(18).reshape(2, 3, 3) % 2 == 0), NOTHING).taxels == 9


def test_a_factor_is_doubted_where_no_plain_parts_are_left() -> None:
    """Two arteries under all taxels: a factor of 2.3 with a reference of the same tissue was stated without a doubt."""
    lines = [((0.0, y, 10e-3), (40e-3, y, 10e-3)) for y in (10e-3, 30e-3)]
    tubes = tuple(EstimatedInclusion("tube", (20e-3, line[0][1], 10e-3), 4e-3, line=line) for line in lines)
    words = plain_parts_warning(read(2.3 * PLAIN), Estimate(True, tubes, "two arteries", factor=2.3))
    assert words is not None
    assert "whether its factor of 2.3 is of tissue and sensors" in words


def under_all_taxels(factor: float | None = None) -> Estimate:
    lines = [((0.0, y, 10e-3), (40e-3, y, 10e-3)) for y in (10e-3, 30e-3)]
    tubes = tuple(EstimatedInclusion("tube", (20e-3, line[0][1], 10e-3), 4e-3, line=line) for line in lines)
    return Estimate(True, tubes, "two arteries", factor=factor)


@pytest.mark.parametrize("factor", [None, 1.0])
def test_inclusions_under_all_taxels_are_doubted_where_a_factor_alone_explains_the_readings(factor: float | None) -> None:
    """40 of 40 plain blocks, the reference 20 % softer, were two arteries to `hypotheses` without a factor, without a word."""
    words = plain_parts_warning(read(1.25 * PLAIN), under_all_taxels(factor))
    assert words is not None
    assert "the readings of all 18 are 1.25 times the reference" in words
    assert "without any inclusion" in words
    assert plain_parts_warning(read(PLAIN), under_all_taxels(factor)) is None, "the reference is of this tissue"
    assert plain_parts_warning(read(1.25 * PLAIN + with_lump() - PLAIN), under_all_taxels(factor)) is None, "a factor is not all"
    assert plain_parts_warning(Readings(PLAIN, LAYOUT, SIZE), under_all_taxels(factor)) is None


def test_hypotheses_that_cannot_fit_a_factor_are_warned_of_on_plain_tissue() -> None:
    given = replace(read(1.25 * PLAIN), response=response())
    estimate = HypothesesEstimator(factor_spread=0.0).estimate(given)
    assert estimate.present
    assert estimate.factor is None, "it allows for none"
    assert "give a reference of this tissue" in str(plain_parts_warning(given, estimate))
    assert HypothesesEstimator().estimate(given).factor == pytest.approx(1.25, abs=0.01)


def test_model_based_that_states_no_factor_is_not_said_to_allow_for_one() -> None:
    """It stated the error of a reference of the same tissue as a factor, and the warning that it allowed for one."""
    given = replace(read(1.25 * PLAIN), response=response())
    rigid = ModelBasedEstimator(factor_spread=0.0).estimate(given)
    assert rigid.factor is None
    assert "times those of the reference" not in rigid.reason
    words = str(plain_parts_warning(given, rigid))
    assert "give a reference of this tissue" in words
    assert "allows for one common factor" not in words
    plain = ModelBasedEstimator(factor_spread=0.0).estimate(replace(read(PLAIN), response=response()))
    assert (plain.present, plain.factor) == (False, None)


def test_two_balls_are_stated_with_the_factor_of_the_readings() -> None:
    """The words of one ball, and of none, had it; those of two did not."""
    lumps = sum(10.0 * response().signal(np.array([place]), np.array([4e-3]))[0] for place in (CORNER, (30e-3, 30e-3, 10e-3)))
    given = replace(read(1.4 * PLAIN + lumps), response=response())
    estimate = ModelBasedEstimator().estimate(given)
    assert len(estimate.inclusions) == 2
    assert estimate.factor == pytest.approx(1.4, abs=0.05)
    assert f"the readings are {estimate.factor:.3g} times those of the reference" in estimate.reason
