"""A run that could not write its result for want of files that may be open is refused before it computes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tactsim.errors import StorageError
from tactsim.results import folder
from tactsim.results.folder import claimed


def full(descriptor: int) -> int:
    raise OSError(24, "Too many open files")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such limit")
def test_a_folder_is_not_claimed_where_nothing_could_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "dup", full)
    with (
        pytest.raises(StorageError, match=f"Too many open files; {folder.SPARE} files must be free .* ulimit -n 256"),
        claimed(tmp_path / "out"),
    ):
        raise AssertionError("nothing is computed")
    assert not (tmp_path / "out").exists()
