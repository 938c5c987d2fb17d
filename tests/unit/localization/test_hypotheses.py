"""Candidates, evidence, and the estimator that distinguishes one lump, two lumps, an artery and nothing."""

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import LAYOUT, SIZE, bell_response
from mutants import assert_kills

from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.localization.confusion import ConfusionTable, class_of, estimated_class
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.localization.candidates import Candidates, ball_candidates, tube_candidates
from tactsim.localization.estimators.hypotheses import CLASSES, HypothesesEstimator
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.evidence import Change
from tactsim.localization.lump_response import LumpResponse

RADII = np.array([2.5e-3, 3.5e-3, 4.5e-3, 5.5e-3])
NOISE = 2e-3
ESTIMATOR = HypothesesEstimator(model_error=0.02, radii=(2.5e-3, 4.5e-3), tube_radii=(2.5e-3, 4.5e-3))
GAP = 0.5e-3


@pytest.fixture(scope="module")
def response():
    return bell_response(RADII)


def readings(response, change, *, seed=1, noise=NOISE, known=True):
    generator = np.random.default_rng(seed)
    forces, reference = (0.3 + part + noise * generator.standard_normal((2, 3, 3)) for part in (change, 0.0))
    return Readings(forces, LAYOUT, SIZE, reference=reference if known else None, noise=noise, response=response)


def balls(response, *centers, radius=4e-3, contrast=3.0):
    return contrast * response.signal(np.array(centers), np.full(len(centers), radius)).sum(axis=0)


def tube(response, *, angle=0, height=12e-3, contrast=3.0):
    candidates = tube_candidates(response, SIZE, [3e-3], gap=GAP, closed=False)
    tubes = candidates.geometry
    direction = (tubes.ends - tubes.begins)[:, :2]
    wanted = np.array([np.cos(angle), np.sin(angle)])
    along = np.abs(direction @ wanted) / np.linalg.norm(direction, axis=1) > 1 - 1e-9
    off = np.linalg.norm(tubes.centers[:, :2] - 20e-3, axis=1) + np.abs(tubes.centers[:, 2] - height) + 1.0 * ~along
    number = int(off.argmin())
    return contrast * candidates.signals[number].reshape(2, 3, 3), tubes.centers[number], tubes.radii[number]


def test_a_tube_is_the_integral_of_a_constant_density_over_it():
    flat = bell_response(RADII, lambda places: np.ones((1, 1, 1, len(places))))
    candidates = tube_candidates(flat, SIZE, [3e-3], gap=GAP, closed=True)
    centers = candidates.geometry.centers
    middle = np.abs(centers[:, 2] - 10e-3).argmin()
    inner = np.linalg.norm(centers[:, :2] - 20e-3, axis=1) < 5e-3
    chosen = candidates.chosen(inner & (centers[:, 2] == centers[middle, 2]))
    tubes = chosen.geometry
    volumes = np.pi * tubes.radii**2 * np.linalg.norm(tubes.ends - tubes.begins, axis=1)
    # the ends lose up to 0.35 of the radius of the ball, and a cut tube gains as much at neither end
    assert chosen.signals[:, 0] == pytest.approx(volumes, rel=0.1)


def test_overlapping_bodies_are_reported():
    response = bell_response(RADII)
    balls = ball_candidates(response, SIZE, [2.5e-3], gap=GAP).geometry
    one = int(np.linalg.norm(balls.centers - SIZE / 2, axis=1).argmin())
    away = np.linalg.norm(balls.centers - balls.centers[one], axis=1)
    np.testing.assert_array_equal(balls.overlaps(one), away < 5e-3)
    tubes = tube_candidates(response, SIZE, [2.5e-3], gap=GAP, closed=False, spacing=4e-3).geometry
    along = np.abs(tubes.begins[:, 1] - tubes.ends[:, 1]) < 1e-9
    level = tubes.begins[:, 2] == tubes.begins[0, 2]
    parallel = np.flatnonzero(along & level)
    meets = tubes.overlaps(int(parallel[0]))
    apart = np.abs(tubes.begins[parallel, 1] - tubes.begins[parallel[0], 1])
    np.testing.assert_array_equal(meets[parallel], apart < 2 * tubes.radii[0])
    assert meets[np.flatnonzero(level & ~along)].any()
    for bodies in (balls, tubes):
        some = np.arange(0, len(bodies), 7)
        np.testing.assert_array_equal(bodies.overlaps(some), [bodies.overlaps(int(k)) for k in some])


def over_noise(candidates: Candidates, noise: float) -> Candidates:
    """The candidates with their signals over a standard deviation in N of the readings."""
    return replace(candidates, signals=candidates.signals / noise)


def test_single_evidence_is_that_of_the_joint_normal_distribution(response):
    candidates = over_noise(ball_candidates(response, SIZE, [3.5e-3], gap=GAP).chosen(np.array([100])), 0.02)
    values = np.random.default_rng(3).standard_normal(18)
    change = Change(values, 2.0)
    covariance = np.eye(18) + 4.0 * np.outer(candidates.signals[0], candidates.signals[0])
    exact = -(values @ np.linalg.solve(covariance, values) + np.linalg.slogdet(covariance)[1]) / 2
    assert change.single(candidates).evidence == pytest.approx(exact, rel=1e-10)


def some_tubes(response):
    """Tubes at two heights, of which most at one height cross each other."""
    tubes = tube_candidates(response, SIZE, [3.5e-3], gap=GAP, closed=False, spacing=6e-3)
    heights = np.unique(tubes.geometry.begins[:, 2])
    return tubes.chosen(np.isin(tubes.geometry.begins[:, 2], heights[[1, -2]]))


@pytest.mark.parametrize("kind", ["balls", "tubes"])
def test_the_evidence_of_pairs_is_their_mean_over_all(response, kind):
    """Over all pairs that there are: those that overlap are none, and the mutant counts them as pairs that explain nothing."""
    few = ball_candidates(response, SIZE, [4.5e-3], gap=GAP, every=3) if kind == "balls" else some_tubes(response)
    candidates = over_noise(few, 0.05)
    values = balls(response, (11e-3, 11e-3, 12e-3), (29e-3, 29e-3, 8e-3)).ravel() / 0.05
    change = Change(values, 5.0)
    exact = []
    for i in range(len(candidates)):
        pairs = candidates.signals[i][:, None] * candidates.signals[i] + np.eye(18) / 25
        base = 25 * pairs
        for j in np.flatnonzero(~candidates.geometry.overlaps(i)):
            covariance = base + 25 * np.outer(candidates.signals[j], candidates.signals[j])
            exact.append(-(values @ np.linalg.solve(covariance, values) + np.linalg.slogdet(covariance)[1]) / 2)
    largest = max(exact)
    mean = largest + np.log(np.exp(np.array(exact) - largest).mean())

    def check(evidence):
        assert evidence == pytest.approx(mean, abs=0.2)  # scatter of 32 draws

    sampled = [change.double(candidates, candidates, np.random.default_rng(seed)).evidence for seed in range(4)]
    check(np.mean(sampled))
    if kind == "tubes":
        assert_kills(check, overlapping=(np.mean(sampled) + np.log(len(exact) / len(candidates) ** 2),))


CUBE = np.full(3, 22e-3)


def response_of_cube():
    """Any numbers, at centres 2 mm apart."""
    line, radii = (np.arange(11) + 0.5) * 2e-3, np.array([5e-3, 7e-3])
    values = np.random.default_rng(1).standard_normal((2, 11, 11, 11, 2, 3, 3))
    return LumpResponse((line, line, line), radii, 0.02 * values)


@pytest.mark.parametrize("every", [1, 3, 4, 6])
def test_pairs_are_sought_in_a_block_with_hardly_any_room_for_two(every):
    """Two balls of 5 mm fit into opposite corners, where the coarse grid may have none; two of 7 mm do not."""
    cube, change = response_of_cube(), Change(np.random.default_rng(3).standard_normal(18), 5.0)
    for radius, exists in ((5e-3, True), (7e-3, False)):
        fine, coarse = (ball_candidates(cube, CUBE, [radius], gap=GAP, every=step) for step in (1, every))
        assert np.isfinite(change.double(fine, coarse, np.random.default_rng(1)).evidence) == exists


@pytest.mark.parametrize("kind", [HypothesesEstimator, ModelBasedEstimator])
def test_a_block_without_room_for_two_has_one(kind):
    layout = LAYOUT.model_copy(update={"pitch": 6e-3, "size": 5e-3})
    forces = 0.3 + 0.1 * np.random.default_rng(2).standard_normal((2, 2, 3, 3))
    given = Readings(forces[0], layout, CUBE, reference=forces[1], noise=NOISE, response=response_of_cube())
    alone = {"classes": ("lump", "two_lumps")} if kind is HypothesesEstimator else {}
    estimate = kind(radii=(7e-3, 7e-3), **alone).estimate(given)
    assert len(estimate.inclusions) == 1
    assert (estimate.classes or {"two_lumps": 0.0})["two_lumps"] == 0


@pytest.mark.parametrize("name", ["none", "lump", "two_lumps", "artery"])
def test_classes_are_distinguished(response, name):
    changes = {
        "none": np.zeros((2, 3, 3)),
        "lump": balls(response, (15e-3, 25e-3, 11e-3)),
        "two_lumps": balls(response, (11e-3, 11e-3, 12e-3), (29e-3, 29e-3, 8e-3)),
        "artery": tube(response, angle=np.pi / 6)[0],
    }
    estimate = ESTIMATOR.estimate(readings(response, changes[name]))
    assert estimated_class(estimate) == name
    assert estimate.classes[name] > 0.5
    assert sum(estimate.classes.values()) == pytest.approx(1.0)
    assert estimate.probability == pytest.approx(1 - estimate.classes["none"], abs=1e-9)
    assert len(estimate.inclusions) == {"none": 0, "lump": 1, "two_lumps": 2, "artery": 1}[name]
    wrong = ESTIMATOR.model_copy(update={"classes": ("lump",)}).estimate(readings(response, changes["two_lumps"]))
    assert estimated_class(wrong) == "lump"


def test_two_lumps_lie_where_they_are(response):
    places = np.array([(11e-3, 11e-3, 12e-3), (29e-3, 29e-3, 8e-3)])
    estimate = ESTIMATOR.estimate(readings(response, balls(response, *places)))
    centers = np.array([one.center for one in estimate.inclusions])
    order = np.argsort(centers[:, 0])
    for center, body, place in zip(centers[order], np.array(estimate.inclusions)[order], places, strict=True):
        reach = 3 * np.sqrt(np.diag(body.covariance)[:3]) + 1.5e-3
        assert np.all(np.abs(center - place) < reach)
        assert not np.all(np.abs(center - (places.sum(axis=0) - place)) < reach)
        assert body.region.contains(place, 0.99)
        assert not body.region.contains(places.sum(axis=0) - place, 0.99)


@pytest.mark.parametrize("contrast", [3.0, -1.2])
def test_a_tube_has_its_line_and_sign(response, contrast):
    change, center, radius = tube(response, angle=np.pi / 2, contrast=contrast)
    strongest = ESTIMATOR.estimate(readings(response, change, noise=5e-4)).inclusions[0]
    assert strongest.kind == "tube"
    assert np.sign(strongest.contrast) == np.sign(contrast)
    line = np.array(strongest.line)
    assert abs(line[0, 0] - line[1, 0]) < 1e-9
    assert abs(strongest.center[0] - center[0]) < 1.5e-3
    assert abs(strongest.radius - radius) < 2e-3


def test_the_same_seed_gives_the_same_estimate(response):
    given = readings(response, balls(response, (11e-3, 11e-3, 12e-3), (29e-3, 29e-3, 8e-3)))
    lumps = ESTIMATOR.model_copy(update={"classes": ("lump", "two_lumps")})
    first, again = (lumps.estimate(given).classes for _ in range(2))
    assert first == again
    other = lumps.model_copy(update={"seed": 2}).estimate(given).classes
    assert other != first
    assert other == pytest.approx(first, abs=0.05)


def test_reference_and_response_are_needed(response):
    with pytest.raises(InputError, match="reference"):
        ESTIMATOR.estimate(readings(response, np.zeros((2, 3, 3)), known=False))
    large = ESTIMATOR.model_copy(update={"gap": 9.9e-3})
    with pytest.raises(InputError, match="fits into the block"):
        large.estimate(readings(response, np.zeros((2, 3, 3))))
    for beyond in ({"radii": (9e-3, 12e-3)}, {"tube_radii": (9e-3, 12e-3), "classes": ("artery",)}):
        with pytest.raises(InputError, match="no tabulated radius lies between 9 mm and 12 mm; the response of the tissue knows"):
            ESTIMATOR.model_copy(update=beyond).estimate(readings(response, np.zeros((2, 3, 3))))


def test_readings_equal_to_the_reference_without_noise_hold_nothing(response):
    estimate = ESTIMATOR.estimate(readings(response, np.zeros((2, 3, 3)), noise=0.0))
    assert not estimate.present
    assert estimate.classes == dict.fromkeys(CLASSES, 0.0) | {"none": 1.0}


@pytest.mark.parametrize("noise", [0.0, 1e-9])
def test_what_a_solver_leaves_of_a_change_has_probabilities(response, noise):
    """Over so small errors the signals of a pair are parallel to rounding, and its determinant can come out as nought."""
    left = 1e-9 * np.random.default_rng(3).standard_normal((2, 3, 3))
    given = replace(readings(response, left, noise=0.0), noise=noise)
    estimate = HypothesesEstimator(radii=(2.5e-3, 4.5e-3), tube_radii=(2.5e-3, 4.5e-3)).estimate(given)
    assert np.isfinite(list(estimate.classes.values())).all()


@pytest.mark.parametrize(
    "estimator", [HypothesesEstimator(model_error=0.0), ModelBasedEstimator(model_error=0, background_error=0)]
)
def test_a_change_without_any_error_is_refused(response, estimator):
    given = readings(response, balls(response, (20e-3, 20e-3, 12e-3)), noise=0.0)
    with pytest.raises(InputError, match="all errors of the estimator are 0; give noise or a model_error above 0"):
        estimator.estimate(given)


def test_classes_by_shapes_and_by_estimates():
    given = [(), ("sphere",), ("sphere", "ellipsoid"), ("tube",), ("tube", "tube"), ("sphere", "tube"), ("sphere",) * 3]
    assert [class_of(kinds) for kinds in given] == [*CLASSES, None, None]
    unknown = Estimate(True, (EstimatedInclusion("unknown", (0.0, 0.0, 0.0)),), "")
    assert estimated_class(unknown) == "lump"
    assert estimated_class(Estimate(False, (), "")) == "none"


def test_the_table_counts():
    table = ConfusionTable()
    assert table.share_right is None
    for true, estimated in (("lump", "lump"), ("lump", "two_lumps"), ("none", "none")):
        table.add(true, estimated)
    assert table.counts[1, 1:3].tolist() == [1, 1]
    assert table.share_right == pytest.approx(2 / 3)
    assert table.recalls == [1.0, 0.5, None, None, None]
    with pytest.raises(InvalidQuantity, match="no class 'balls'"):
        table.add("balls", "lump")


def test_probabilities_of_classes_must_add_up():
    with pytest.raises(InvalidQuantity, match=r"add up to 0\.5"):
        Estimate(False, (), "", 0.0, {"none": 0.5})
