"""Shipped meshes and surfaces are found in the folder one works in, then where this program is kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.mesh.shipped import shipped_folders
from tactsim.outside.files import PROGRAM, Unreadable, opened, opened_folder

LUMP = "meshes/lump.stl"


def test_the_working_folder_comes_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert shipped_folders() == (Path("meshes"), PROGRAM / "meshes")
    monkeypatch.chdir(tmp_path)
    shipped = opened(LUMP, "surface")
    assert (shipped.path, shipped.place) == (PROGRAM / LUMP, "with the program")
    (tmp_path / "meshes").mkdir()
    (tmp_path / LUMP).write_bytes(b"mine")
    own = opened(LUMP, "surface")
    assert (own.path, own.place) == (Path(LUMP), "in the working folder")


def test_stored_results_come_with_the_program_too(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    assert opened_folder("cases/stored/grasp_lump", "result") == (PROGRAM / "cases/stored/grasp_lump", "with the program")


def test_only_shipped_files_are_looked_for_elsewhere(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    for path in (
        "README.md",
        "cases/grasp_stl.yaml",
        "cases/stored/../grasp_stl.yaml",
        "meshes/../README.md",
        "meshes/none.stl",
        str(tmp_path / "none.stl"),
    ):
        with pytest.raises(Unreadable, match="No such file"):
            opened(path, "surface")
