"""A sweep dies, or its disk fails, at every single step on the disk: readers see whole samples, the next run completes it."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from failing_disk import At, Killed, disk
from pretence import PNG
from sweeps import TEXT, assert_same, compute_once_here, content, run_sweep, sweep_file

from tactsim.cli import main
from tactsim.dataset import load
from tactsim.dataset.checking import check
from tactsim.dataset.figures import card as dataset_card
from tactsim.dataset.running import run as running
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.errors import TactsimError

SAMPLES, MORE = 4, 6
PLAIN = TEXT.replace("  reading: {chain: {sampling_rate: 200 Hz, noise: {white: 1 mV}}}\n", "").replace(
    "samples_per_specimen: 3", "samples_per_specimen: 2"
)
STRIDE, CREATION_STRIDE = 449, 61
"""Steps between those that the quick run tries, of a sweep and of its creation; primes, so that they meet every kind of step."""


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples are computed once, the figure is a dot, and the journal goes into the arrays after each task."""
    compute_once_here(monkeypatch)
    monkeypatch.setattr(dataset_card, "card_figures", lambda store: {"spread.png": lambda: PNG})
    monkeypatch.setattr(running, "MOST_IN_TASK", 2)
    monkeypatch.setattr(running, "FOLD_SAMPLES", 2)


def swept(place: Path, samples: int = SAMPLES) -> int:
    """Exit code of ``tactsim sweep``, with --resume if the store is there."""
    case = place.parent.parent / "sweep.yaml"
    resume = ["--resume"] if place.exists() else []
    return main(["sweep", str(case), "--out", str(place), "--samples", str(samples), "--quiet", *resume])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """Stores that nothing disturbed, by their number of samples."""
    folder = tmp_path_factory.mktemp("whole")
    sweep = sweep_file(folder, PLAIN)
    for samples in (SAMPLES, MORE):
        run_sweep(load_sweep(sweep, samples=samples), folder / f"{samples}.zarr")
    return {samples: folder / f"{samples}.zarr" for samples in (SAMPLES, MORE)}


def place_of(folder: Path, number: int, earlier: int = 0) -> Path:
    """Where a store is written, with one that an undisturbed run left if so many samples are ``earlier``."""
    if not (folder / "sweep.yaml").exists():
        sweep_file(folder, PLAIN)
    (folder / str(number)).mkdir()
    place = folder / str(number) / "s.zarr"
    if earlier:
        kept = folder / "earlier" / "s.zarr"
        if not kept.exists():
            kept.parent.mkdir()
            assert swept(kept, earlier) == 0
        shutil.copytree(kept, place)
    return place


_STEPS: dict[tuple[int, int], int] = {}


def steps(folder: Path, samples: int, earlier: int = 0) -> int:
    """Steps on the disk of an undisturbed run, counted once."""
    if (samples, earlier) not in _STEPS:
        _STEPS[samples, earlier] = _counted_steps(folder, samples, earlier)
    return _STEPS[samples, earlier]


def _counted_steps(folder: Path, samples: int, earlier: int) -> int:
    counter = At(0)
    place = place_of(folder, 0, earlier)
    with disk(counter):
        assert swept(place, samples) == 0
    return counter.count


def assert_whole_samples(place: Path, whole: Path, most: int) -> None:
    """Refuse a store that shows a reader anything but whole samples or a clear error."""
    if not place.exists():
        return
    try:
        seen = load(place)
        assert seen.sizes["sample"] <= most
        expected = content(whole)
        for name in seen.data_vars:
            if name in expected:
                np.testing.assert_array_equal(seen[name].values, expected[str(name)][seen["sample"].values], err_msg=str(name))
    except TactsimError:
        return


def assert_completed(place: Path, whole: Path, samples: int) -> None:
    """Refuse a store that the next run does not complete, or that differs from an undisturbed one."""
    assert swept(place, samples) == 0
    assert_same(whole, place)
    assert check(place).findings == ()
    assert os.listdir(place.parent) == ["s.zarr"]


def chosen(total: int, every: bool, stride: int = STRIDE) -> Iterator[int]:
    """Steps to try, the last among them."""
    yield from range(total, 0, -1 if every else -stride)


EVERY = pytest.mark.parametrize("every", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["some", "every"])


def test_the_harness_sees_the_steps(tmp_path: Path) -> None:
    assert 200 < steps(tmp_path, SAMPLES) < 2000


@EVERY
@pytest.mark.parametrize("earlier", [0, SAMPLES], ids=["new", "extended"])
def test_a_death_at_any_step_loses_nothing(tmp_path: Path, whole: dict[int, Path], earlier: int, every: bool) -> None:
    samples = MORE if earlier else SAMPLES
    for number in chosen(steps(tmp_path, samples, earlier), every):
        place = place_of(tmp_path, number, earlier)
        with suppress(Killed), disk(At(number)):
            swept(place, samples)
        assert_whole_samples(place, whole[samples], samples)
        assert_completed(place, whole[samples], samples)


@EVERY
def test_a_disk_that_fails_once_loses_nothing(
    tmp_path: Path, whole: dict[int, Path], every: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in chosen(steps(tmp_path, SAMPLES), every):
        place = place_of(tmp_path, number)
        with disk(At(number, lambda: OSError(errno.ENOSPC, "No space left on device"), for_good=False)):
            assert swept(place) in (0, 5)
        assert "internal error" not in capsys.readouterr().err
        assert_whole_samples(place, whole[SAMPLES], SAMPLES)
        assert_completed(place, whole[SAMPLES], SAMPLES)


@EVERY
def test_a_death_while_it_mends_loses_nothing(tmp_path: Path, whole: dict[int, Path], every: bool) -> None:
    def damaged(number: int) -> Path:
        place = place_of(tmp_path, number, SAMPLES)
        (place / "force/c/0/0").write_bytes(b"")
        (place / "displacement/zarr.json").unlink()
        return place

    counter, place = At(0), damaged(0)
    with disk(counter):
        assert swept(place) == 0
    for number in chosen(counter.count, every):
        place = damaged(number)
        with suppress(Killed), disk(At(number)):
            swept(place)
        assert_whole_samples(place, whole[SAMPLES], SAMPLES)
        assert_completed(place, whole[SAMPLES], SAMPLES)


def test_a_description_that_was_half_written_is_cleared_away(tmp_path: Path, whole: dict[int, Path]) -> None:
    """The death came while a description that was gone was made anew, so that its array is none of those described."""
    place = place_of(tmp_path, 1, SAMPLES)
    (place / "displacement/zarr.json").rename(place / f"displacement/zarr.{'0' * 32}.partial")
    assert_completed(place, whole[SAMPLES], SAMPLES)


def creations(folder: Path) -> Callable[[], None]:
    """A creation alone, without any sample."""
    sweep = load_sweep(sweep_file(folder, PLAIN), samples=SAMPLES)

    def create() -> None:
        with opened_run(sweep, folder / "s.zarr"):
            pass

    return create


@EVERY
def test_a_death_at_any_step_of_the_creation_leaves_a_whole_store_or_none(tmp_path: Path, every: bool) -> None:
    create, counter = creations(tmp_path), At(0)
    with disk(counter):
        create()
    seen = set()
    for number in chosen(counter.count, every, CREATION_STRIDE):
        for path in sorted((tmp_path / "s.zarr").rglob("*"), reverse=True):
            path.unlink() if path.is_file() else path.rmdir()
        (tmp_path / "s.zarr").rmdir()
        with suppress(Killed), disk(At(number)):
            create()
        seen.add((tmp_path / "s.zarr").exists())
        if (tmp_path / "s.zarr").exists():
            assert load(tmp_path / "s.zarr").sizes["sample"] == 0
            with opened_run(load_sweep(tmp_path / "sweep.yaml", samples=SAMPLES), tmp_path / "s.zarr", resume=True):
                pass
        else:
            create()
        assert sorted(os.listdir(tmp_path)) == ["s.zarr", "sweep.yaml"]
    assert seen == {False, True}


def test_what_another_put_in_the_place_of_a_leftover_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = place_of(tmp_path, 1)
    mine = place.with_name(".s.zarr.partial")
    mine.mkdir()
    (mine / "notes.txt").write_text("mine")
    assert swept(place) == 5
    assert "is not of tactsim; move it away" in capsys.readouterr().err
    assert (mine / "notes.txt").read_text() == "mine"
    assert not place.exists()
