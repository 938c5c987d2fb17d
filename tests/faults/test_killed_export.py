"""An export dies, or its disk fails, at every single step on the disk: its place holds all of it or nothing."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest
from failing_disk import At, Killed, disk
from sweeps import small_store

from tactsim.cli import main
from tactsim.dataset.use import export
from tactsim.errors import StorageError
from tactsim.storage.building import MARK

STRIDE = 7
"""Steps between those that the quick run tries; a prime, so that it meets every kind of step."""
EVERY = pytest.mark.parametrize("every", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["some", "every"])


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small store with a card."""
    store = small_store(tmp_path_factory.mktemp("kept"))
    (store / "README.md").write_text("# A small sweep\n", encoding="utf-8")
    return store


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch, hdf5_here: None) -> None:
    """HDF5 is written here instead of in a process of its own, whose end is tried apart."""
    monkeypatch.setattr(export, "SHARD_SAMPLES", 10)


def exported(store: Path, place: Path) -> int:
    """Exit code of ``tactsim data export``."""
    return main(["data", "export", str(store), "--to", str(place)])


def is_whole(place: Path) -> bool:
    """Whether an export is there, and all of it; refuses a part."""
    if not place.exists():
        return False
    if place.suffix == ".h5":
        with h5py.File(place) as file:
            assert np.isfinite(file["force"][...]).all()
            assert file["card"][()].decode().startswith("# A small sweep\n\n## This export\n")
    else:
        names = ["README.md", "dataset.json", "index.parquet", *(f"shard_{number:05d}.npz" for number in range(3))]
        assert sorted(os.listdir(place)) == names
        assert all((place / name).stat().st_size for name in names)
    return True


def chosen(total: int, every: bool) -> Iterator[int]:
    """Steps to try, the last among them."""
    yield from range(total, 0, -1 if every else -STRIDE)


@EVERY
@pytest.mark.parametrize("name", ["flat", "whole.h5"])
def test_a_death_at_any_step_leaves_all_or_nothing(kept: Path, tmp_path: Path, name: str, every: bool) -> None:
    counter = At(0)
    with disk(counter):
        assert exported(kept, tmp_path / name) == 0
    seen = set()
    for number in chosen(counter.count, every):
        place = tmp_path / str(number) / name
        with suppress(Killed), disk(At(number)):
            exported(kept, place)
        seen.add(is_whole(place))
        taken = place.exists()
        assert exported(kept, place) == (5 if taken else 0)
        assert is_whole(place)
        assert os.listdir(place.parent) == [name]
    assert seen == {False, True}


@EVERY
@pytest.mark.parametrize("name", ["flat", "whole.h5"])
def test_a_disk_that_fails_once_leaves_nothing_half_written(
    kept: Path, tmp_path: Path, name: str, every: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    counter = At(0)
    with disk(counter):
        assert exported(kept, tmp_path / name) == 0
    for number in chosen(counter.count, every):
        place = tmp_path / str(number) / name
        with disk(At(number, lambda: OSError(errno.ENOSPC, "No space left on device"), for_good=False)):
            code = exported(kept, place)
        assert code in (0, 5)
        assert "internal error" not in capsys.readouterr().err
        assert is_whole(place) or code == 5
        taken = place.exists()
        assert exported(kept, place) == (5 if taken else 0)
        assert os.listdir(place.parent) == [name]


@pytest.mark.parametrize("name", ["flat", "whole.h5"])
def test_what_another_put_there_is_kept(kept: Path, tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    waiting = tmp_path / f".{name}.partial"
    waiting.write_text("mine")
    assert exported(kept, tmp_path / name) == 5
    assert "is not of tactsim; move it away" in capsys.readouterr().err
    assert waiting.read_text() == "mine"
    waiting.unlink()
    waiting.mkdir()
    (waiting / MARK).write_text("")
    assert exported(kept, tmp_path / name) == 0


def test_a_place_that_is_taken_meanwhile_is_not_replaced(kept: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("flat", "whole.h5"):
        place = tmp_path / name
        card = export._card
        monkeypatch.setattr(export, "_card", lambda *what, place=place, card=card: (place.write_text("mine"), card(*what))[1])
        with pytest.raises(StorageError, match="exists"):
            export.exported(kept, place)
        assert place.read_text() == "mine"


@pytest.mark.parametrize("name", ["pipe", "link", "folder", "store"])
def test_places_that_are_taken_are_refused(kept: Path, tmp_path: Path, name: str) -> None:
    place = kept / "x.h5" if name == "store" else tmp_path / "x"
    if name == "pipe":
        os.mkfifo(place)
    elif name == "link":
        place.symlink_to(tmp_path / "nowhere")
    elif name == "folder":
        place.mkdir()
    before = sorted(tmp_path.iterdir())
    assert exported(kept, place) == 5
    assert sorted(tmp_path.iterdir()) == before
    assert not (kept / "x.h5").exists()
