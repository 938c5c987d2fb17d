"""Tests of data sets do without waiting for the disk; that what is needed is synced is tested in test_durability.py."""

from __future__ import annotations

import pytest

from tactsim.dataset.store import blocks as journal
from tactsim.dataset.store import writing as store_writing
from tactsim.storage import building


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (building, journal, store_writing):
        monkeypatch.setattr(module, "sync", lambda path: None)
