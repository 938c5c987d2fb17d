"""The smallest lump found: its statistics against exact ones, and the map on a made-up response."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from pydantic import ValidationError
from scenes import cut_words, unmarked_figures
from scipy.special import ndtri
from scipy.stats import ncx2

from tactsim.experiments.localization import detectability, lump_sensitivity
from tactsim.experiments.localization.detectability import COARSE, Detectability
from tactsim.experiments.localization.detectability_statistics import (
    detection_probability,
    false_alarm_threshold,
    smallest_radius,
    unit_templates,
)
from tactsim.experiments.localization.figures.detectability import DetectabilityFigures, _name_curves
from tactsim.localization.lump_response import LumpResponse
from tactsim.plotting import figures_for

RADII = np.array([2e-3, 4e-3, 6e-3, 8e-3])


def test_one_template_has_the_threshold_of_a_normal_number():
    threshold = false_alarm_threshold(np.eye(4)[:1], 0.05, draws=200_000, seed=1)
    assert threshold == pytest.approx(ndtri(0.975), abs=0.02)  # scatter of 200 000 draws


def test_independent_templates_raise_the_threshold():
    threshold = false_alarm_threshold(np.eye(10), 0.05, draws=100_000, seed=1)
    exact = ndtri(1 - (1 - 0.95 ** (1 / 10)) / 2)
    assert threshold == pytest.approx(exact, abs=0.03)


def test_power_is_that_of_the_noncentral_chi_square():
    match = np.array([0.0, 1.0, 3.0, 5.0])
    exact = ncx2.sf(3.0**2, 1, np.maximum(match, 1e-12) ** 2)
    assert detection_probability(match, 3.0) == pytest.approx(exact, rel=1e-8)


def test_the_smallest_radius_of_a_constant_density_is_exact():
    densities, sigma, threshold = np.full((1, 4), 1e6), 0.04, 3.0
    computed = smallest_radius(densities, RADII, 8e-3, contrast=2.0, sigma=sigma, threshold=threshold, wanted=0.9)
    match = threshold + ndtri(0.9)  # the other tail is below 1e-12
    exact = (match * sigma / (2.0 * 1e6) / (4 / 3 * np.pi)) ** (1 / 3)
    assert computed == pytest.approx(exact, abs=2e-7)


def test_no_radius_is_null():
    sought = {"contrast": 1.0, "sigma": 1.0, "threshold": 3.0, "wanted": 0.9}
    assert smallest_radius(np.full((1, 4), 1e3), RADII, 8e-3, **sought) is None
    assert smallest_radius(np.full((1, 4), 1e9), RADII, -1e-3, **sought) is None


def made_up(setup):
    """More taxels see the same in smaller parts, the less the farther they are."""
    count = setup.matrix.rows
    size = np.array(setup.block.size)
    axes = tuple((np.arange(n) + 0.5) * side / n for n, side in zip((6, 6, 10), size, strict=True))
    x, y, z = np.meshgrid(*axes, indexing="ij")
    places = [edges.mean(axis=1) + size[0] / 2 for edges in (setup.matrix.borders("x"), setup.matrix.borders("y"))]
    away = (x[..., None, None] - places[0]) ** 2 + (y[..., None, None] - places[1][:, None]) ** 2
    near = [np.exp(-away / 1e-4) * np.exp(-depth / 5e-3)[..., None, None] for depth in (size[2] - z, z)]
    shape = np.stack(near, axis=3) * 9 / count**2
    volumes = 4 / 3 * np.pi * RADII**3
    return LumpResponse(axes, RADII, 1e6 * volumes[:, None, None, None, None, None, None] * shape)


@pytest.fixture
def run(monkeypatch):
    monkeypatch.setattr(detectability, "kept_response", lambda setup, compute, how: made_up(setup))

    def run(**changes):
        example = Detectability.example()
        return Detectability.model_validate({**example.model_dump(), "draws": 400, "matrices": (3, 6), **changes})

    return run


def test_the_map_is_symmetric_and_deeper_lumps_are_harder_to_find(run):
    result = run(depths=(4e-3, 7e-3, 10e-3, 13e-3, 16e-3), shear_ratios=(1.8, 100.0)).run()
    radii = np.array(result.quantities["smallest_radius"].value, dtype=float)
    assert radii.shape == (2, 2, 5)
    np.testing.assert_allclose(radii, radii[..., ::-1], rtol=1e-4)
    assert np.nanmax(radii[1, 0]) == radii[1, 0, 2]
    assert np.all(radii[1, 0] < np.where(np.isnan(radii[0, 0]), np.inf, radii[0, 0]))
    scaled = np.array(result.quantities["smallest_radius_by_area"].value, dtype=float)
    np.testing.assert_allclose(scaled[:, 0], radii[:, 0])
    assert np.all(scaled[1, 1, 1:-1] < radii[1, 1, 1:-1])


def test_less_noise_finds_smaller_lumps(run):
    first, second = (
        np.array(run(noise=noise, depths=(5e-3,)).run().quantities["smallest_radius"].value, dtype=float)
        for noise in (0.02, 0.002)
    )
    assert np.all(second[1] < first[1])


def test_the_order_of_the_matrices_does_not_matter(run):
    coarse_first, fine_first = (
        np.array(run(matrices=matrices, depths=(5e-3,)).run().quantities["smallest_radius"].value, dtype=float)
        for matrices in ((3, 6), (6, 3))
    )
    np.testing.assert_array_equal(fine_first[:, ::-1], coarse_first)


def test_what_is_not_found_is_null_and_the_figure_is_drawn(run):
    result = run(noise=50.0, depths=(3e-3, 10e-3)).run()
    assert result.quantities["smallest_radius"].value[0][0] == [None, None]
    assert figures_for(result)["detectability.png"]()[:4] == b"\x89PNG"
    assert unmarked_figures(result) == []
    assert cut_words(result.plot()) == []
    some = run(depths=(3e-3, 6e-3, 10e-3)).run()
    axes = DetectabilityFigures().figure(some).axes
    lines = [line for line in axes[0].lines if len(line.get_xdata())]
    expected = np.array(some.quantities["smallest_radius"].value, dtype=float)
    np.testing.assert_allclose(lines[0].get_ydata(), 1e3 * expected[0, 0])
    np.testing.assert_allclose(lines[0].get_xdata(), [3, 6, 10])
    curves = [line for axis in axes for line in axis.lines]
    assert max(np.nanmax(line.get_ydata(), initial=0.0) for line in curves) < axes[0].get_ylim()[1], "both panels have one scale"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"depths": (25e-3,)}, "outside the block"),
        ({"shear_ratios": (1.0,)}, "plain tissue"),
        ({"side": 60e-3}, "wider than the block"),
        ({"false_alarms": 1e-4}, "at least 100000, or a higher rate"),
        ({"draws": 199}, "at least 200, or a higher rate"),
    ],
)
def test_impossible_questions_are_refused(change, words):
    with pytest.raises(ValidationError, match=words):
        Detectability.model_validate({**Detectability.example().model_dump(), **change})


def test_templates_have_unit_length_and_leave_out_what_nothing_feels():
    response = made_up(Detectability.example().grasp)
    assert np.linalg.norm(unit_templates(response, 2), axis=1) == pytest.approx(1.0)


def test_the_response_does_not_depend_on_its_parts(monkeypatch):
    points = np.random.default_rng(1).random((500, 3)) * [40e-3, 40e-3, 20e-3]
    densities = np.random.default_rng(2).random((2, 3, 3, 500))
    adjoint = lump_sensitivity.Sensitivity(points, np.full(500, 6.4e-8), densities, np.zeros((2, 3, 3)))
    monkeypatch.setattr(lump_sensitivity, "sensitivity", lambda setup: adjoint)
    setup = Detectability.example().grasp
    whole = lump_sensitivity.lump_response(setup, COARSE)
    monkeypatch.setattr(lump_sensitivity, "ROWS_AT_ONCE", 5)
    np.testing.assert_array_equal(lump_sensitivity.lump_response(setup, COARSE).values, whole.values)
    assert whole.values.shape[-3:] == (2, 3, 3)


@pytest.mark.parametrize("size", [(40e-3, 40e-3, 20e-3), (4e-3, 4e-3, 2e-3), (40e-3, 40e-3, 2.5e-3), (0.2, 0.2, 0.1)])
def test_balls_of_any_block_are_tabulated_at_a_bounded_number_of_centres(size):
    balls = lump_sensitivity.FINE
    radii, spacing = balls.radii_in(size), balls.spacing_in(size)
    assert len(radii) >= 10
    assert 2 * radii[-1] < min(size)
    assert np.prod(np.ceil(np.array(size) / spacing - 1e-9)) <= 1.2 * balls.most_centres


def test_words_of_a_single_point_keep_clear_of_the_point_above_it():
    """Two curves of which one depth each is known, one just above the other."""
    axis = Figure().add_subplot()
    axis.set(xlim=(0.0, 20.0), ylim=(0.0, 10.0))
    radii = np.full((1, 2, 3), np.nan)
    radii[0, :, 1] = 8.7e-3, 9.1e-3
    values = {"depths": np.array([5e-3, 10e-3, 15e-3]), "matrices": [3, 16], "shear_ratios": [100.0]}
    _name_curves(axis, radii, values, np.zeros((2, 4)))
    boxes = [text.get_window_extent() for text in axis.texts]
    points = axis.transData.transform([(10.0, 8.7), (10.0, 9.1)])
    assert len(boxes) == 2
    assert not any(box.contains(*point) for box in boxes for point in points)
    assert not boxes[0].overlaps(boxes[1])
