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
from tactsim.results.folder import OutputFolder

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
    for number in range(1, steps_of_one_writing(tmp_path / "count") + 1):
        place = tmp_path / str(number) / "out"
        if earlier:
            write(place, "old")
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


@pytest.mark.parametrize("number", range(1, MOST_STEPS))
@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS, errno.EIO], ids=errno.errorcode.get)
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
