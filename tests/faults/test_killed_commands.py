"""`tactsim run` and `tactsim validate`, killed or refused at every step on the disk: the old files, the new ones, or a word."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from failing_disk import At, Killed, disk

from tactsim.cli import main
from tactsim.errors import StorageError
from tactsim.results import read_result
from tactsim.storage.own_files import read_manifest

MOST_STEPS = 150


def steps_of(command: Callable[[], object]) -> int:
    """Number of steps on the disk that a command takes."""
    counter = At(0, Killed, for_good=False)
    with disk(counter):
        command()
    return counter.count


def mark_of(out: Path) -> object:
    """What a reader finds in a folder, which must be as its manifest says; None if there is none."""
    if not out.exists():
        return None
    manifest = read_manifest(out)
    assert manifest is not None
    assert manifest.foreign(out) == []
    assert all((out / name).exists() for name in manifest.files), "a file of the new set is missing"
    return (
        "x" in read_result(out, fields=False).provenance["overrides"][-1]
        if (out / "result.json").exists()
        else (out / "validation.md").read_text()
    )


@pytest.fixture
def run(case_file: Path) -> Callable[[Path, str], int]:
    """Runs the pretended case into a folder, with a title by which its result is known."""
    return lambda out, title: main(["run", str(case_file), "--out", str(out), "--force", "--set", f"title={title}"])


@pytest.mark.parametrize("stride", [2, pytest.param(1, marks=pytest.mark.slow)])
def test_a_run_killed_at_any_step_leaves_the_old_or_the_new(tmp_path: Path, run: Callable[[Path, str], int], stride: int) -> None:
    run(tmp_path / "count" / "out", "old")
    total = steps_of(lambda: run(tmp_path / "count" / "out", "x"))
    assert 15 < total < MOST_STEPS
    seen = set()
    for number in range(stride, total + 1, stride):
        out = tmp_path / str(number) / "out"
        run(out, "old")
        with suppress(Killed), disk(At(number, Killed, for_good=True)):
            run(out, "x")
        seen.add(mark_of(out))
        assert mark_of(out) in (None, False, True)
        if mark_of(out) is None:
            assert mark_of(out.with_name(".out.replaced")) is False, "the old one waits for the next run"
        assert run(out, "next") == 0
        assert mark_of(out) is True
        assert os.listdir(out.parent) == ["out"]
    assert seen == {None, False, True}


STRIDES = [
    (errno.ENOSPC, 2),
    (errno.EIO, 5),
    *(pytest.param(code, 1, marks=pytest.mark.slow) for code in (errno.ENOSPC, errno.EIO)),
]
"""Steps between those that are refused: quickly two for a full disk; a broken one goes the same way, and has fewer tried."""


@pytest.mark.parametrize(("code", "stride"), STRIDES)
def test_a_run_refused_at_any_step_says_so_and_loses_nothing(
    tmp_path: Path, run: Callable[[Path, str], int], capsys: pytest.CaptureFixture[str], code: int, stride: int
) -> None:
    out = tmp_path / "out"
    run(out, "old")
    total = steps_of(lambda: run(out, "x"))
    for number in range(stride, total + 1, stride):
        run(out, "old")
        capsys.readouterr()
        with disk(At(number, lambda: OSError(code, os.strerror(code)), for_good=False)):
            ended = run(out, "x")
        printed = capsys.readouterr().err
        assert ended in (0, 5)
        assert mark_of(out) is (ended == 0)
        assert (os.strerror(code) in printed) == (ended == 5)
        assert "internal" not in printed


def test_a_set_of_files_killed_at_any_step_is_the_old_or_the_new(tmp_path: Path) -> None:
    from tactsim.results.writing import write_files

    def write(out: Path, mark: str) -> None:
        write_files({"validation.md": mark.encode(), "validation.json": mark.encode(), "figures/a.png": mark.encode()}, out)

    total = steps_of(lambda: write(tmp_path / "count", "0"))
    for number in range(1, total + 8):
        out = tmp_path / str(number) / "out"
        write(out, "old")
        with suppress(Killed), disk(At(number, Killed, for_good=True)):
            write(out, "new")
        seen = mark_of(out if out.exists() else out.with_name(".out.replaced"))
        assert seen in ("old", "new")
        write(out, "next")
        assert mark_of(out) == "next"


def test_validate_replaces_only_what_it_wrote(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["validate", "appendix_a", "--out", str(out)]) == 0
    assert main(["validate", "appendix_a", "--out", str(out)]) == 0
    (out / "notes.md").write_text("mine", encoding="utf-8")
    assert main(["validate", "appendix_a", "--out", str(out)]) == StorageError.exit_code
    assert "'notes.md', which tactsim did not write" in capsys.readouterr().err
    assert (out / "notes.md").exists()
