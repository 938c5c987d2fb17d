"""Meshes of other programs: promoted, turned right side out, or refused with the reason."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from solids import assert_close, box

from tactsim.errors import InputError, StorageError, UnknownName
from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh.reading import read_mesh

here = pytest.mark.usefixtures("reader_here")
LINEAR = box([2.0, 1.0, 1.0], [2, 1, 1])
CORNERS = LINEAR.nodes[: LINEAR.corner_count]
TETRA = LINEAR.elements[:, :4]
TAGS = np.where(CORNERS[TETRA].mean(axis=1)[:, 0] < 1, 7, 3)


def written(path, points=CORNERS, cells=(("tetra", TETRA),), tags=(TAGS,), name="gmsh:physical", **more):
    data = {name: [np.asarray(tag) for tag in tags]}
    if name == "gmsh:physical":
        data["gmsh:geometrical"] = data[name]
    mesh = meshio.Mesh(points, [(kind, np.asarray(nodes)) for kind, nodes in cells], cell_data=data if tags else None, **more)
    mesh.write(path, **({"file_format": "gmsh22", "binary": False} if path.suffix == ".msh" else {}))
    return path


def volume(mesh, region=None):
    weights = TaylorHood(mesh.nodes, mesh.elements, "solid").volume_points().weights.sum(axis=1)
    return weights.sum() if region is None else weights[mesh.regions == region].sum()


@here
@pytest.mark.parametrize("ending", ["msh", "vtu", "vtk", "mesh"])
def test_linear_tetrahedra_are_promoted_and_scaled(ending, tmp_path):
    name = {"msh": "gmsh:physical", "mesh": "medit:ref"}.get(ending, "region")
    mesh = read_mesh(written(tmp_path / f"a.{ending}", name=name), {7: 0, 3: 1}, unit="mm")
    assert_close(volume(mesh), 2e-9, 1e-12)
    assert_close(volume(mesh, 1), 1e-9, 1e-12)
    assert len(mesh.nodes) == len(LINEAR.nodes)


@here
def test_quadratic_tetrahedra_keep_their_curved_edges(tmp_path):
    nodes = LINEAR.nodes.copy()
    moved = LINEAR.elements[0, 4]
    nodes[moved] += 0.01
    order = np.random.default_rng(0).permutation(len(nodes))
    shuffled, back = nodes[order], np.argsort(order)
    path = written(tmp_path / "a.vtu", shuffled, [("tetra10", back[LINEAR.elements])], name="region")
    mesh = read_mesh(path, {7: 1, 3: 0}, unit="m")
    assert_close(mesh.nodes[mesh.elements], nodes[LINEAR.elements], 1e-12)
    assert mesh.corner_count == LINEAR.corner_count
    assert set(mesh.regions) == {0, 1}


@here
@pytest.mark.parametrize("kind", ["tetra", "tetra10"])
def test_elements_numbered_the_other_way_round_are_turned(kind, tmp_path):
    mirror = [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]
    elements = LINEAR.elements[:, mirror] if kind == "tetra10" else TETRA[:, mirror[:4]]
    points = LINEAR.nodes if kind == "tetra10" else CORNERS
    mesh = read_mesh(written(tmp_path / "a.vtu", points, [(kind, elements)], name="region"), unit="m")
    assert_close(volume(mesh), 2.0, 1e-12)


@here
def test_an_element_turned_inside_out_by_a_middle_node_is_refused(tmp_path):
    nodes = LINEAR.nodes.copy()
    nodes[LINEAR.elements[0, 4]] = nodes[LINEAR.elements[0, 3]] + 0.3
    with pytest.raises(InputError, match="inside out"):
        read_mesh(written(tmp_path / "a.vtu", nodes, [("tetra10", LINEAR.elements)], name="region"), unit="m")


@here
def test_named_groups_of_gmsh_may_be_used(tmp_path):
    path = written(tmp_path / "a.msh", field_data={"lump": np.array([3, 3]), "tissue": np.array([7, 3])})
    mesh = read_mesh(path, {"tissue": 0, "lump": 1}, unit="m")
    assert_close(volume(mesh, 1), 1.0, 1e-12)
    with pytest.raises(UnknownName, match="lump"):
        read_mesh(path, {"tissue": 0, "lumb": 1}, unit="m")


TRIANGLE = ("triangle", TETRA[:1, :3])
NOT_FINITE = np.where(np.arange(len(CORNERS))[:, None] == 2, np.nan, CORNERS)
BAD = {
    "mixed": ({"cells": (("tetra", TETRA), ("tetra10", LINEAR.elements[:1])), "points": LINEAR.nodes, "tags": ()}, "tetra10"),
    "hexahedra": ({"cells": (("hexahedron", np.arange(8)[None]),), "tags": ([1],)}, "hexahedron"),
    "triangles only": ({"cells": (TRIANGLE,), "tags": ([1],)}, "no tetrahedra"),
    "not finite": ({"points": NOT_FINITE}, "finite"),
    "negative": ({"cells": (("tetra", np.where(TETRA == 3, -1, TETRA)),)}, "run from|damaged|Couldn|index"),
    "beyond": ({"cells": (("tetra", np.where(TETRA == 3, 999, TETRA)),)}, "run from"),
    "flat": ({"cells": (("tetra", np.array([[0, 1, 2, 2]])),), "tags": ([7],)}, "flat|tags"),
    "doubled nodes": (
        {"points": np.vstack([CORNERS, CORNERS]), "cells": (("tetra", np.vstack([TETRA[:6], TETRA[6:] + len(CORNERS)])),)},
        "coincide",
    ),
    "overlapping": ({"cells": (("tetra", np.vstack([TETRA, TETRA, TETRA])),), "tags": (np.tile(TAGS, 3),)}, "more than two"),
}


@here
@pytest.mark.parametrize("name", BAD)
def test_a_mesh_that_cannot_be_used_is_refused_with_its_reason(name, tmp_path):
    change, reason = BAD[name]
    path = written(tmp_path / "bad.vtu", **{"name": "region", **change})
    with pytest.raises((InputError, StorageError), match=reason):
        read_mesh(path, {7: 0, 3: 1} if name not in ("mixed",) else None, unit="m")


@here
@pytest.mark.parametrize(
    ("region_map", "reason"), [({7: 0}, r"without a region: \[3\]"), ({7: 0, 3: 1, 5: 2}, r"\[5\]"), ({7: 0, 3: 2}, "gaps")]
)
def test_every_tag_needs_its_region_and_every_region_its_tag(region_map, reason, tmp_path):
    with pytest.raises(InputError, match=reason):
        read_mesh(written(tmp_path / "a.msh"), region_map, unit="m")


@here
def test_a_region_map_needs_tags_and_a_unit_must_be_known(tmp_path):
    path = written(tmp_path / "a.vtu", tags=())
    with pytest.raises(InputError, match="no region tag"):
        read_mesh(path, {1: 0}, unit="m")
    with pytest.raises(UnknownName, match="unit"):
        read_mesh(path, unit="inch")
    assert (read_mesh(path, unit="m").regions == 0).all()


@pytest.mark.parametrize(
    ("ending", "share"),
    [
        pytest.param(ending, share, marks=() if share == (0.3 if ending in ("msh", "vtk") else 0.8) else pytest.mark.slow)
        for ending in ("msh", "vtu", "mesh", "vtk")
        for share in (0.0, 0.3, 0.8)
    ],
)
def test_a_truncated_file_is_refused_and_never_hangs(ending, share, tmp_path):
    name = {"msh": "gmsh:physical", "mesh": "medit:ref"}.get(ending, "region")
    path = written(tmp_path / f"a.{ending}", name=name)
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])
    with pytest.raises((StorageError, InputError)):
        read_mesh(path, {7: 0, 3: 1}, unit="m")


def test_a_file_that_is_absent_or_of_no_known_kind_is_refused(tmp_path):
    with pytest.raises(StorageError, match="cannot read"):
        read_mesh(tmp_path / "absent.msh", unit="m")
    (tmp_path / "a.txt").write_text("nothing")
    with pytest.raises(StorageError, match="cannot read"):
        read_mesh(tmp_path / "a.txt", unit="m")
