"""A result is written through a death, a full disk and a lost folder at every single step on the disk."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from failing_disk import At, Killed, disk
from pretence import PNG, pretended_result

from tactsim.errors import StorageError
from tactsim.results import Status, StepRecord, read_result, write_result
from tactsim.results.folder import OutputFolder, claimed
from tactsim.results.writing import fill
from tactsim.storage.own_files import MANIFEST

RESULT = pretended_result(Status.CONVERGED, "done", (StepRecord(1, 4, 1e-11, {"displacement": 1e-4}),))
MOST_STEPS = 60


def write(place: Path, case_id: str) -> None:
    write_result(RESULT, place, case_id=case_id, provenance={}, force=True, figures={"a.png": PNG})


def trouble_of(place: Path, act: Callable[[], None]) -> StorageError | None:
    """The refusal of a writing on a disk with trouble, if it was refused."""
    try:
        with disk(act):
            write(place, "new")
    except StorageError as error:
        return error
    return None


def steps_of_one_writing(place: Path) -> int:
    """Number of steps on the disk that replacing a result takes."""
    counter = At(0, Killed, for_good=False)
    write(place, "0")
    with disk(counter):
        write(place, "1")
    return counter.count


def test_the_harness_sees_the_steps(tmp_path: Path) -> None:
    assert 15 < steps_of_one_writing(tmp_path / "out") < MOST_STEPS


@pytest.mark.parametrize("earlier", [False, True])
def test_a_death_at_any_step_leaves_the_old_or_the_new(tmp_path: Path, earlier: bool) -> None:
    seen = set()
    write(tmp_path / "earlier" / "out", "old")
    for number in range(1, steps_of_one_writing(tmp_path / "count") + 1):
        place = tmp_path / str(number) / "out"
        if earlier:
            shutil.copytree(tmp_path / "earlier", place.parent)
        with suppress(Killed), disk(At(number, Killed, for_good=True)):
            write(place, "new")
        visible = read_result(place, fields=False).case_id if place.exists() else None
        assert visible in ({"old", "new", None} if earlier else {"new", None})
        seen.add(visible)
        if visible is None and earlier:
            assert read_result(place.with_name(".out.replaced"), fields=False).case_id == "old"
        write(place, "next")
        assert read_result(place, fields=False).case_id == "next"
        assert os.listdir(place.parent) == ["out"]
    assert seen == ({"old", "new", None} if earlier else {"new", None})


def ids_beside(place: Path) -> set[str]:
    """What is read in every folder beside a place, its own and hidden ones included."""
    return {read_result(folder, fields=False).case_id for folder in place.parent.iterdir() if (folder / "result.json").exists()}


def test_a_death_at_any_step_keeps_a_result_without_a_manifest(tmp_path: Path) -> None:
    write(tmp_path / "earlier" / "out", "old")
    (tmp_path / "earlier" / "out" / MANIFEST).unlink()
    for number in range(1, steps_of_one_writing(tmp_path / "count") + 5):
        place = tmp_path / str(number) / "out"
        shutil.copytree(tmp_path / "earlier", place.parent)
        with suppress(Killed), disk(At(number, Killed, for_good=True)):
            write(place, "new")
        assert "old" in ids_beside(place)
        write(place, "next")
        assert ids_beside(place) == {"old", "next"}
        assert read_result(place, fields=False).case_id == "next"
        assert set(os.listdir(place.parent)) == {"out", "out.earlier"}


def test_a_death_at_any_step_keeps_the_result_that_was_kept_before(tmp_path: Path) -> None:
    def write_beside(place: Path, case_id: str) -> None:
        with claimed(place, replace=True) as folder:
            fill(folder, RESULT, case_id=case_id, provenance={}, figures={})
            folder.publish(keep_earlier=True)

    counter = At(0)
    for case_id in ("older", "old"):
        write_beside(tmp_path / "earlier" / "out", case_id)
    shutil.copytree(tmp_path / "earlier", tmp_path / "count")
    with disk(counter):
        write_beside(tmp_path / "count" / "out", "2")
    for number in range(1, counter.count + 1):
        place = tmp_path / str(number) / "out"
        shutil.copytree(tmp_path / "earlier", place.parent)
        with suppress(Killed), disk(At(number, Killed, for_good=True)):
            write_beside(place, "new")
        assert "old" in ids_beside(place)
        with claimed(place, replace=True):
            assert ids_beside(place) in ({"older", "old"}, {"old"}, {"old", "new"})


@pytest.mark.parametrize("kept_before", [False, True])
def test_what_an_earlier_version_left_in_the_exchange_is_kept(tmp_path: Path, kept_before: bool) -> None:
    if kept_before:
        write(tmp_path / "out.earlier", "older")
    write(tmp_path / ".out.replaced", "old")
    (tmp_path / ".out.replaced" / MANIFEST).unlink()
    write(tmp_path / "out", "new")
    write(tmp_path / "out", "next")
    assert ids_beside(tmp_path / "out") == {"old", "next"}
    assert set(os.listdir(tmp_path)) == {"out", "out.earlier"}


OTHERS_AT = range(1, MOST_STEPS, 8)
"""Steps at which the quick run tries the two other reasons, which go the same way as a full disk."""


@pytest.mark.parametrize(
    ("code", "number"),
    [
        pytest.param(
            code,
            number,
            id=f"{errno.errorcode[code]}-{number}",
            marks=() if code == errno.ENOSPC or number in OTHERS_AT else pytest.mark.slow,
        )
        for code in (errno.ENOSPC, errno.EROFS, errno.EIO)
        for number in range(1, MOST_STEPS)
    ],
)
def test_a_refusing_disk_loses_nothing(tmp_path: Path, number: int, code: int) -> None:
    place = tmp_path / "out"
    write(place, "old")
    error = trouble_of(place, At(number, lambda: OSError(code, os.strerror(code)), for_good=False))
    assert read_result(place, fields=False).case_id == ("old" if error else "new")
    if error:
        assert str(place) in str(error)
        assert os.strerror(code) in str(error)
    write(place, "next")
    assert os.listdir(tmp_path) == ["out"]


def test_a_refusing_disk_leaves_nothing_half_written(tmp_path: Path) -> None:
    total = steps_of_one_writing(tmp_path / "count" / "out")
    for number in range(1, total):
        place = tmp_path / str(number) / "out"
        error = trouble_of(place, At(number, lambda: OSError(errno.ENOSPC, "full"), for_good=False))
        assert place.exists() == (error is None)


def test_a_careless_exchange_would_be_caught(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def careless(folder: OutputFolder, keep_earlier: bool = False) -> None:
        shutil.rmtree(folder.path, ignore_errors=True)
        folder.partial.rename(folder.path)

    monkeypatch.setattr(OutputFolder, "publish", careless)
    with pytest.raises(StorageError, match=r"which tactsim did not write|holds no result"):
        test_a_death_at_any_step_leaves_the_old_or_the_new(tmp_path, True)
