"""The fast forward model and the estimator on it."""

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import LAYOUT, SIZE, bell_response, cells_of_block

from tactsim.analytic.eshelby_ball import eshelby_contrast
from tactsim.errors import CaseError, InputError, InvalidQuantity
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.hypotheses import HypothesesEstimator
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.lump_response import LumpResponse

CELLS = (80, 80, 40)
RADII = np.array([2e-3, 3e-3, 4e-3, 5e-3, 6e-3])
NOISE = 1e-4
BESIDE = 0.2e-3 * np.stack(np.meshgrid([1, -1], [1, -1], [1, -1]), axis=-1).reshape(-1, 3)
"""To the cells of the grid that meet at a point on their borders."""
SURE = {"background_error": 0.0, "background_scale": 0.0, "factor_spread": 0.0}
"""A reference that is known exactly."""


@pytest.fixture(scope="module")
def response():
    return bell_response(RADII, count=CELLS, spacing=1e-3)


def readings(response, center, radius, contrast, *, seed=1, noise=NOISE):
    generator = np.random.default_rng(seed)
    plain = np.full((2, 3, 3), 0.3)
    change = contrast * response.signal(np.array([center]), np.array([radius]))[0] if contrast else 0.0
    forces, reference = (plain + part + noise * generator.standard_normal(plain.shape) for part in (change, 0.0))
    return Readings(forces, LAYOUT, SIZE, reference=reference, noise=noise, response=response)


def test_a_linear_density_gives_its_middle_times_the_volume():
    places, volumes = cells_of_block(CELLS)
    density = np.stack([np.ones(len(places)), 1 + 20 * places[:, 0]]).reshape(2, 1, 1, -1)
    response = LumpResponse.of_density(places, volumes, density, size=SIZE, radii=RADII, spacing=1e-3)
    center = np.array([[21.5e-3, 18.5e-3, 9.5e-3]])
    signal = response.signal(center, np.array([5e-3]))[0, :, 0, 0]
    volume = 4 / 3 * np.pi * 5e-3**3
    assert signal == pytest.approx([volume, volume * (1 + 20 * 21.5e-3)], rel=1e-3)


def test_a_ball_outside_the_table_is_refused(response):
    with pytest.raises(InvalidQuantity, match="outside the table"):
        response.signal(np.array([[0.0, 0.02, 0.01]]), np.array([5e-3]))


def test_contrast_of_a_small_ball_has_its_limits():
    assert eshelby_contrast(np.array([0.0, 1.0, 1e9])) == pytest.approx([-5 / 3, 0.0, 2.5], abs=1e-8)


@pytest.mark.parametrize(
    "estimator", [ModelBasedEstimator(model_error=1e-4, **SURE), HypothesesEstimator(model_error=1e-4, factor_spread=0.0)]
)
def test_no_place_is_surer_than_the_grid_that_was_tried(response, estimator):
    read = readings(response, (20.5e-3, 19.5e-3, 12.5e-3), 4e-3, 3.0, noise=1e-6)
    (body,) = estimator.estimate(read).inclusions
    cell = np.array([axis[1] - axis[0] for axis in response.axes])
    assert np.all(np.sqrt(np.diag(body.covariance)[:3]) > 0.999 * cell / np.sqrt(12))


@pytest.mark.parametrize(("center", "contrast"), [((20e-3, 20e-3, 13e-3), 2.0), ((13e-3, 26e-3, 8e-3), -1.2)])
def test_a_lump_is_found_within_its_uncertainty(response, center, contrast):
    estimate = ModelBasedEstimator(model_error=0.01, **SURE).estimate(readings(response, center, 4e-3, contrast))
    assert estimate.present
    assert estimate.probability > 0.999
    strongest = estimate.inclusions[0]
    deviations = np.sqrt(np.diag(strongest.covariance))
    assert np.all(np.abs(np.array(strongest.center) - center) < 3 * deviations[:3] + 0.5e-3)
    assert np.sign(strongest.contrast) == np.sign(contrast)
    assert abs(strongest.center[0] - (center[0] + 6e-3)) > 3 * deviations[0] + 0.5e-3
    assert any(strongest.region.contains(np.array(center) + away, 0.99) for away in BESIDE)
    assert not strongest.region.contains(np.array(center) + np.array([6e-3, 0, 0]), 0.99)


def test_more_noise_widens_the_region(response):
    widths = []
    for noise in (1e-4, 2e-3):
        estimate = ModelBasedEstimator(model_error=0.0, **SURE).estimate(
            readings(response, (20e-3, 20e-3, 12e-3), 4e-3, 2.0, noise=noise)
        )
        widths.append(np.linalg.det(estimate.inclusions[0].covariance[:3, :3]) ** (1 / 6))
    assert widths[1] > widths[0]


def test_plain_tissue_has_nothing_in_it(response):
    answers = [ModelBasedEstimator().estimate(readings(response, (0, 0, 0), 4e-3, 0.0, seed=seed)) for seed in range(20)]
    assert sum(answer.present for answer in answers) <= 1
    assert all(answer.inclusions == () for answer in answers if not answer.present)


def test_an_uncertain_reference_widens_the_region_and_hides_what_it_could_explain(response):
    given = readings(response, (20e-3, 20e-3, 12e-3), 4e-3, 4.0)
    sure, unsure = (ModelBasedEstimator(background_error=error, background_scale=0.0).estimate(given) for error in (0.0, 0.005))
    assert unsure.inclusions[0].region.sizes()[0] > sure.inclusions[0].region.sizes()[0]
    scaled = Readings(1.05 * given.reference, LAYOUT, SIZE, reference=given.reference, noise=NOISE, response=response)
    assert not ModelBasedEstimator(background_scale=0.05, background_error=0.001).estimate(scaled).present
    assert ModelBasedEstimator(**SURE).estimate(scaled).present


def test_reference_and_response_are_needed(response):
    bare = Readings(np.full((2, 3, 3), 0.3), LAYOUT, SIZE, reference=np.full((2, 3, 3), 0.3))
    with pytest.raises(InputError, match="reference"):
        ModelBasedEstimator().estimate(bare)
    with pytest.raises(InputError, match="radius"):
        ModelBasedEstimator(radii=(8e-3, 9e-3)).estimate(readings(response, (20e-3, 20e-3, 10e-3), 4e-3, 1.0))
    with pytest.raises(InputError, match="no ball of the tabulated radii fits into the block"):
        ModelBasedEstimator(gap=15e-3).estimate(readings(response, (20e-3, 20e-3, 10e-3), 4e-3, 1.0))
    with pytest.raises(CaseError, match="least radius 7 mm is above the largest 2 mm"):
        ModelBasedEstimator(radii=(7e-3, 2e-3))


@pytest.mark.parametrize(
    "estimator",
    [
        ModelBasedEstimator(),
        HypothesesEstimator(classes=("lump", "artery")),
        pytest.param(HypothesesEstimator(), marks=pytest.mark.slow),
    ],
)
def test_what_a_dead_taxel_of_the_reference_reads_is_not_looked_at(response, estimator):
    given = readings(response, (26e-3, 24e-3, 13e-3), 4e-3, 8.0)
    valid = np.ones((2, 3, 3), bool)
    valid[0, 2, 0] = valid[1, 0, 1] = False
    dead = given.reference.copy()
    dead[0, 2, 0], dead[1, 0, 1] = np.nan, 1e6
    usual, other = (estimator.estimate(replace(given, reference=each, valid=valid)) for each in (given.reference, dead))
    assert usual.present
    assert other.inclusions[0].center == usual.inclusions[0].center


def test_the_response_of_another_grasp_is_refused(response):
    given = readings(response, (20e-3, 20e-3, 10e-3), 4e-3, 1.0)
    fewer = LumpResponse(response.axes, response.radii, response.values[..., :2, :])
    with pytest.raises(InvalidQuantity, match=r"that of taxels \(2, 2, 3\).*the same grasp"):
        replace(given, response=fewer)
    with pytest.raises(InvalidQuantity, match="a block of 40 mm x 40 mm x 20 mm, the readings are of 60 mm x 60 mm x 20 mm"):
        replace(given, block_size=np.array([60e-3, 60e-3, 20e-3]))


@pytest.mark.parametrize("estimator", [ModelBasedEstimator(), HypothesesEstimator(), HypothesesEstimator(factor_spread=0)])
def test_invalid_taxels_count_as_little_as_taxels_that_are_not_there(estimator):
    """Their readings, interpolated, are no evidence: a column of invalid taxels is a matrix without it."""
    response = bell_response(RADII)
    given = readings(response, (22e-3, 24e-3, 13e-3), 4e-3, 5.0, noise=1e-3)
    without = Readings(
        given.forces[..., :2],
        LAYOUT.model_copy(update={"columns": 2}),
        SIZE,
        reference=given.reference[..., :2],
        noise=given.noise,
        middle=SIZE[:2] / 2 - [LAYOUT.pitch / 2, 0.0],
        response=LumpResponse(response.axes, response.radii, response.values[..., :2]),
    )
    valid = np.broadcast_to([True, True, False], (2, 3, 3))
    dead, fewer = (estimator.estimate(each) for each in (replace(given, valid=valid), without))
    assert dead.present
    assert dead.probability == pytest.approx(fewer.probability, rel=1e-9)
    for one, other in zip(dead.inclusions, fewer.inclusions, strict=True):
        np.testing.assert_allclose(one.center, other.center, rtol=1e-9)
        np.testing.assert_allclose(one.covariance, other.covariance, rtol=1e-6, atol=1e-18)


def test_the_region_of_a_lump_under_a_dead_taxel_holds_it_as_often_as_it_says():
    response, estimator = bell_response(RADII), ModelBasedEstimator(**SURE, model_error=0.0, second=0.0)
    valid = np.ones((2, 3, 3), bool)
    valid[0, 1, 1] = False
    places = np.random.default_rng(5).uniform([15e-3, 15e-3, 8e-3], [25e-3, 25e-3, 14e-3], (60, 3))
    held = 0
    for seed, place in enumerate(places):
        given = readings(response, place, 4e-3, 3.0, seed=seed, noise=2e-3)
        held += estimator.estimate(replace(given, valid=valid)).inclusions[0].region.contains(place)
    assert held >= 46  # less once in a hundred times, of sixty with 0.9 each
