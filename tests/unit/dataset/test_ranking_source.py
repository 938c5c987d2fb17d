"""Samples of a store with their truth and their reference."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_grasps import (
    CLOSINGS,
    FEW,
    LAYOUT,
    NOISE,
    READOUT,
    SIZE,
    TEXT,
    made_samples,
    made_store,
    plain_forces,
    plain_result,
    response,
    sum_up,
)
from scenes import grasp_scene
from sweeps import small_store

from tactsim.cli import main
from tactsim.dataset.ranking import samples as samples_module
from tactsim.dataset.ranking.confusion import store_confusion
from tactsim.dataset.ranking.reference import PlainGrasp
from tactsim.dataset.ranking.samples import added_noise, first_grasp, judged_samples
from tactsim.dataset.sampling.drawing import drawn_specimen
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.opening import Store
from tactsim.dataset.use.loading import sample_case
from tactsim.errors import InputError, StorageError
from tactsim.experiments.localization.source import stored_grasp
from tactsim.localization.estimators.hypotheses import HypothesesEstimator
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.results import write_result


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_store(tmp_path_factory.mktemp("made"), response())


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> str:
    return plain_result(tmp_path_factory.mktemp("plain") / "plain")


def test_forces_less_their_reference_are_what_the_lump_adds(store: Path, plain: str) -> None:
    samples = judged_samples(store, [plain], source="taxel_force")
    assert [truth.sample for truth in samples.truths] == list(range(40))
    nothing = [k for k, truth in enumerate(samples.truths) if not truth.present]
    away = np.abs(samples.forces - samples.references)
    assert away[nothing].max() < 2e-3  # a cubic through three closings
    assert np.delete(away, nothing, axis=0).max(axis=(1, 2, 3)).min() > 2e-3
    assert judged_samples(store, [plain], source="taxel_force", split="test").forces.shape == (10, 2, 3, 3)


def test_a_reference_at_the_wrong_closing_leaves_a_change(store: Path, plain: str) -> None:
    samples = judged_samples(store, [plain], source="taxel_force")
    wrong = samples.plain.at(np.array([truth.closing - 0.05e-3 for truth in samples.truths]))
    nothing = [k for k, truth in enumerate(samples.truths) if not truth.present]
    assert np.abs(samples.forces - wrong)[nothing].max() > 6e-3


def test_several_results_are_several_closings(tmp_path: Path) -> None:
    folders = [plain_result(tmp_path / f"plain{k}", np.array([c])) for k, c in enumerate(CLOSINGS[::-1])]
    plain = PlainGrasp.of_results(folders)
    assert [PlainGrasp.of_results(order).folder for order in (folders, folders[::-1])] == [folders[0]] * 2
    assert plain.closings == pytest.approx([0.0, *CLOSINGS])
    assert plain.at(0.8e-3) == pytest.approx(plain_forces(np.array([0.8e-3]))[0])
    for closings, named in (([0.8e-3, -0.2e-3], "-200 µm"), ([0.8e-3, 5e-3], "5 mm"), ([0.8e-3, np.nan], "nan")):
        with pytest.raises(InputError, match=f"closes by {named}"):
            plain.at(np.array(closings))
    with pytest.raises(InputError, match="two or more"):
        PlainGrasp.of_results(folders[:1])
    with pytest.raises(InputError, match="no reference"):
        PlainGrasp.of_results([])


def test_a_reference_with_a_lump_is_warned_of(tmp_path: Path, plain: str) -> None:
    scene = grasp_scene(SIZE, LAYOUT, (Sphere(center=(20e-3, 20e-3, 12e-3), radius=4e-3),), width=40e-3, depth=40e-3)
    write_result(replace(stored_grasp(plain), scene=scene), tmp_path / "lump", case_id="0" * 16, provenance={})
    with pytest.warns(UserWarning, match="the reference holds an inclusion"):
        PlainGrasp.of_results([str(tmp_path / "lump")])


@pytest.mark.parametrize(
    ("key", "before", "after"),
    [
        (r"experiment\.upper\.tilt_x", "  matrix:", "  upper: {tilt_x: {uniform: [-1 deg, 1 deg]}}\n  matrix:"),
        (r"experiment\.block\.tissue\.c10", "tissue: icf_stable", "tissue: {kind: neo_hookean, c10: {uniform: [2 kPa, 4 kPa]}}"),
    ],
)
def test_jaws_and_tissue_that_vary_among_the_samples_are_warned_of(
    key: str, before: str, after: str, tmp_path: Path, plain: str
) -> None:
    """Lumps were located twice as badly on jaws that lean, and nothing said why."""
    assert before in TEXT
    place = made_store(tmp_path, response(), text=FEW.replace(before, after, 1))
    with pytest.warns(UserWarning, match=rf"^{key} varies among the samples, not in the reference"):
        judged_samples(place, [plain], source="taxel_force")


def test_jaws_unlike_those_of_the_reference_are_named(tmp_path: Path, plain: str) -> None:
    leaning = FEW.replace("  matrix:", "  lower: {tilt_y: 2 deg}\n  matrix:", 1)
    with pytest.warns(UserWarning, match=r"^tilt_y of the lower jaw is 2°, in the reference 0°: what this changes"):
        judged_samples(made_store(tmp_path, response(), text=leaning), [plain], source="taxel_force")


def test_the_noise_of_readings_is_as_large_as_stated() -> None:
    samples = made_samples(60, response())
    for multiple in (1.0, 4.0):
        readings = list(samples.readings(multiple=multiple))
        away = np.array([each.forces for each in readings]) - samples.forces
        assert away.std() == pytest.approx(multiple * NOISE, rel=0.1)
        assert readings[0].noise == pytest.approx(multiple * NOISE)
    again = list(samples.readings(multiple=4.0))
    assert np.array_equal(again[5].forces, readings[5].forces)
    assert not np.array_equal(next(iter(samples.readings(multiple=4.0, seed=2))).forces, readings[0].forces)


def test_read_forces_are_held_against_a_reference_read_alike(tmp_path: Path, plain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    place = made_store(tmp_path, response(), FEW.replace("  time: {steps: 1}\n", READOUT))
    samples = judged_samples(place, [plain], source="read_force")
    assert (samples.own_noise == samples.noise).all()
    assert samples.noise == pytest.approx(np.full(8, samples.noise[0])), "sensors of one kind"
    assert samples.references.shape == samples.forces.shape
    parsed: list[Store] = []
    read = samples_module.stored_sweep
    monkeypatch.setattr(samples_module, "stored_sweep", lambda store: parsed.append(store) or read(store))
    by_default = judged_samples(place, [plain], source=None)
    assert len(parsed) == 1, "a sweep of many draws takes long to read"
    assert by_default.source == "read_force"
    np.testing.assert_array_equal(by_default.noise, samples.noise)
    louder = judged_samples(place, [plain], source="read_force", noise=5e-3)
    assert louder.noise == pytest.approx(np.hypot(5e-3, samples.noise))
    assert added_noise(louder.noise, louder.own_noise, 1.0) == pytest.approx(5e-3)
    assert np.abs(samples.references / samples.plain.at([t.closing for t in samples.truths]) - 1).max() > 0.05


def test_readings_without_noise_are_refused(tmp_path: Path, plain: str) -> None:
    """Round-off was taken for the noise of the sensors, so that every estimator saw a lump in every sample."""
    quiet = READOUT.replace("white: 1 mV", "white: 0 V")
    place = made_store(tmp_path, response(), FEW.replace("  time: {steps: 1}\n", quiet))
    with pytest.raises(InputError, match=r"read without noise.*--noise '1 mN' \(in Python: noise=1e-3\)"):
        judged_samples(place, [plain], source="read_force")
    assert judged_samples(place, [plain], source="read_force", noise=1e-3).noise == pytest.approx(1e-3)


def test_every_sample_is_judged_with_the_noise_of_its_own_sensors(tmp_path: Path, plain: str) -> None:
    """All were judged with those of the first one: where white noise varies tenfold, regions were too wide or too narrow."""
    varied = READOUT.replace("white: 1 mV", "white: {log_uniform: [0.1 mV, 10 mV]}")
    place = made_store(tmp_path, response(), TEXT.replace("  time: {steps: 1}\n", varied))
    samples = judged_samples(place, [plain], source="read_force")
    white = [sample_case(place, truth.sample).experiment.readout.chain.noise.white for truth in samples.truths]
    order = np.argsort(white)
    ratio = samples.noise[order[-8:]] / np.array(white)[order[-8:]]
    assert ratio == pytest.approx(np.full(8, ratio.mean()), rel=0.2), "noise of repeated readings, 16 of 18 taxels, in V"
    assert samples.noise[order[0]] < 0.1 * samples.noise[order[-1]]
    assert [reading.noise for reading in samples.readings(multiple=2.0)] == pytest.approx(2 * samples.noise)
    quiet = READOUT.replace("white: 1 mV", "white: {uniform: [0 mV, 1e-12 mV]}")
    (tmp_path / "quiet").mkdir()
    with pytest.raises(InputError, match="read without noise"):
        judged_samples(
            made_store(tmp_path / "quiet", response(), FEW.replace("  time: {steps: 1}\n", quiet)), [plain], source="read_force"
        )


def test_a_sample_that_was_computed_from_another_case_is_refused(tmp_path: Path, plain: str) -> None:
    varied = READOUT.replace("white: 1 mV", "white: {uniform: [1 mV, 2 mV]}")
    place = made_store(tmp_path, response(), FEW.replace("  time: {steps: 1}\n", varied))
    Store.open(place, writing=True).array("case_id")[3] = "f" * 16
    sum_up(place)
    with pytest.raises(StorageError, match="sample 3 was computed from another case than this tactsim draws"):
        judged_samples(place, [plain], source="read_force")


def test_samples_of_one_specimen_keep_its_number(tmp_path: Path, plain: str) -> None:
    shared = FEW.replace("samples: 8,", "samples: 8, samples_per_specimen: 2, within_specimen: [experiment.loading.pieces.0.to],")
    place = made_store(tmp_path, response(), shared.replace("to: 1 mm", "to: {uniform: [0.5 mm, 1 mm]}"))
    samples = judged_samples(place, [plain], source="taxel_force")
    assert [truth.group for truth in samples.truths] == [k // 2 for k in range(8)]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"closings": CLOSINGS[:2]}, "closes at least as far as every sample"),
        ({"layout": LAYOUT.model_copy(update={"rows": 2})}, "matrix of the store"),
        ({"size": SIZE + 1e-3}, "block of the store"),
    ],
)
def test_another_reference_is_refused(store: Path, tmp_path: Path, changes: dict, words: str) -> None:
    folder = plain_result(tmp_path / "other", **changes)
    with pytest.raises(InputError, match=words):
        judged_samples(store, [folder], source="taxel_force")


@pytest.mark.parametrize("heights", ["20 mm, 22 mm", "22 mm, 20 mm"])
def test_samples_of_another_block_than_the_first_are_refused(tmp_path: Path, plain: str, heights: str) -> None:
    """Only the first sample was held against the reference; the places of the others were told in its block."""
    varied = FEW.replace("size: [40 mm, 40 mm, 20 mm]", f"size: [40 mm, 40 mm, {{values: [{heights}]}}]")
    place = made_store(tmp_path, response(), varied)
    with pytest.raises(InputError, match="the block of the store measures 40 mm x 40 mm x 22 mm, that of the reference"):
        judged_samples(place, [plain], source="taxel_force")
    with pytest.raises(InputError, match="the block of the store measures 40 mm x 40 mm x 22 mm, that of the reference"):
        store_confusion(place, plain, HypothesesEstimator(), response=response())


def test_a_grid_of_grasps_may_begin_with_impossible_ones(tmp_path: Path) -> None:
    """The first three samples were looked at, and without a possible one the store was said to hold no grasps."""
    impossible = "radius: {values: [30 mm, 31 mm, 32 mm, 3 mm]}"
    text = TEXT.replace("{uniform: [8 mm, 32 mm]}", "20 mm").replace("radius: 3 mm", impossible)
    text = text.replace("{samples: 40, seed: 3,", "{design: grid, seed: 3,")
    path = tmp_path / "sweep.yaml"
    path.write_text(text, encoding="utf-8")
    sweep = load_sweep(path)
    assert [drawn_specimen(sweep, k)[0].case is None for k in range(4)] == [True, True, True, False]
    assert first_grasp(sweep, "grid").inclusions[0].shape.radius == pytest.approx(3e-3)


@pytest.mark.filterwarnings("ignore:.*result.json was changed since tactsim wrote it")
def test_a_reference_whose_scene_cannot_be_read_is_said_to_be_so(tmp_path: Path) -> None:
    """It was said to have no forces of taxels."""
    place = Path(plain_result(tmp_path / "plain")) / "result.json"
    place.write_text(place.read_text().replace('"schema_version": 2', '"schema_version": 1'), encoding="utf-8")
    with pytest.raises(StorageError, match="plain: the scene of the result cannot be read: it was written by an earlier version"):
        PlainGrasp.of_results([str(place.parent)])


def test_stores_that_cannot_be_judged_are_refused(store: Path, plain: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no readout"):
        judged_samples(store, [plain], source="read_force")
    with pytest.raises(StorageError, match=r"no such folder: .*nowhere; name one that tactsim sweep wrote"):
        judged_samples(tmp_path / "nowhere", [plain], source="taxel_force")
    with pytest.raises(InputError, match="no sample that is done"):
        judged_samples(made_store(tmp_path, response(), FEW, done=False), [plain], source="taxel_force")
    other = tmp_path / "closed_form"
    other.mkdir()
    with pytest.raises(InputError, match="holds samples of closed_form"):
        judged_samples(small_store(other), [plain], source="taxel_force")


def test_the_command_line_says_what_is_missing(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", "rank", str(store)]) == 2
    assert "--reference is missing" in capsys.readouterr().err
    assert main(["data", "train", str(store), "--reference", "x", "--out", "w.txt"]) == 2
    assert "train: --out w.txt is no place for weights; name a file ending in .npz" in capsys.readouterr().err
    assert main(["data", "rank", str(store), "--reference", "x", "--noise", "-1 mN"]) == 2
    assert "--noise" in capsys.readouterr().err
    assert main(["data", "rank", str(store), "--reference", "x", "--noise", "0.6"]) == 2
    assert "--noise: '0.6' has no unit" in capsys.readouterr().err
