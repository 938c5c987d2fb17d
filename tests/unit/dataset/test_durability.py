"""What the journal forgets is on the disk before."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from sweeps import Inline, run_sweep, sweep_file

from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store import blocks as journal
from tactsim.dataset.store import writing as store_writing
from tactsim.dataset.store.blocks import JOURNAL
from tactsim.storage.files import sync

Synced = list[tuple[str, bytes]]
"""Path within the store and content of every file that was synced, in order; of a folder its names."""


@pytest.fixture
def synced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Synced:
    """What is synced while a sweep runs."""
    calls: Synced = []

    def recording(path: Path) -> None:
        held = "\n".join(sorted(place.name for place in path.iterdir())).encode() if path.is_dir() else path.read_bytes()
        if not path.is_relative_to(tmp_path / "s.zarr"):  # where it is made
            return
        calls.append((str(path.relative_to(tmp_path / "s.zarr")), held))
        sync(path)

    monkeypatch.setattr(store_writing, "sync", recording)
    monkeypatch.setattr(journal, "sync", recording)
    return calls


def not_durable(place: Path, synced: Synced) -> list[str]:
    """Files and folders of the arrays whose last content was not synced."""
    last, missing = dict(synced), []
    for path in (path for path in place.rglob("*") if "/" in str(path.relative_to(place))):
        name = str(path.relative_to(place))
        held = "\n".join(sorted(inner.name for inner in path.iterdir())).encode() if path.is_dir() else path.read_bytes()
        missing += [name] if last.get(name) != held else []
    return sorted(missing)


def test_every_chunk_is_on_the_disk_before_the_journal_forgets(
    tmp_path: Path, synced: Synced, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep, place = load_sweep(sweep_file(tmp_path)), tmp_path / "s.zarr"
    left: list[list[str]] = []
    clear = journal.Journal.clear
    monkeypatch.setattr(journal.Journal, "clear", checked(clear, lambda: left.append(not_durable(place, synced))))
    run_sweep(sweep, place)
    assert left[-1] == []
    order = [name for name, _ in synced]
    own = [name for name in order if name.startswith("status/c")]
    others = [number for number, name in enumerate(order) if "/c/" in name and not name.startswith("status/")]
    assert order.index(own[0]) > max(number for number in others if number < order.index(own[-1]))
    assert order.index(".") < order.index(own[0])  # the name of the journal


def test_a_chunk_that_is_not_synced_is_noticed(tmp_path: Path, synced: Synced) -> None:
    sweep, place = load_sweep(sweep_file(tmp_path)), tmp_path / "s.zarr"
    with opened_run(sweep, place) as going:
        going.compute(Inline(sweep), lambda tally: None)
        assert not (place / JOURNAL).exists()
    without = [(name, held) for name, held in synced if not name.startswith("force/c/")]
    assert not_durable(place, without)[:2] == ["force/c/0", "force/c/0/0"]


def checked(function: Callable[..., None], look: Callable[[], None]) -> Callable[..., None]:
    """The function with a look before."""

    def both(*arguments: object) -> None:
        look()
        function(*arguments)

    return both
