"""One place is not stated where two explain the readings better, and two are not where one does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import LAYOUT, SIZE, plain_forces, response

from tactsim.interfaces.readings import Readings, TissueResponse
from tactsim.localization.estimators.any_estimator import offered_estimators
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.localization.separate_places import PROMINENCE, nearest_peak, separate_peaks

TWO_LUMPS = np.array(
    [
        [[0.8055, 0.3156, 0.2786], [0.3216, 0.3702, 0.3541], [0.2787, 0.3554, 0.6065]],
        [[0.6037, 0.3582, 0.2831], [0.3624, 0.37, 0.3205], [0.2798, 0.3195, 0.7986]],
    ]
)
"""What cases/grasp_two_lumps.yaml read in N on tetrahedra: balls at (10, 10, 12) and (30, 30, 8) mm."""
PLAIN = np.array(
    [
        [[0.2692, 0.3044, 0.2681], [0.3049, 0.345, 0.3051], [0.27, 0.3066, 0.268]],
        [[0.2718, 0.3066, 0.271], [0.3072, 0.3449, 0.3026], [0.2679, 0.3045, 0.2706]],
    ]
)
"""The same block without them, on like tetrahedra."""
PLACES = np.array([[10e-3, 10e-3, 12e-3], [30e-3, 30e-3, 8e-3]])
OFFERED = offered_estimators()
DIFFERENCES = [name for name, one in OFFERED.items() if one.needs_reference and not one.gives_classes]


@pytest.fixture(scope="module")
def table() -> TissueResponse:
    return response()


def readings(table: TissueResponse, places: np.ndarray, *, radius: float = 4e-3, seed: int = 1) -> Readings:
    """Balls that act alike in plain tissue, by the fast forward model, with noise."""
    generator = np.random.default_rng(seed)
    plain = plain_forces(np.array([1e-3]))[0]
    change = 5.0 * table.signal(np.asarray(places), np.full(len(places), radius)).sum(axis=0)
    noise = 1e-3 * generator.standard_normal((2, *plain.shape))
    return Readings(plain + change + noise[0], LAYOUT, SIZE, reference=plain + noise[1], noise=1e-3, response=table)


def test_maxima_are_told_apart_by_the_saddle_between_them():
    sums = np.array([[5.0, 1.0, 0.0, 0.0], [1.0, 2.0, 1.0, 3.0], [0.0, 2.5, 0.0, 1.0]])
    # from 3 at (2, 4) the way leads over 1 to 2 and 5; from 2.5 at (3, 2) over 2
    assert separate_peaks(sums, 0.4) == [(0, 0), (1, 3), (2, 1)]
    assert separate_peaks(sums, 0.6) == [(0, 0), (1, 3)]
    assert separate_peaks(sums, 2.1) == [(0, 0)]
    assert separate_peaks(np.ones((3, 3)), 0.0) == [(0, 0)]
    assert separate_peaks(np.array([[1.0]]), 0.0) == [(0, 0)]
    assert nearest_peak((1, 5), [(0, 0), (0, 4)]).tolist() == [[0, 0, 0, 1, 1]]


@pytest.mark.parametrize("name", ["thesis", "thesis with reference"])
def test_the_two_balls_of_the_shipped_case_are_two_places(name):
    given = Readings(TWO_LUMPS, LAYOUT, SIZE, reference=PLAIN, noise=0.01)
    found = OFFERED[name].estimate(given)
    assert found.reason.startswith("2 places explain the readings better than one")
    centers = np.array([one.center for one in found.inclusions])
    for place in PLACES:
        assert np.linalg.norm(centers - place, axis=1).min() < 2.5e-3
    between = np.linalg.norm(centers - PLACES.mean(axis=0), axis=1)
    assert between.min() > 10e-3, "nothing is in the middle, where the centroid of both lies"


def test_two_balls_are_two_places_to_whoever_takes_a_reference(table):
    given = readings(table, PLACES)
    for name in DIFFERENCES:
        found = OFFERED[name].estimate(given)
        assert len(found.inclusions) == 2, name
        assert "better than one" in found.reason
        centers = np.array([one.center for one in found.inclusions])
        assert max(np.linalg.norm(centers[:, :2] - place[:2], axis=1).min() for place in PLACES) < LAYOUT.pitch / 2
    alone = ModelBasedEstimator(second=0.0).estimate(given)
    assert len(alone.inclusions) == 1


def test_one_place_says_that_two_nearer_than_the_taxels_explain_the_readings_better(table):
    """The one ball lay between both, with a probability of 1 and without a word of the pair, which was found and left out.

    Of six noises one hides the pair: errors of 5 % are less than what a pair on the grid of candidates may differ from the true
    one.
    """
    near = np.array([[16e-3, 20e-3, 12e-3], [24e-3, 20e-3, 12e-3]])
    estimator = ModelBasedEstimator(model_error=0.05, background_error=0.0)
    found = [estimator.estimate(readings(table, near, seed=seed)) for seed in range(1, 7)]
    assert all(len(one.inclusions) == 1 for one in found)
    assert sum("though two balls explain the readings better than one" in one.reason for one in found) >= 4
    assert "better" not in estimator.estimate(readings(table, near[:1])).reason


def test_one_ball_is_one_place_wherever_it_lies(table):
    generator = np.random.default_rng(2)
    for seed in range(12):
        place = generator.uniform([8e-3, 8e-3, 6e-3], [32e-3, 32e-3, 14e-3])
        given = readings(table, place[None], radius=float(generator.choice([3e-3, 4e-3, 5e-3])), seed=seed)
        for name in ("thesis", *DIFFERENCES):
            found = OFFERED[name].estimate(given)
            assert len(found.inclusions) <= 1, (name, place)
            assert "better" not in found.reason, (name, place)


def test_no_single_ball_of_the_forward_model_makes_a_second_maximum(table):
    for radius, values in zip(table.radii, table.values, strict=True):
        inside = [np.abs(axis - side / 2) < side / 2 - radius for axis, side in zip(table.axes, SIZE, strict=True)]
        sums = values[np.ix_(*inside)][::2, ::2, ::2].sum(axis=3).reshape(-1, *values.shape[-2:])
        assert all(len(separate_peaks(one, PROMINENCE * one.max())) == 1 for one in sums)


def test_the_noise_makes_no_second_place():
    peaked = np.zeros((2, 3, 3))
    peaked[:, 0, 0], peaked[:, 2, 2] = 30e-3, 4e-3
    quiet = Readings(PLAIN + peaked, LAYOUT, SIZE, reference=PLAIN, noise=0.1e-3)
    estimator = ThesisEstimator(background="reference")
    assert len(estimator.estimate(quiet).inclusions) == 1, "below the share that a single lump may make"
    peaked[:, 2, 2] = 12e-3
    assert len(estimator.estimate(replace(quiet, forces=PLAIN + peaked)).inclusions) == 2
    loud = replace(quiet, forces=PLAIN + peaked, noise=4e-3)
    assert len(estimator.estimate(loud).inclusions) == 1, "four standard deviations of the sums are 32 mN, more than its 24 mN"
