"""Makes the meshes that are shipped with the cases: ``python meshes/make.py`` makes the missing ones and drops unused ones.

A mesh is looked up by the key that the case itself gives, so that a changed case gets another mesh. The mesher gives another mesh
every time; results of the shipped cases repeat because their meshes are kept here. The irregular lump is made the same way.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from tactsim.case import load_case
from tactsim.experiments.grasp.model import grasp_mesh
from tactsim.mechanics.models.block_source import TetrahedraSource
from tactsim.mesh.block import BlockMesh
from tactsim.mesh.manifest import MANIFEST, ManifestEntry, add_entry, entries
from tactsim.mesh.mesh_store import content_hash, write_block_mesh
from tactsim.mesh.tetrahedra import mesher_version

Array = np.ndarray
FOLDER = Path(__file__).parent
CASES = FOLDER.parent / "cases"
LUMP = FOLDER / "lump.stl"
LICENCE = "MIT"
GOLDEN = (1 + 5**0.5) / 2
BUMPS = ((0.10, (2.0, 1.0, -1.0), 0.4), (0.07, (-1.0, 3.0, 2.0), 1.1), (0.05, (3.0, -2.0, 4.0), 2.3))
"""Height over the radius, wave vector over the radius, and phase in rad of the waves on the irregular lump."""


def icosphere(halvings: int) -> tuple[Array, Array]:
    """Vertices (n, 3) of length 1 and outward triangles (20 * 4**halvings, 3)."""
    corners = [point for a in (-1.0, 1.0) for b in (-GOLDEN, GOLDEN) for point in ((0, a, b), (a, b, 0), (b, 0, a))]
    points = np.array(corners) / np.linalg.norm(corners[0])
    near = np.linalg.norm(points[:, None] - points, axis=2) < 1.1
    triples = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]]
    faces = [t if np.linalg.det(points[list(t)]) > 0 else t[::-1] for t in triples]
    for _ in range(halvings):
        middles = np.unique(np.sort(np.array([(t[k], t[(k + 1) % 3]) for t in faces for k in range(3)]), axis=1), axis=0)
        number = {tuple(pair): len(points) + k for k, pair in enumerate(middles.tolist())}
        between = points[middles].mean(axis=1)
        points = np.vstack([points, between / np.linalg.norm(between, axis=1, keepdims=True)])
        halved = []
        for a, b, c in faces:
            ab, bc, ca = (number[min(pair), max(pair)] for pair in ((a, b), (b, c), (c, a)))
            halved += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = halved
    return points, np.array(faces)


def irregular_lump(radius: float = 5.0) -> tuple[Array, Array]:
    """Vertices (642, 3) in mm and triangles (1280, 3) of a ball whose radius waves."""
    points, faces = icosphere(3)
    waves = sum(height * np.cos(points @ np.array(vector) + phase) for height, vector, phase in BUMPS)
    return radius * (1 + waves)[:, None] * points, faces


def write_stl(place: Path, vertices: Array, faces: Array) -> None:
    """Write triangles (m, 3) as binary STL."""
    corners = vertices[faces].astype("<f4")
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    records = np.zeros(len(faces), record)
    records["normal"] = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    records["normal"] /= np.linalg.norm(records["normal"], axis=1, keepdims=True)
    records["corners"] = corners
    place.write_bytes(b"irregular lump of tactsim, in mm".ljust(80) + np.uint32(len(faces)).tobytes() + records.tobytes())


def meshes_of_cases() -> dict[str, tuple[str, BlockMesh, str]]:
    """Name, mesh and origin by key, for every case that asks for tetrahedra of a block."""
    meshes: dict[str, tuple[str, BlockMesh, str]] = {}
    for path in sorted(CASES.glob("grasp_*.yaml")):
        experiment = load_case(path).experiment
        if not isinstance(experiment.source, TetrahedraSource):
            continue
        sourced = grasp_mesh(experiment)
        meshes.setdefault(sourced.block.key, (path.stem, sourced.block, sourced.origin))
        sys.stdout.write(f"{path.name}: {sourced.block.unknowns} unknowns, {sourced.origin}, {sourced.block.seconds:.1f} s\n")
    return meshes


def main() -> None:
    """Make what is missing and drop what no case asks for."""
    if not LUMP.exists():
        write_stl(LUMP, *irregular_lump())
    meshes = meshes_of_cases()
    known = {entry.key: entry for entry in entries(FOLDER) if entry.key in meshes}
    (FOLDER / MANIFEST).unlink(missing_ok=True)
    for key, (name, block, _) in meshes.items():
        file = f"{name}.npz"
        made = f"by meshes/make.py for cases/{name}.yaml with pytetwild {mesher_version()} (fTetWild)"
        content = content_hash(block.mesh)
        entry = ManifestEntry(name=name, file=file, key=key, content=content, source=made, licence=LICENCE)
        if key not in known:
            write_block_mesh(block, FOLDER / file)
        add_entry(FOLDER, known.get(key, entry))
    for place in FOLDER.glob("*.npz"):
        if place.name not in {entry.file for entry in entries(FOLDER)}:
            place.unlink()


if __name__ == "__main__":
    main()
