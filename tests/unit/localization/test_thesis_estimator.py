"""The thesis's algorithm as an estimator, and what every estimator takes and gives."""

from __future__ import annotations

import numpy as np
import pytest
from made_grasps import BALL, LAYOUT, PLAIN, SIZE

from tactsim.errors import InputError, InvalidQuantity
from tactsim.interfaces import Estimator
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion, inclusion_in_words
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.registry import kinds

REFERENCE = ThesisEstimator(background="reference")


def readings(forces, **changes):
    return Readings(forces, LAYOUT, SIZE, **({"reference": PLAIN, "noise": 1e-3} | changes))


def center(estimate):
    return 1e3 * np.array(estimate.inclusions[0].center)


def test_place_and_depth_by_hand():
    # more than the reference: U 0.3 N and L 0.1 N at row 1, column 3, the same at row 2, column 3: x = 30, y = 15 mm;
    # a/(a + b) = 0.1/0.4 from the upper jaw: z = 0.75 x 20 mm
    forces = PLAIN.copy()
    forces[:, 0:2, 2] += np.array([[0.3], [0.1]])
    estimate = REFERENCE.estimate(readings(forces))
    np.testing.assert_allclose(center(estimate), [30, 15, 15])
    np.testing.assert_allclose(
        center(ThesisEstimator(background="reference", lateral="peak").estimate(readings(forces))), [30, 15, 15]
    )
    printed = ThesisEstimator(background="reference", form="as_printed").estimate(readings(forces))
    np.testing.assert_allclose(center(printed), [30, 15, 5])
    assert estimate.inclusions[0].radius is None
    assert "400 mN more than the reference" in estimate.reason


def test_a_ball_of_finite_elements_is_found_within_a_millimetre():
    located = center(REFERENCE.estimate(readings(PLAIN + BALL)))
    assert np.abs(located - [28, 14, 12]).max() < 1.0
    shifted = center(REFERENCE.estimate(readings(np.roll(PLAIN + BALL, 1, axis=2))))
    assert np.abs(shifted - [28, 14, 12]).max() > 5.0


def test_what_is_softer_than_the_tissue_is_found_as_well():
    estimate = REFERENCE.estimate(readings(PLAIN - 0.3 * BALL))
    np.testing.assert_allclose(center(estimate), center(REFERENCE.estimate(readings(PLAIN + 0.3 * BALL))))
    assert "less than the reference" in estimate.reason


def test_nothing_there_is_an_answer():
    # 4 standard deviations of a difference of two sums of two readings: 4 x 2 x 1 mN
    for change, there in ((0.0, False), (7.9e-3, False), (8.1e-3, True)):
        forces = PLAIN.copy()
        forces[0, 1, 1] += change
        estimate = REFERENCE.estimate(readings(forces))
        assert estimate.present is there
        assert bool(estimate.inclusions) is there
        assert ("no inclusion" in estimate.reason) is not there
        assert "8 mN (4 standard deviations of 2 mN, from noise of 1 mN on each taxel)" in estimate.reason


def test_false_alarms_of_noise_are_as_rare_as_the_threshold_says():
    generator = np.random.default_rng(5)
    cases = [
        readings(PLAIN + generator.normal(0, 1e-3, PLAIN.shape), reference=PLAIN + generator.normal(0, 1e-3, PLAIN.shape))
        for _ in range(400)
    ]
    alarms = {
        k: np.mean([ThesisEstimator(background="reference", threshold=k).estimate(case).present for case in cases])
        for k in (1, 4)
    }
    assert alarms[4] <= 0.01  # 9 places, both signs: 9 x 6e-5
    assert alarms[1] > 0.8


def test_without_a_reference_only_what_sticks_out_counts():
    even = ThesisEstimator().estimate(readings(PLAIN, reference=None))
    assert not even.present
    forces = PLAIN.copy()
    forces[0, 2, 0] += 0.1
    estimate = ThesisEstimator().estimate(readings(forces, reference=None))
    np.testing.assert_allclose(center(estimate)[:2], [10, 30])
    assert 10 < center(estimate)[2] < 13, "the ratio of bare forces barely leaves the middle"
    with pytest.raises(InputError, match="needs readings of the tissue without a lump"):
        REFERENCE.estimate(readings(PLAIN, reference=None))


def test_a_dead_taxel_is_never_zero():
    valid = np.ones((2, 3, 3), bool)
    valid[0, 0, 2] = False
    assert REFERENCE.estimate(readings(np.where(valid, PLAIN, 0.0))).present, "as zero it would look like something soft"
    assert not REFERENCE.estimate(readings(np.where(valid, PLAIN, np.nan), valid=valid)).present
    dead = np.where(valid, PLAIN + BALL, np.nan)
    located = center(REFERENCE.estimate(readings(dead, valid=valid)))
    assert np.hypot(*(located - [28, 14, 12])[:2]) < 3.0
    with pytest.raises(InvalidQuantity, match="U1,3"):
        readings(dead)


def test_matrices_off_the_middle_of_the_block():
    estimate = REFERENCE.estimate(readings(PLAIN + BALL, middle=np.array([22e-3, 17e-3])))
    np.testing.assert_allclose(center(estimate), center(REFERENCE.estimate(readings(PLAIN + BALL))) + np.array([2, -3, 0]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"forces": np.ones((2, 3, 4))}, r"needs \(jaw, row, column\) = \(2, 3, 3\)"),
        ({"reference": np.ones((3, 3))}, "reference of shape"),
        ({"reference": np.where(np.arange(3) == 0, np.nan, PLAIN)}, "U1,1"),
        ({"noise": -1.0}, "noise -1.0 N"),
        ({"noise": float("nan")}, "noise nan"),
        ({"block_size": np.array([1.0, -1.0, 1.0])}, "three positive lengths"),
        ({"middle": np.array([1.0])}, "middle of the matrices"),
    ],
)
def test_bad_readings_are_refused(change, words):
    given = {"forces": PLAIN, "layout": LAYOUT, "block_size": SIZE, "reference": PLAIN} | change
    with pytest.raises(InvalidQuantity, match=words):
        Readings(**given)


def test_estimates_that_contradict_themselves_are_refused():
    lump = EstimatedInclusion("sphere", (0.01, 0.02, 0.01), 5e-3, 20.0, np.eye(5))
    assert inclusion_in_words(lump) == "sphere at (10 mm, 20 mm, 10 mm), radius 5 mm"
    assert Estimate(True, (lump,), "", 0.9).present
    with pytest.raises(InvalidQuantity, match="must agree"):
        Estimate(False, (lump,), "")
    with pytest.raises(InvalidQuantity, match=r"probability 1\.5"):
        Estimate(True, (lump,), "", 1.5)
    assert EstimatedInclusion("sphere", (0.0, 0.0, 0.0), covariance=np.eye(4)).contrast is None
    for contrast, size in ((None, 3), (1.0, 4)):
        with pytest.raises(InvalidQuantity, match=r"\(4, 4\) without a contrast"):
            EstimatedInclusion("sphere", (0.0, 0.0, 0.0), contrast=contrast, covariance=np.eye(size))
    with pytest.raises(InvalidQuantity, match=r"\(5, 5\)"):
        EstimatedInclusion("sphere", (0.0, 0.0, 0.0), covariance=np.eye(3))
    with pytest.raises(InvalidQuantity, match="radius -1"):
        EstimatedInclusion("sphere", (0.0, 0.0, 0.0), radius=-1.0)
    with pytest.raises(InvalidQuantity, match="not finite"):
        EstimatedInclusion("sphere", (0.0, float("nan"), 0.0))


@pytest.mark.parametrize("kind", sorted(kinds(Estimator)))
def test_every_estimator_answers_and_comes_back_from_its_text(kind):
    estimator = kinds(Estimator)[kind].example()
    assert type(estimator).model_validate_json(estimator.model_dump_json()) == estimator
    if estimator.needs_response or kind == "learned":  # these need the response of the tissue or weights: tests of their own
        return
    estimate = estimator.estimate(readings(PLAIN + BALL))
    assert estimate.present
    assert estimate.reason
    assert np.isfinite(estimate.inclusions[0].center).all()
