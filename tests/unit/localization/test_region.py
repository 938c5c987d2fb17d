"""Regions of highest density: what they hold and how large they are."""

import numpy as np
import pytest
from scipy.stats import chi2, multivariate_normal

from tactsim.errors import InvalidQuantity
from tactsim.localization.region import CellRegion, GaussianRegion, OutlinedRegion, shadows

AXES = tuple((np.arange(n) + 0.5) * 1e-3 for n in (20, 20, 10))
MEAN = np.array([10e-3, 9e-3, 5e-3])
COVARIANCE = np.diag([2e-3, 1e-3, 1.5e-3]) ** 2


def cells():
    places = np.stack(np.meshgrid(*AXES, indexing="ij"), axis=-1)
    return CellRegion(AXES, multivariate_normal(MEAN, COVARIANCE).pdf(places))


@pytest.mark.parametrize("probability", [0.5, 0.9])
def test_gaussian_regions_hold_their_share_of_draws(probability):
    draws = np.random.default_rng(2).multivariate_normal(MEAN, COVARIANCE, 1000)
    held = np.mean([GaussianRegion(MEAN, COVARIANCE).contains(point, probability) for point in draws])
    assert held == pytest.approx(probability, abs=0.045)  # three standard deviations of 1000 draws
    narrow = np.mean([GaussianRegion(MEAN, COVARIANCE / 2).contains(point, probability) for point in draws])
    assert narrow != pytest.approx(probability, abs=0.1)


def test_cells_of_a_gaussian_agree_with_its_ellipsoid():
    region = cells()
    assert region.weights[region.inside(0.9)].sum() == pytest.approx(0.9, abs=0.01)
    exact = GaussianRegion(MEAN, COVARIANCE)
    width, height = region.sizes()
    assert width == pytest.approx(exact.sizes()[0], rel=0.1)  # cells of 1 mm
    assert height == pytest.approx(exact.sizes()[1], abs=1e-3)
    assert region.contains(MEAN)
    assert not region.contains(MEAN + np.array([6e-3, 0, 0]))
    assert not region.contains(np.array([-1e-3, 9e-3, 5e-3]))


def test_a_sure_region_is_one_cell():
    weights = np.zeros((20, 20, 10))
    weights[3, 4, 5] = 2.0
    region = CellRegion(AXES, weights)
    assert region.inside().sum() == 1
    assert region.contains([3.9e-3, 4.1e-3, 5.5e-3])
    assert not region.contains([4.1e-3, 4.1e-3, 5.5e-3])


@pytest.mark.parametrize("away", [0, 1, 2])
def test_shadows_of_cells_and_ellipsoid_have_the_same_extent(away):
    exact, computed = (region.shadow(away) for region in (GaussianRegion(MEAN, COVARIANCE), cells()))
    assert len(exact) == len(computed) == 1
    for line in (*exact, *computed):
        np.testing.assert_allclose(line[0], line[-1], atol=1e-12)  # closed
    widths = np.ptp(exact[0], axis=0)
    across = [k for k in range(3) if k != away]
    np.testing.assert_allclose(widths, 2 * np.sqrt(chi2.ppf(0.9, 3)) * np.sqrt(np.diag(COVARIANCE))[across], rtol=1e-2)
    np.testing.assert_allclose(np.ptp(computed[0], axis=0), widths, atol=1.01e-3)  # cells of 1 mm
    np.testing.assert_allclose(computed[0].mean(axis=0), MEAN[across], atol=0.5e-3)


def test_the_shadow_of_a_region_at_the_rim_of_the_grid_is_closed():
    weights = np.zeros((20, 20, 10))
    weights[0, 0, 0] = 1.0
    (line,) = CellRegion(AXES, weights).shadow(2)
    np.testing.assert_allclose(line[0], line[-1])
    assert shadows(CellRegion(AXES, weights)).keys() == {"front", "left", "top"}


def test_what_is_no_region_is_refused():
    for weights in (np.zeros((20, 20, 10)), -np.ones((20, 20, 10)), np.ones((2, 2, 2)), np.full((20, 20, 10), np.nan)):
        with pytest.raises(InvalidQuantity):
            CellRegion(AXES, weights)
    with pytest.raises(InvalidQuantity, match="positive definite"):
        GaussianRegion(MEAN, np.diag([1.0, 1.0, 0.0]))
    with pytest.raises(InvalidQuantity, match="probability"):
        GaussianRegion(MEAN, COVARIANCE).sizes(1.0)


def test_a_kept_region_is_the_one_that_was_written():
    mean, spread = np.array([12e-3, 20e-3, 9e-3]), np.diag([1e-3, 2e-3, 1.5e-3]) ** 2
    whole = GaussianRegion(mean, spread)
    kept = OutlinedRegion({view: [np.array(line) for line in lines] for view, lines in shadows(whole).items()})
    np.testing.assert_allclose(kept.sizes(), whole.sizes(), rtol=0.01)  # of a polygon of 48 corners instead of an ellipse
    for away in range(3):
        np.testing.assert_allclose(kept.shadow(away), whole.shadow(away))
    assert kept.contains(mean)
    reach = 2.5 * np.sqrt(np.diag(spread))  # root of the 90 % quantile of chi-squared with three degrees of freedom
    for axis in range(3):
        for share, inside in ((0.95, True), (1.05, False)):
            point = mean.copy()
            point[axis] += share * reach[axis]
            assert kept.contains(point) is inside
    with pytest.raises(InvalidQuantity, match=r"known: 0\.9"):
        kept.contains(mean, 0.5)


@pytest.mark.parametrize("layers", [[1, 2, 6], [1, 2, 3], [0, 4, 8]])
def test_what_lies_between_the_parts_of_a_region_adds_nothing_to_its_height_kept_or_not(layers):
    """The whole extent was the height of a kept region, that of the layers that hold cells of it the height of the other."""
    weights = np.zeros((6, 6, 9))
    weights[2:4, 2:4, layers] = 1.0
    whole = CellRegion(tuple(np.arange(count) * 1e-3 for count in weights.shape), weights)
    assert whole.sizes()[1] == pytest.approx(3e-3)
    assert OutlinedRegion(shadows(whole)).sizes()[1] == pytest.approx(3e-3)


def test_a_hole_of_a_kept_region_does_not_count():
    """The hole was added to the plan instead of taken from it."""
    axes = tuple(np.arange(count) * 1e-3 for count in (12, 12, 2))
    weights = np.zeros((12, 12, 2))
    weights[1:11, 1:11], weights[3:9, 3:9] = 1.0, 0.0
    whole = CellRegion(axes, weights)
    kept = OutlinedRegion(shadows(whole))
    assert len(kept.shadow(2)) == 2
    np.testing.assert_allclose(kept.sizes()[0], whole.sizes()[0], rtol=0.01)  # outlines cut the corners of cells
