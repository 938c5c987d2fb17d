"""Recordings of results and samples, and estimates on them."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from live_pages import grasp_folder, localized_folder, made_up_grasp, made_up_store, resized, taxel_forces
from made_grasps import response

from tactsim.errors import InputError, StorageError
from tactsim.experiments.localization.source import readings_of
from tactsim.interfaces.estimate import decimals_of_places
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.live.session.choices import StoredEstimate, offered_choices, stored_choice
from tactsim.live.session.content import opened_content
from tactsim.live.session.estimating import NO_ERROR, NO_ERRORS, estimated, frame_readings, shown_signal
from tactsim.live.session.messages import Scales, frame_message
from tactsim.live.session.thinking import estimate_message
from tactsim.live.sources.recorded import result_recordings, source_noise
from tactsim.live.sources.reference import PlainResult, Reference
from tactsim.live.sources.samples import Samples
from tactsim.localization.views import views
from tactsim.mesh.inclusions.surface import Surface
from tactsim.results import Quantity, write_result
from tactsim.shipped import CASES

pytestmark = pytest.mark.filterwarnings("ignore:.*result.json was changed since tactsim wrote it")

BY_NAME = {choice.name: choice for choice in offered_choices()}


def test_frames_between_the_steps_are_linear_and_the_jaws_follow(tmp_path: Path) -> None:
    recording = result_recordings(grasp_folder(tmp_path / "a"))["taxel_force"]
    frame = recording.at(0.625)
    np.testing.assert_allclose(frame.forces, taxel_forces()[-1] * 0.625, rtol=1e-12)
    assert frame.closing == pytest.approx(0.625e-3)
    np.testing.assert_allclose(recording.scene.places_at(frame.closing)[:, 2], [20e-3 - 0.625e-3, 0.625e-3])
    np.testing.assert_allclose(recording.at(5.0).forces, taxel_forces()[-1])
    np.testing.assert_allclose(recording.at(-5.0).forces, taxel_forces()[0])


def test_a_result_without_a_title_goes_by_its_folder(tmp_path: Path) -> None:
    assert result_recordings(grasp_folder(tmp_path / "left_hand", title=""))["taxel_force"].scene.title == "left_hand"


def test_a_taxel_that_is_null_in_the_result_is_dead(tmp_path: Path) -> None:
    forces = taxel_forces(1)
    forces[0, 1, 2, 0] = np.nan
    recording = result_recordings(grasp_folder(tmp_path / "a", forces))["taxel_force"]
    assert recording.frame(0).notes() == ("dead or saturated taxels, interpolated from their neighbours: L3,1",)


def test_a_force_in_a_mistaken_unit_is_not_trusted(tmp_path: Path) -> None:
    forces = taxel_forces(1)
    forces[0, 0, 1, 1] = 1e9
    recording = result_recordings(grasp_folder(tmp_path / "a", forces))["taxel_force"]
    assert recording.frame(0).notes() == ("dead or saturated taxels, interpolated from their neighbours: U2,2",)


def test_a_taxel_that_reads_exactly_zero_among_others_that_press_is_told(tmp_path: Path) -> None:
    forces = taxel_forces(1)
    forces[0, 1, 0, 0] = 0.0
    (note,) = result_recordings(grasp_folder(tmp_path / "a", forces))["taxel_force"].frame(0).notes()
    assert note.startswith("exactly zero although all around press")
    assert note.endswith(": L1,1")
    forces[0, 1, 0, 1] = 0.0  # with a neighbour that does not press either, it may stand beside the tissue
    assert result_recordings(grasp_folder(tmp_path / "b", forces))["taxel_force"].frame(0).notes() == ()


def test_forces_that_pull_on_the_whole_are_told(tmp_path: Path) -> None:
    forces = np.full((1, 2, 3, 3), 0.5)
    forces[0, 1] *= -1
    (note,) = result_recordings(grasp_folder(tmp_path / "a", forces))["taxel_force"].frame(0).notes()
    assert "pull on the whole, the lower jaw's by 4.5 N" in note


def test_a_taxel_is_saturated_while_its_samples_are(tmp_path: Path) -> None:
    result = made_up_grasp()
    flags = np.zeros((4, 2, 3, 3), int)
    flags[1:3, 0, 1, 1] = 1
    read = {}
    for jaw, side in enumerate(JAWS):
        for name in (f"taxel_force_{side}", f"taxel_force_{side}_history"):
            read[name.replace("taxel", "read")] = result.quantities[name]
        read[f"saturated_{side}"] = Quantity(flags[:, jaw].mean(axis=0).tolist(), "1", "")
        read[f"saturated_{side}_history"] = Quantity(flags[:, jaw].tolist(), "1", "")
    read["readout_time"] = result.quantities["time_history"]
    found = replace(result, quantities=result.quantities | read)
    write_result(found, tmp_path / "a", case_id="abc", provenance={})
    valid = result_recordings(tmp_path / "a")["read_force"].valid
    assert np.array_equal(~valid, flags > 0)
    assert readings_of(found, "read_force", noise=0.0).valid is None, "at the end it reads again"
    old = {name: value for name, value in found.quantities.items() if not name.startswith("saturated") or "history" not in name}
    before = readings_of(replace(found, quantities=old), "read_force", noise=0.0).valid
    assert before is not None, "a result of before tells that some sample was saturated, not which"
    assert np.argwhere(~before).tolist() == [[0, 1, 1]]


def reference_notes_of(folder: Path, shown: Path | None = None) -> tuple[str, ...]:
    """What is said of a reference beside a grasp, by default itself."""
    scene = result_recordings(shown or folder)["taxel_force"].scene
    return Reference.open([str(folder)]).notes(scene)


def test_other_jaws_of_the_reference_are_named_where_they_are_known(tmp_path: Path) -> None:
    folder, shown = grasp_folder(tmp_path / "a"), grasp_folder(tmp_path / "b")
    change(shown, ("scene", "jaws", "upper", "tilt_x"), 0.05)
    (note,) = (note for note in reference_notes_of(folder, shown) if "jaw" in note)
    assert note.startswith("tilt_x of the upper jaw is 2.8648°, in the reference 0°")
    sensor = replace(result_recordings(shown)["taxel_force"].scene, truth_known=False)
    assert not any("jaw" in note for note in Reference.open([str(folder)]).notes(sensor))


def test_an_inclusion_of_the_tissue_itself_is_no_inclusion(tmp_path: Path) -> None:
    folder = change(grasp_folder(tmp_path / "a"), ("scene", "inclusions", 0, "unlike_tissue"), False)
    assert result_recordings(folder)["taxel_force"].scene.inclusions == ()
    assert reference_notes_of(folder) == ()
    (note,) = reference_notes_of(grasp_folder(tmp_path / "b"))
    assert note.startswith("the reference holds an inclusion of another material")


def test_the_estimate_of_a_localization_is_offered_first(tmp_path: Path) -> None:
    assert stored_choice(grasp_folder(tmp_path / "a")) is None
    folder = localized_folder(tmp_path / "b")
    content = opened_content(folder)
    choice, recording = content.choices[0], content.recordings["taxel_force"]
    assert choice.name == "stored"
    found = estimated(recording.scene, frame_readings(recording.scene, recording.at(1.0), choice, None), choice, None)
    assert found["words"][1:] == [
        "Sphere at (23.0, 17.0, 12.0) mm, radius 4.0 mm",
        "± (1, 2, 3) mm, radius ± 0.4 mm (one standard deviation)",
        "Tube at (20.0, 20.0, 10.0) mm, radius 3.0 mm",
        NO_ERROR,
    ]
    assert found["errors"] == ["Off by 1.0 mm in plan and +0.0 mm in height, radius off by +0.0 mm (the first)"]
    assert found["inclusions"][1]["line"] == [[0, 20, 10], [40, 20, 10]]
    change(folder, ("scene", "estimates"), [{"kind": "sphere"}])
    with pytest.raises(StorageError, match="not a complete result of a localization"):
        opened_content(folder)


def test_places_in_a_small_block_are_written_as_finely_as_in_a_large_one(tmp_path: Path) -> None:
    """In a block of 0.4 mm they were rounded to tenths of a millimetre, and every one was off by 0.0 mm."""
    small = write_result(resized(made_up_grasp(), (0.01, 0.01, 0.01)), tmp_path / "a", case_id="abc", provenance={})
    recording = result_recordings(small)["taxel_force"]
    choice = BY_NAME["thesis"]
    found = estimated(recording.scene, frame_readings(recording.scene, recording.at(1.0), choice, None), choice, None)
    assert re.fullmatch(r"At \(0\.\d{3}, 0\.\d{3}, 0\.\d{3}\) mm", found["words"][1])
    assert re.match(r"Off by 0\.0\d{2} mm in plan and [+-]0\.0\d{2} mm in height", found["errors"][0])
    assert [decimals_of_places(np.array([1.0, side, 0.1]) * 1e-3) for side in (40.0, 10.0, 9.0, 0.9)] == [1, 1, 2, 2]


def test_that_no_error_is_stated_of_several_places_is_said_once(tmp_path: Path) -> None:
    apart = np.full((1, 2, 3, 3), 0.1)
    apart[0, :, 0, 0] = apart[0, :, 2, 2] = 0.6
    recording = result_recordings(grasp_folder(tmp_path, apart))["taxel_force"]
    choice = BY_NAME["thesis"]
    words = estimated(recording.scene, frame_readings(recording.scene, recording.frame(0), choice, None), choice, None)["words"]
    assert sum(" at (" in line.lower() or line.startswith("At (") for line in words) == 2
    assert [line for line in words if "No error" in line] == [NO_ERRORS]


def test_a_stored_estimate_without_a_contrast_keeps_its_error(tmp_path: Path) -> None:
    """That of the learned estimator: place and radius with their covariance."""
    folder = localized_folder(tmp_path)
    stored = json.loads((folder / "result.json").read_text())
    del stored["quantities"]["contrast_deviation"]
    change(folder, ("quantities",), stored["quantities"])
    choice = stored_choice(folder)
    assert choice is not None
    assert isinstance(choice.estimator, StoredEstimate)
    covariance = choice.estimator.stored.inclusions[0].covariance
    assert covariance is not None
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), [1e-3, 2e-3, 3e-3, 4e-4])


def change(folder: Path, place: tuple[str | int, ...], value: object) -> Path:
    """Overwrites something in result.json."""
    path = folder / "result.json"
    content = json.loads(path.read_text())
    part = content
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    path.write_text(json.dumps(content))
    return folder


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("quantities", "taxel_force_upper_history", "value"), [[[1.0, 2.0]] * 2] * 4),
        (("quantities", "taxel_force_upper_history", "value"), "x"),
        (("quantities", "time_history", "value"), [0.1, 0.2, 0.2, 0.3]),
        (("quantities", "time_history", "value"), [0.1]),
        (("scene", "matrix", "rows"), -1),
        (("scene", "matrix", "rows"), 4),
        (("scene", "block_size"), None),
        (("scene", "jaws"), {}),
    ],
)
def test_a_damaged_result_is_told(tmp_path: Path, place: tuple[str | int, ...], value: object) -> None:
    folder = change(grasp_folder(tmp_path / "a"), place, value)
    with pytest.raises(StorageError, match=r"is not a complete result of a grasp|value: .*nested list of numbers"):
        result_recordings(folder)


def test_the_missing_file_of_a_surface_is_no_damage_of_the_result(tmp_path: Path) -> None:
    shape = {"kind": "surface", "path": "gone.stl", "unit": "mm", "translation": [0.02, 0.02, 0.01]}
    folder = change(grasp_folder(tmp_path / "a"), ("scene", "inclusions", 0, "shape"), shape)
    with pytest.raises(
        StorageError, match=r"cannot read the surface gone\.stl: No such file .*: bring it back, or start in"
    ) as told:
        result_recordings(folder)
    assert "complete" not in str(told.value)
    assert "again" not in str(told.value)


def test_a_surface_whose_file_has_changed_since_is_not_shown_as_the_truth(tmp_path: Path) -> None:
    """A file that is only written anew is the same one."""
    lump = tmp_path / "lump.stl"
    shutil.copy(CASES.parent / "meshes" / "lump.stl", lump)
    shape = Surface(path=str(lump), unit="mm", translation=(0.02, 0.02, 0.01))
    known = {"shape": shape.model_dump(mode="json"), "unlike_tissue": True, "file_content": shape.file_content()}
    folder = change(grasp_folder(tmp_path / "a"), ("scene", "inclusions", 0), known)
    lump.write_bytes(lump.read_bytes())
    assert result_recordings(folder)["taxel_force"].scene.inclusions == (shape,)
    mesh = meshio.read(lump)
    meshio.Mesh(1.7 * mesh.points, mesh.cells).write(lump)
    with pytest.raises(
        StorageError,
        match=r"result\.json: surface 1: its file has changed since it was grasped; bring it back, or run the grasp again$",
    ):
        result_recordings(folder)


def test_a_reference_takes_its_place_at_the_same_closing(tmp_path: Path) -> None:
    recording = result_recordings(grasp_folder(tmp_path / "a"))["taxel_force"]
    reference = Reference.open([str(grasp_folder(tmp_path / "b", taxel_forces(8, lump=0.0), lump=False))])
    choice = BY_NAME["thesis with reference"]
    for time in (0.3, 0.77, 1.0):
        signal, words = shown_signal(frame_readings(recording.scene, recording.at(time), choice, reference))
        np.testing.assert_allclose(signal, time * (taxel_forces()[-1] - 0.1), rtol=1e-9)
        assert words == "force above that of the reference"
    found = estimated(recording.scene, frame_readings(recording.scene, recording.at(1.0), choice, reference), choice, reference)
    assert found["present"]
    assert found["errors"][0].startswith("Off by")


def closed_by(folder: Path, closing: float) -> Path:
    """Changes the closing of a stored grasp."""
    return change(folder, ("quantities", "displacement", "value"), closing)


def test_several_references_serve_samples_of_other_closings(tmp_path: Path) -> None:
    steps = {0.5e-3: 0.5, 1e-3: 1.0, 1.5e-3: 1.5}
    folders = [
        str(closed_by(grasp_folder(tmp_path / f"{scale}", scale * taxel_forces(1, lump=0.0), lump=False), closing))
        for closing, scale in reversed(steps.items())
    ]
    reference = Reference.open(folders)
    assert [result.closing for result in reference.results] == list(steps)
    frame = result_recordings(grasp_folder(tmp_path / "a", taxel_forces(1)))["taxel_force"].frame(0)
    for closing in (0.25e-3, 0.8e-3, 1.5e-3):
        found = reference.frame_for(replace(frame, closing=closing))
        np.testing.assert_allclose(found.forces, 0.1 * closing / 1e-3, rtol=1e-9)  # plain tissue reads 0.1 N at 1 mm
        assert found.closing == closing
    with pytest.raises(InputError, match=r"closed by 2 mm, those of the reference by 500 µm, 1 mm, 1.5 mm"):
        reference.frame_for(replace(frame, closing=2e-3))
    with pytest.raises(InputError, match="need different closings"):
        Reference.open([folders[0], folders[0]])


def test_a_reference_that_was_changed_is_warned_of_once(tmp_path: Path) -> None:
    folder = grasp_folder(tmp_path / "b", taxel_forces(2, lump=0.0), lump=False)
    result = folder / "result.json"
    result.write_text(result.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    with pytest.warns(UserWarning, match=r"result\.json was changed") as caught:
        Reference.open([str(folder)])
    assert len(caught) == 1


def test_read_forces_are_not_compared_with_those_of_the_solution(tmp_path: Path) -> None:
    reference = Reference.open([str(grasp_folder(tmp_path / "b", taxel_forces(1, lump=0.0), lump=False))])
    frame = result_recordings(grasp_folder(tmp_path / "a", taxel_forces(1)))["taxel_force"].frame(0)
    reference.frame_for(frame)
    with pytest.raises(InputError, match="has no forces read through the sensors: run it with the readout"):
        reference.frame_for(replace(frame, source="read_force"))


def test_an_estimator_without_its_reference_says_what_it_needs(tmp_path: Path) -> None:
    recording = result_recordings(grasp_folder(tmp_path / "a"))["taxel_force"]
    with pytest.raises(InputError, match="--reference FOLDER"):
        frame_readings(recording.scene, recording.at(1.0), BY_NAME["model_based"], None)
    reference = Reference.open([str(grasp_folder(tmp_path / "b", taxel_forces(2, 4), lump=False))])
    with pytest.raises(InputError, match="another block or another matrix"):
        frame_readings(recording.scene, recording.at(1.0), BY_NAME["model_based"], reference)
    same = Reference.open([str(grasp_folder(tmp_path / "c", taxel_forces(2), lump=False))])
    with pytest.raises(InputError, match=r"closed by 1.5 mm, those of the reference by 1 mm; needed: .* at least as far"):
        same.response(1.5e-3)


def test_the_model_of_the_tissue_follows_the_closing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = response()
    monkeypatch.setattr(PlainResult, "response", lambda self, watch=None: table)
    steps = np.array([0.25, 0.5, 0.75, 1.0])
    forces = 0.1 * (steps**2)[:, None, None, None] * np.ones((1, 2, 3, 3))  # tissue that stiffens
    reference = Reference.open([str(grasp_folder(tmp_path / "a", forces, lump=False))])
    for closing, share in ((1e-3, 1.0), (0.75e-3, 0.75**2), (0.6e-3, 0.6**2)):
        found = reference.response(closing)
        np.testing.assert_allclose(found.values, share * table.values, rtol=3e-2)  # a parabola by monotone cubics
    single = Reference.open([str(grasp_folder(tmp_path / "b", forces[-1:], lump=False))])
    np.testing.assert_array_equal(single.response(1e-3).values, table.values)
    with pytest.raises(InputError, match=r"known at a closing of 1 mm only, here it is 600 µm; needed: .*steps=12"):
        single.response(0.6e-3)
    two = Reference.open(
        [str(closed_by(grasp_folder(tmp_path / "c", forces[1:2], lump=False), 0.5e-3)), single.results[0].folder]
    )
    np.testing.assert_allclose(two.response(0.5e-3).values, table.values)
    lower = two.response(0.25e-3).values / table.values
    assert lower.max() < 0.5


def test_a_model_that_cannot_be_had_is_told_in_words(tmp_path: Path) -> None:
    recording = result_recordings(grasp_folder(tmp_path / "a"))["taxel_force"]
    reference = Reference.open([str(grasp_folder(tmp_path / "b", taxel_forces(4, lump=0.0), lump=False))])
    choice = BY_NAME["model_based"]
    readings = frame_readings(recording.scene, recording.at(1.0), choice, reference)
    told = json.loads(estimate_message(recording.scene, readings, choice, reference))
    assert told["fault"]
    assert not told["fault"].startswith("internal error")
    assert (told["present"], told["inclusions"]) == (None, [])


@pytest.mark.parametrize(
    ("lump", "strength", "words"),
    [(True, 0.0, "Missed: there is one inclusion"), (False, 1.0, "False alarm"), (False, 0.0, "True: there is no inclusion")],
)
def test_an_estimate_is_held_against_the_truth(tmp_path: Path, lump: bool, strength: float, words: str) -> None:
    recording = result_recordings(grasp_folder(tmp_path / "a", taxel_forces(1, lump=strength), lump=lump))["taxel_force"]
    choice = BY_NAME["thesis"]
    found = estimated(recording.scene, frame_readings(recording.scene, recording.frame(0), choice, None), choice, None)
    assert found["errors"][0].startswith(words)


def test_pictures_end_at_the_largest_value_so_far(tmp_path: Path) -> None:
    recording = result_recordings(grasp_folder(tmp_path / "a"))["taxel_force"]
    scales = Scales()
    for time in (1.0, 0.25):
        readings = frame_readings(recording.scene, recording.at(time), BY_NAME["thesis"], None)
        message = frame_message(recording.scene, recording.at(time), readings, scales)
        assert max(message[-18000:]) == pytest.approx(255 * time, abs=1)


@pytest.mark.parametrize("shape", [(3, 3), (1, 1), (1, 6), (5, 2), (16, 16)])
def test_the_scale_of_a_recording_holds_all_of_its_pictures(shape: tuple[int, int]) -> None:
    """A picture is as bright as both arrays together, the top view as two rows: a scale of one array grew while it played."""
    signal = np.random.default_rng(0).uniform(0.1, 1.0, (2, *shape))
    scales = Scales()
    scales.take_range([(signal, signal)])
    drawn = views(signal)
    for picture, end in zip((drawn.front, drawn.left, drawn.top), scales.ends, strict=False):
        assert 0.9 * end < picture.max() <= end


def test_a_sample_shows_what_the_store_holds_and_where_the_lump_was(tmp_path: Path) -> None:
    samples = Samples.open(made_up_store(tmp_path))
    recording = samples.recordings(3)["taxel_force"]
    np.testing.assert_allclose(recording.forces[0], 1.3 * taxel_forces(1)[0])
    assert recording.scene.inclusions is not None
    center = samples.data["inclusion_center"].values[3, 0]
    np.testing.assert_allclose(recording.scene.inclusions[0].center, center)  # type: ignore[attr-defined]
    failed = samples.recordings(4)["taxel_force"]
    assert not failed.valid.any()
    assert failed.scene.notes == ("sample 4 is failed: ConvergenceError: residual <i>1</i>",)
    assert samples.recordings(5)["taxel_force"].scene.notes == ("sample 5 is pending: it was not computed",)


def test_a_sample_that_is_gone_since_the_data_set_was_opened_is_said_to_be_gone(tmp_path: Path) -> None:
    samples = Samples.open(made_up_store(tmp_path))
    for chunk in (samples.place / "taxel_force" / "c").rglob("*"):
        if chunk.is_file():
            chunk.unlink()
    with pytest.raises(StorageError, match=r"lumps\.zarr has holes: taxel_force of 1 samples \(0\) are gone"):
        samples.recordings(0)
    shutil.rmtree(samples.place)
    with pytest.raises(StorageError, match=r"no such folder: .*lumps\.zarr"):
        samples.recordings(1)


def test_samples_are_sought_in_both_directions_and_around_the_end(tmp_path: Path) -> None:
    samples = Samples.open(made_up_store(tmp_path))
    assert samples.chosen(status="done").tolist() == [0, 1, 2, 3]
    parts = [samples.chosen(name).tolist() for name in samples.splits]
    assert sorted(number for part in parts for number in part) == list(range(6))
    assert [samples.near(1, move, status="done") for move in (-1, 0, 1)] == [0, 1, 2]
    assert [samples.near(number, move, status="done") for number, move in ((0, -1), (3, 1))] == [3, 0]
    assert [samples.near(0, move, status="failed") for move in (-1, 0, 1)] == [4, 4, 4]
    empty = next(name for name in samples.splits if not len(samples.chosen(name, "failed")))
    assert samples.near(0, 1, empty, "failed") is None
    with pytest.raises(InputError, match="unknown split 'x'; known: train"):
        samples.chosen("x")


def test_samples_of_another_version_are_shown_without_inclusions(tmp_path: Path) -> None:
    samples = Samples.open(made_up_store(tmp_path))
    other = samples.data.assign(case_id=("sample", ["0" * 16] * 6))
    recording = Samples(samples.place, other).recordings(0)["taxel_force"]
    np.testing.assert_allclose(recording.forces[0], taxel_forces(1)[0])
    assert recording.scene.inclusions is None
    assert recording.scene.notes[0].startswith("this sample was made from another case")
    assert samples.recordings(0)["taxel_force"].scene.inclusions


def test_the_noise_is_that_of_the_result_unless_another_is_given(tmp_path: Path) -> None:
    rounded = result_recordings(grasp_folder(tmp_path / "a"))["taxel_force"]
    folder = change(localized_folder(tmp_path / "b"), ("scene", "noise"), 1e-3)
    told = result_recordings(folder)["taxel_force"]
    thesis = BY_NAME["thesis"]
    largest = taxel_forces().max()
    assert frame_readings(rounded.scene, rounded.frame(0), thesis, None).noise == pytest.approx(0.006 * largest)
    read = replace(rounded.frame(0), noise=source_noise("read_force", rounded.forces, rounded.valid))
    assert frame_readings(rounded.scene, read, thesis, None).noise == pytest.approx(0.1 / 12**0.5), "by sensors of the thesis"
    assert source_noise("taxel_force", 0 * rounded.forces, rounded.valid).deviation == pytest.approx(0.1 / 12**0.5)
    assert frame_readings(told.scene, told.frame(0), thesis, None).noise == 1e-3
    assert frame_readings(told.scene, told.frame(0), thesis, None, 5e-3).noise == 5e-3
    assert opened_content(folder, noise=2e-3).noise == 2e-3


def test_a_small_loss_over_a_soft_lump_is_found_and_the_estimate_says_on_which_noise_it_rests(tmp_path: Path) -> None:
    plain = grasp_folder(tmp_path / "plain", taxel_forces(1), lump=False)
    soft = taxel_forces(1)
    soft[0, :, 1, 1] -= 0.027  # as ``grasp_lump_icf`` against ``grasp_plain``: 54 mN of both jaws
    recording = result_recordings(grasp_folder(tmp_path / "soft", soft))["taxel_force"]
    scene, frame = recording.scene, recording.frame(0)
    choice, reference = BY_NAME["thesis with reference"], Reference.open([str(plain)])
    stated = estimated(scene, frame_readings(scene, frame, choice, reference), choice, reference)
    assert stated["present"]
    assert "0.6 % of the largest force" in stated["noise"]
    given = estimated(scene, frame_readings(scene, frame, choice, reference, 29e-3), choice, reference)
    assert not given["present"]
    noise = "Noise of 29 mN on each taxel (one standard deviation): as given by --noise; start with --noise FORCE for another"
    assert given["noise"] == noise
