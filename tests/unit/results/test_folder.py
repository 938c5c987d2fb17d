"""The claim of one run on its output folder."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tactsim.errors import StorageError
from tactsim.results.folder import claimed
from tactsim.results.writing import write_files
from tactsim.storage.own_files import read_manifest


def publish(path: Path, mark: str = "new", *, replace: bool = False, keep: bool = False) -> Path | None:
    with claimed(path, replace=replace) as folder:
        (folder.start() / "result.json").write_text(mark, encoding="utf-8")
        folder.finish()
        return folder.publish(keep)


def make_result(path: Path, mark: str = "old") -> None:
    publish(path, mark)


def make_without_manifest(path: Path, mark: str = "old") -> None:
    path.mkdir(parents=True)
    (path / "result.json").write_text(mark, encoding="utf-8")


def mark_of(path: Path) -> str:
    return (path / "result.json").read_text(encoding="utf-8")


def test_the_folder_appears_complete_and_alone(tmp_path: Path) -> None:
    publish(tmp_path / "deep" / "out")
    assert mark_of(tmp_path / "deep" / "out") == "new"
    assert os.listdir(tmp_path / "deep") == ["out"]


def test_nothing_stays_of_a_claim_that_was_not_published(tmp_path: Path) -> None:
    with claimed(tmp_path / "out") as folder:
        (folder.start() / "result.json").write_text("half", encoding="utf-8")
    assert os.listdir(tmp_path) == []


def test_an_earlier_result_needs_permission_to_give_way(tmp_path: Path) -> None:
    make_result(tmp_path / "out")
    with pytest.raises(StorageError, match="--force"):
        publish(tmp_path / "out")
    assert mark_of(tmp_path / "out") == "old"
    assert publish(tmp_path / "out", replace=True) is None
    assert mark_of(tmp_path / "out") == "new"
    assert os.listdir(tmp_path) == ["out"]


@pytest.mark.parametrize("keep", [False, True])
def test_an_empty_folder_is_no_earlier_result(tmp_path: Path, keep: bool) -> None:
    (tmp_path / "out").mkdir()
    assert publish(tmp_path / "out", keep=keep) is None
    assert mark_of(tmp_path / "out") == "new"
    assert os.listdir(tmp_path) == ["out"]


def test_an_earlier_result_can_be_kept(tmp_path: Path) -> None:
    make_result(tmp_path / "out")
    assert publish(tmp_path / "out", replace=True, keep=True) == tmp_path / "out.earlier"
    assert publish(tmp_path / "out", "newer", replace=True, keep=True) == tmp_path / "out.earlier"
    assert (mark_of(tmp_path / "out"), mark_of(tmp_path / "out.earlier")) == ("newer", "new")


def test_an_empty_folder_may_be_filled(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    publish(tmp_path / "out")
    assert mark_of(tmp_path / "out") == "new"


@pytest.mark.parametrize("make", [make_result, make_without_manifest])
@pytest.mark.parametrize("name", ["notes.txt", ".git", "fields_x.vtu", "figures/x.zip", "figures/deep/x.png", "empty/"])
def test_a_folder_with_other_files_never_gives_way(tmp_path: Path, name: str, make: Callable[[Path], None]) -> None:
    make(tmp_path / "out")
    place = tmp_path / "out" / name
    place.parent.mkdir(exist_ok=True, parents=True)
    place.mkdir() if name.endswith("/") else place.write_text("mine", encoding="utf-8")
    with pytest.raises(StorageError, match="which tactsim did not write"):
        publish(tmp_path / "out", replace=True)
    assert place.exists()


@pytest.mark.parametrize("make", [make_result, make_without_manifest, Path.mkdir])
def test_another_result_within_a_folder_is_named_as_one(tmp_path: Path, make: Callable[[Path], None]) -> None:
    """It was said of its files that tactsim did not write them."""
    make(tmp_path / "out")
    publish(tmp_path / "out" / "second")
    with pytest.raises(StorageError, match=r"holds 'second', which is another result or report of tactsim; move"):
        publish(tmp_path / "out", replace=True)
    assert mark_of(tmp_path / "out" / "second") == "new"


def test_a_file_that_somebody_changed_never_gives_way(tmp_path: Path) -> None:
    make_result(tmp_path / "out")
    (tmp_path / "out" / "result.json").write_text("my notes", encoding="utf-8")
    with pytest.raises(StorageError, match=r"'result.json', which was changed since tactsim wrote it"):
        publish(tmp_path / "out", replace=True)
    assert mark_of(tmp_path / "out") == "my notes"


def test_a_result_without_a_manifest_is_kept_beside_the_new_one(tmp_path: Path) -> None:
    for number, mark in enumerate(("first", "second"), 1):
        make_without_manifest(tmp_path / "out", mark)
        kept = publish(tmp_path / "out", replace=True)
        assert kept == tmp_path / f"out.earlier{'' if number == 1 else '-2'}"
        assert mark_of(kept) == mark
        shutil.rmtree(tmp_path / "out")


def test_half_written_files_are_removed_but_not_those_of_others(tmp_path: Path) -> None:
    (tmp_path / ".out.partial").mkdir()
    (tmp_path / ".out.partial" / "fields_0001.vtu").write_text("half", encoding="utf-8")
    publish(tmp_path / "out")
    (tmp_path / ".out.partial").mkdir()
    (tmp_path / ".out.partial" / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(StorageError, match=r"'mine.txt', which tactsim did not write"):
        publish(tmp_path / "out", replace=True)
    assert (tmp_path / ".out.partial" / "mine.txt").exists()


def test_a_folder_without_a_result_never_gives_way(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir(parents=True)
    (tmp_path / "out" / "history.csv").write_text("", encoding="utf-8")
    with pytest.raises(StorageError, match="holds no result of tactsim"):
        publish(tmp_path / "out", replace=True)


def test_a_file_or_a_link_in_the_place_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x", encoding="utf-8")
    make_result(tmp_path / "real")
    os.symlink(tmp_path / "real", tmp_path / "link")
    os.symlink(tmp_path / "nowhere", tmp_path / "dangling")
    for name in ("file", "link", "dangling"):
        with pytest.raises(StorageError, match="is not a folder"):
            publish(tmp_path / name, replace=True)


def test_two_runs_do_not_share_a_folder(tmp_path: Path) -> None:
    with (
        claimed(tmp_path / "out"),
        pytest.raises(StorageError, match="in use by another run"),
        claimed(tmp_path / "out", replace=True),
    ):
        pass
    publish(tmp_path / "out")


def test_a_folder_that_appears_during_the_run_is_not_overwritten(tmp_path: Path) -> None:
    with claimed(tmp_path / "out") as folder:
        (folder.start() / "result.json").write_text("new", encoding="utf-8")
        make_without_manifest(tmp_path / "out", "other")
        with pytest.raises(StorageError, match="exists"):
            folder.publish()
    assert mark_of(tmp_path / "out") == "other"


def test_a_parent_removed_during_the_run_is_made_again(tmp_path: Path) -> None:
    with claimed(tmp_path / "results" / "out") as folder:
        os.rename(tmp_path / "results", tmp_path / "moved")
        (folder.start() / "result.json").write_text("new", encoding="utf-8")
        folder.publish()
    assert mark_of(tmp_path / "results" / "out") == "new"


def test_files_of_any_name_are_replaced_again_and_again(tmp_path: Path) -> None:
    """The third comparison was refused: the second had left the first in a hidden folder, whose manifest nobody read."""
    for number in range(3):
        files = {"comparison.csv": b"%d" % number, "comparison.md": b"", "parts/a.txt": b""}
        write_files(files, tmp_path / "comparison")
        assert (tmp_path / "comparison" / "comparison.csv").read_bytes() == b"%d" % number
        assert os.listdir(tmp_path) == ["comparison"]


def test_files_of_any_name_of_which_a_dead_run_left_a_part_are_tidied(tmp_path: Path) -> None:
    left = write_files({"comparison.csv": b"old", "parts/a.txt": b""}, tmp_path / ".comparison.replaced")
    left.rename(tmp_path / "kept")
    write_files({"comparison.csv": b"new"}, tmp_path / "comparison")
    (tmp_path / "kept" / "parts" / "a.txt").unlink()
    (tmp_path / "kept").rename(left)
    write_files({"comparison.csv": b"newer"}, tmp_path / "comparison")
    assert os.listdir(tmp_path) == ["comparison"]
    write_files({"comparison.csv": b"old"}, left)
    (left / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(StorageError, match=r"'mine.txt', which tactsim did not write"):
        write_files({"comparison.csv": b"newest"}, tmp_path / "comparison")
    assert (left / "mine.txt").exists()


def test_what_a_dead_run_left_is_tidied(tmp_path: Path) -> None:
    (tmp_path / ".out.lock").write_text("", encoding="utf-8")
    (tmp_path / ".out.partial").mkdir()
    make_result(tmp_path / ".out.replaced")
    with pytest.raises(StorageError, match="--force"):
        publish(tmp_path / "out")
    assert mark_of(tmp_path / "out") == "old"
    assert os.listdir(tmp_path) == ["out"]


@pytest.mark.parametrize("name", ["x" * 300, "a\0b", "file/out"])
def test_impossible_places_are_reported(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("x", encoding="utf-8")
    with pytest.raises(StorageError, match="cannot write"):
        publish(tmp_path / name)
    with pytest.raises(StorageError, match="cannot write /"):
        publish(Path("/"))


def test_the_current_folder_is_refused_like_any_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine").write_text("x", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StorageError, match="did not write"):
        publish(Path("."), replace=True)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ('{"files": {"a.csv": 3}}', "files.a.csv: Input should be a valid dictionary or instance of WrittenFile"),
        ('{"schema_version": true, "files": {}}', "schema_version: Input should be a valid integer"),
        ('{"schema_version": 2, "files": {}}', "schema_version: Input should be less than or equal to 1"),
        (
            '{"files": {"a.csv": {"size": true, "sha256": "%s"}}}' % ("0" * 64),
            "files.a.csv.size: Input should be a valid integer",
        ),
    ],
)
def test_a_manifest_of_another_form_is_told_by_its_place(tmp_path, text, fault):
    (tmp_path / "manifest.json").write_text(text, encoding="utf-8")
    with pytest.raises(StorageError) as told:
        read_manifest(tmp_path)
    assert str(told.value).endswith(f"manifest.json is damaged: {fault}")
