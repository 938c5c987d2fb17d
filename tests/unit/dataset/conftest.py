"""Tests of data sets do without waiting for the disk; that what is needed is synced is tested in test_durability.py."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from sweeps import small_store

from tactsim.dataset.store import blocks as journal
from tactsim.dataset.store import writing as store_writing
from tactsim.storage import building


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (building, journal, store_writing):
        monkeypatch.setattr(module, "sync", lambda path: None)


@pytest.fixture(scope="session")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small store that stays as it is."""
    return small_store(tmp_path_factory.mktemp("kept"))


@pytest.fixture
def store(kept: Path, tmp_path: Path) -> Path:
    """The same to be spoilt."""
    return Path(shutil.copytree(kept, tmp_path / "small.zarr"))
