"""Whole files."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tactsim.errors import StorageError
from tactsim.storage import files


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "file"
    files.replace_file(place, b"first")

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(StorageError, match=r"cannot write .*file: No space left on device"):
        files.replace_file(place, b"second")
    assert place.read_bytes() == b"first"
    assert os.listdir(tmp_path) == ["file"]


def test_a_missing_folder_is_reported(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="No such file"):
        files.replace_file(tmp_path / "no" / "file", b"")


def test_a_file_where_a_folder_is_needed_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    said = pytest.raises(StorageError, match=r"cannot write .*file/sub/a: .*file is a file, not a folder; name another place")
    with said, files.naming(tmp_path / "file" / "sub" / "a"):
        (tmp_path / "file" / "sub").mkdir(parents=True)
