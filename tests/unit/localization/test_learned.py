"""The learned estimator: trained on made-up grasps, kept, read again, refused."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from made_grasps import LAYOUT, NOISE, SIZE, made_samples, response
from scenes import grasp_scene

from tactsim.dataset.ranking import training
from tactsim.dataset.ranking.measures import measures, outcomes
from tactsim.errors import InputError, StorageError
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.live.session.choices import Choice
from tactsim.live.session.estimating import estimated
from tactsim.live.sources.scene import PageScene
from tactsim.localization.estimators.learned import LearnedEstimator
from tactsim.localization.networks import LearnedWeights, Network, inputs, read_weights
from tactsim.units import format_quantity

PLAIN = np.full((2, 3, 3), 0.3)


def network(*shape):
    generator = np.random.default_rng(sum(shape))
    return Network(
        tuple(0.1 * generator.standard_normal(pair) for pair in pairwise(shape)),
        tuple(0.1 * generator.standard_normal(n) for n in shape[1:]),
    )


def weights(bias=5.0):
    presence = Network((np.zeros((20, 1)),), (np.array([bias]),))
    numbers = {"middle": np.zeros(20), "scale": np.ones(20), "covariance": 0.01 * np.eye(4), "growth": np.zeros(2)}
    return LearnedWeights(
        layout=LAYOUT, block_size=SIZE, places=(network(20, 8, 4), network(20, 6, 4)), presence=presence, held_out=3, **numbers
    )


def kept(folder, written):
    path = folder / "weights.npz"
    path.write_bytes(written.content())
    return path


def readings(layout=LAYOUT, size=SIZE):
    change = 0.01 * np.random.default_rng(1).standard_normal((2, layout.rows, layout.columns))
    change[:, 0, 0] = 0.1
    plain = np.full(change.shape, 0.3)
    return Readings(plain + change, layout, size, reference=plain, noise=NOISE)


def test_weights_are_read_as_they_were_written(tmp_path):
    path, given = kept(tmp_path, weights()), readings()
    loaded = read_weights(path)
    features = inputs(given.difference[None], given.reference[None], NOISE)[0]
    for one, other in zip(loaded.place(features), weights().place(features), strict=True):
        assert np.array_equal(one, other)
    estimate = LearnedEstimator.checked(path).estimate(given)
    assert estimate.present
    (ball,) = estimate.inclusions
    assert ball.region.contains(np.array(ball.center))
    np.testing.assert_array_equal(ball.covariance, loaded.place(features)[1])
    scene = PageScene("", grasp_scene(SIZE.tolist(), LAYOUT))
    shown = estimated(scene, given, Choice("learned", "Learned", LearnedEstimator.checked(path), True), None)
    assert shown["words"][2].startswith("± (")
    assert shown["words"][2].endswith("(one standard deviation)")
    assert not LearnedEstimator.checked(kept(tmp_path, weights(bias=-5.0))).estimate(given).present


def test_a_file_that_was_not_trained_is_no_estimator(tmp_path):
    case = tmp_path / "g.yaml"
    case.write_text("schema: tactsim/case/1")
    with pytest.raises(StorageError, match=r"g\.yaml is no file of a learned estimator; tactsim data train makes one"):
        LearnedEstimator.checked(case)
    np.savez(tmp_path / "other.npz", force=np.zeros(3))
    with pytest.raises(StorageError, match="does not hold the weights of a learned estimator: 'schema'; tactsim data train"):
        LearnedEstimator.checked(tmp_path / "other.npz")


def test_where_the_readings_rise_apart_no_one_place_is_stated(tmp_path):
    learned, told = LearnedEstimator.checked(kept(tmp_path, weights())), readings()
    apart = np.zeros((2, 3, 3))
    apart[:, 0, 0], apart[:, 2, 2] = 0.1, 0.08
    found = learned.estimate(replace(told, forces=PLAIN + apart))
    assert len(found.inclusions) == 2
    assert "better than one" in found.reason
    apart[:, 2, 2] = 0.0
    assert len(learned.estimate(replace(told, forces=PLAIN + apart)).inclusions) == 1


def test_inputs_do_not_know_the_size_of_the_change_but_for_one():
    change = np.random.default_rng(3).standard_normal((1, 2, 3, 3))
    one, ten = (inputs(factor * change, PLAIN[None], NOISE)[0] for factor in (1, 10))
    assert one[:-2] == pytest.approx(ten[:-2])
    assert ten[-2] - one[-2] == pytest.approx(np.log(10))
    with pytest.raises(InputError, match="no force"):
        inputs(change, 0 * PLAIN[None], NOISE)


def test_foreign_readings_and_files_are_refused(tmp_path):
    estimator = LearnedEstimator.checked(kept(tmp_path, weights()))
    with pytest.raises(
        InputError, match=r"trained on the matrix of 3 x 3 taxels of 9 mm at a pitch of 10 mm, the readings are of 4 x 3 "
    ):
        estimator.estimate(readings(layout=TaxelLayout(rows=4, columns=3)))
    with pytest.raises(InputError, match="trained on a block"):
        estimator.estimate(readings(size=SIZE + 1e-3))
    with pytest.raises(InputError, match="needs a reference"):
        estimator.estimate(Readings(PLAIN, LAYOUT, SIZE))
    for content in (b"nothing", b""):
        (tmp_path / "bad.npz").write_bytes(content)
        with pytest.raises(StorageError, match="is no file of a learned estimator"):
            LearnedEstimator.checked(tmp_path / "bad.npz")
    np.savez(tmp_path / "object.npz", schema=np.array({"a": 1}, dtype=object))
    with pytest.raises(StorageError, match=r"does not hold|is damaged"):
        LearnedEstimator.checked(tmp_path / "object.npz")
    np.savez(tmp_path / "other.npz", schema=np.array("tactsim/learned/9"))
    with pytest.raises(StorageError, match="reads 'tactsim/learned/1'"):
        LearnedEstimator.checked(tmp_path / "other.npz")


def test_mirror_images_are_those_of_the_fast_model():
    table = response()
    samples = made_samples(9, table)
    examples = training._examples(samples)
    mirrored = training._mirrored(examples, samples)
    assert len(mirrored.targets) == 16 * 9
    there = np.isfinite(mirrored.targets[:, 0])
    expected = 2.0 * table.signal(mirrored.targets[there, :3], mirrored.targets[there, 3])
    size = np.abs(expected).max()
    assert mirrored.changes[there] == pytest.approx(expected, abs=0.02 * size)  # the reference between its closings
    assert mirrored.changes[there] != pytest.approx(expected[::-1], abs=0.06 * size)


def test_whole_specimens_are_held_out() -> None:
    """Samples of one lump stood on both sides, so that the errors of those held out were too small."""
    apart = made_samples(60, response())
    shared = replace(apart, truths=tuple(replace(truth, specimen=truth.sample // 3) for truth in apart.truths))
    held = training._held_out(shared, np.random.default_rng(1))
    assert held.reshape(20, 3).all(axis=1).sum() == 4
    assert held.sum() == 12
    assert training._held_out(apart, np.random.default_rng(1)).sum() == 12


def test_examples_of_the_fast_model_get_all_their_noise() -> None:
    """The noise of read forces, which those of the model do not have, was left out of them."""
    read = made_samples(24, response())
    read = replace(read, noise=np.repeat([1e-3, 2e-3], 12), own_noise=np.repeat([1e-3, 2e-3], 12))
    fast = training._fast(read, response(), np.random.default_rng(1))
    noisy, _ = training._noisy(replace(fast, changes=np.zeros_like(fast.changes)), np.random.default_rng(2), exact=True)
    stated = fast.noise / np.abs(fast.references).sum(axis=(1, 2, 3))
    size = np.exp(noisy[:, -2]) / stated  # of 18 taxels with twice the variance, against a reference
    assert np.median(size) == pytest.approx(np.sqrt(2 * 18), rel=0.03)
    assert sorted(set(fast.noise)) == [1e-3, 2e-3]
    own, _ = training._noisy(training._examples(read), np.random.default_rng(2), exact=True)
    assert own[:, :18] == pytest.approx(training.inputs(read.forces - read.references, read.references, read.noise)[:, :18])


def test_training_finds_lumps_and_needs_enough(tmp_path, monkeypatch):
    pytest.importorskip("sklearn")
    monkeypatch.setattr(training, "FAST", 1500)
    monkeypatch.setattr(training, "NETWORKS", 2)
    monkeypatch.setattr(training, "HIDDEN", (32,))
    monkeypatch.setattr(training, "COPIES", 1)
    table = response()
    trained = training.trained(replace(made_samples(48, table, seed=2), cases=("a", "b")), table)
    assert trained.trained_on == ("a", "b")
    plan, height = trained.held_out_error
    assert 0 < plan < 10e-3
    assert 0 < height < 10e-3
    assert (
        f"{trained.held_out} lumps held out, which are in the median {format_quantity(float(f'{plan:.2g}'), 'm')} off"
        in trained.summary()
    )
    assert read_weights(kept(tmp_path, trained)).summary().endswith("lumps held out")
    judged = made_samples(40, table, seed=5)
    numbers = measures(outcomes(LearnedEstimator.checked(kept(tmp_path, trained)), judged, None), SIZE)
    guess = np.median([np.hypot(*(np.array(t.center)[:2] - 20e-3)) for t in judged.truths if t.present])
    assert numbers["detection_rate"]["value"] > 0.8
    assert numbers["lateral_error_with_misses"]["value"] < 0.5 * guess
    assert numbers["coverage"]["value"] > 0.6
    with pytest.raises(InputError, match="at least 20"):
        training.trained(made_samples(10, table), table)
