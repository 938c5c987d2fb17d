"""What the reader of a file of another program says of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.outside.files import opened
from tactsim.outside.library_warnings import collected_warnings
from tactsim.outside.mesh_files import MeshFileWarning, read_mesh_file

TRIANGLE = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
3
1 0 0 0
2 1 0 0
3 0 1 0
$EndNodes
$Elements
1
1 2 2 7 1 1 2 3
"""


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    """A mesh of Gmsh without its last line."""
    path = tmp_path / "cut.msh"
    path.write_text(TRIANGLE, encoding="ascii")
    return path


def test_warnings_of_the_reader_are_warnings_here(mesh: Path) -> None:
    with pytest.warns(MeshFileWarning, match=r"cut\.msh: \$Elements not closed by \$EndElements") as caught:
        loaded = read_mesh_file(opened(mesh, "mesh"))
    assert len(caught) == 1
    assert [kind for kind, _ in loaded.cells] == ["triangle"]


@pytest.mark.filterwarnings("default::tactsim.outside.mesh_files.MeshFileWarning")
def test_they_are_reported_as_those_of_the_library(mesh: Path) -> None:
    with collected_warnings() as collected:
        read_mesh_file(opened(mesh, "mesh"))
    assert [line.split(":")[0] for line in collected.lines()] == ["meshio"]


def test_a_whole_file_is_read_without_a_word(mesh: Path) -> None:
    mesh.write_text(TRIANGLE + "$EndElements\n", encoding="ascii")
    assert len(read_mesh_file(opened(mesh, "mesh")).cells) == 1
