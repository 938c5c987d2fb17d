"""Shipped meshes and surfaces are found in the folder one works in, then in the checkout."""

from __future__ import annotations

from pathlib import Path

from tactsim.mesh.shipped import CHECKOUT, shipped_folders, shipped_path

LUMP = "meshes/lump.stl"


def test_the_working_folder_comes_first(monkeypatch, tmp_path):
    assert shipped_folders() == (Path("meshes"), CHECKOUT / "meshes")
    monkeypatch.chdir(tmp_path)
    assert shipped_path(LUMP) == CHECKOUT / LUMP
    (tmp_path / "meshes").mkdir()
    (tmp_path / LUMP).write_bytes(b"mine")
    assert shipped_path(LUMP) == Path(LUMP)


def test_only_shipped_files_are_looked_for_elsewhere(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for path in ("README.md", "cases/grasp_stl.yaml", "meshes/../README.md", "meshes/none.stl", str(tmp_path / "none.stl")):
        assert shipped_path(path) == Path(path)
