"""Conforming tetrahedra of a block with inclusions by fTetWild, run in a process of its own.

The mesher may hang, crash or exhaust the memory on hostile input, from which the process protects a caller. It has no seed: its
random numbers are fixed where that is possible (``outside.fixed_random_device``); elsewhere it gives another mesh every time, so
that ``mesh_store`` makes each once.

Source: Hu et al. 2020, ACM Trans. Graph. 39, 117, doi:10.1145/3386569.3392385.
"""

from __future__ import annotations

import hashlib
import json
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.code_identity import installed_version
from tactsim.deadline import check_time, seconds_left
from tactsim.errors import ConvergenceError, InputError
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import Triangles
from tactsim.mesh.affordable import check_unknowns, estimated_unknowns
from tactsim.mesh.any_inclusion import check_inclusions
from tactsim.mesh.block import OF_GRADED, SIZES, BlockMesh, BlockMeshSettings
from tactsim.mesh.fitting.curving import fitted
from tactsim.mesh.fitting.labelling import Surfaces, tidied
from tactsim.mesh.sizing import at_jaw_edges, background
from tactsim.mesh.solid import outward
from tactsim.outside.arrays import read_arrays
from tactsim.outside.fixed_random_device import fix_random_device
from tactsim.outside.processes import Ended, run_child
from tactsim.progress import elapsed_time

ENVELOPE = 0.03
"""Distance that the mesher's surface may keep from the given one, in element sizes; projection then removes it."""
FACET_SIZE = 0.6
"""Edge length of the triangles given to the mesher, in element sizes."""
ATTEMPTS = (1.0, 0.8, 0.64, 0.5, 0.4)
"""Parts of the element size at inclusions that are tried one after the other until a mesh keeps its bounds: of 33 random
meshes of spheres of 3 to 4.5 mm two missed the volume by 0.56 %, the others by 0.3 % at most. Two spheres of 1.55 mm, smaller
than the usual element of 2.6 mm, missed it by 2.9, 3.4, 0.28, 0.13 and 0.05 %."""
REVISION = 2
"""Raised when the same input shall give another mesh."""
MODULE = "tactsim.mesh.tetrahedra"
EVERYWHERE = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA,-FMA4"}
"""Environment in which the functions of the C library take no instructions that some processors lack: with them the last digit of
what they return is another, and so is the mesh."""


def block_mesh(
    size: Sequence[float], inclusions: Sequence[Inclusion] = (), settings: BlockMeshSettings | None = None
) -> BlockMesh:
    """A block of ``size`` (3,) in m with inclusions, in curved quadratic tetrahedra that conform to every surface.

    Where the mesher's random numbers cannot be fixed it gives another one every time; ``mesh_store.stored_block_mesh`` makes a
    mesh once.

    Raises
    ------
    InputError
        If inclusions overlap, touch, protrude or do not suit the block, or the elements would be too many.
    ConvergenceError
        If the mesher fails or takes too long, or every mesh misses the volumes, the flatness or the shape asked for.
    """
    started = time.perf_counter()
    settings, extent = settings or BlockMeshSettings(), np.asarray(size, float)
    check_inclusions(extent, inclusions, settings.least_gap)
    estimate = estimated_unknowns(extent, inclusions, settings, at_jaw_edges(settings))
    check_unknowns(estimate, SIZES)
    surfaces = Surfaces(extent, [inclusion.solids(extent) for inclusion in inclusions])
    key = mesh_key(size, inclusions, settings)
    for part in ATTEMPTS:
        finer = settings.model_copy(update={"inclusion_size": part * settings.inclusion_size})
        corners, simplices = tetrahedra_in_child(_request(extent, inclusions, finer), settings.time_limit)
        labels = tidied(simplices, surfaces.labels(corners[simplices].mean(axis=1)))
        try:
            return fitted(corners, simplices, labels, size=extent, inclusions=inclusions, key=key, started=started, part=part)
        except ConvergenceError as error:
            missed = error
    raise missed


def _request(size: Array, inclusions: Sequence[Inclusion], settings: BlockMeshSettings) -> dict[str, Array]:
    """What the mesher needs: the surfaces, and the element sizes on a background mesh."""
    vertices, triangles = input_surface(size, inclusions, settings)
    bounds = np.array([vertices.min(axis=0), vertices.max(axis=0)])
    finest = min([settings.inclusion_size, *(inclusion.refine(settings.inclusion_size) for inclusion in inclusions)])
    points, cells, wanted = background(bounds, size, inclusions, settings)
    return {
        "vertices": vertices,
        "faces": triangles.astype(np.int32),
        "edge_length_abs": np.array(settings.size),
        "epsilon": np.array(ENVELOPE * finest / np.linalg.norm(np.ptp(bounds, axis=0))),
        "stop_energy": np.array(settings.stop_energy),
        "bg_vertices": points,
        "bg_tets": cells,
        "bg_values": wanted,
    }


def mesh_key(size: Sequence[float], inclusions: Sequence[Inclusion], settings: BlockMeshSettings) -> str:
    """Sixteen hexadecimal digits that change with the geometry and the settings."""
    asked = settings.model_dump(exclude={"time_limit"})
    document = {
        "size": [float(length) for length in size],
        "inclusions": [inclusion.identity() for inclusion in inclusions],
        "settings": {name: value for name, value in asked.items() if (name, value) not in OF_GRADED.items()},
        "revision": REVISION,
    }
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:16]


def mesher_version() -> str:
    """Version of pytetwild, "absent" if it is not installed."""
    return installed_version("pytetwild")


def input_surface(size: Array, inclusions: Sequence[Inclusion], settings: BlockMeshSettings) -> Triangles:
    """The surfaces of the block of size (3,) in m and of every solid in one set of triangles."""
    corners = np.array([[x, y, z] for x in (0.0, size[0]) for y in (0.0, size[1]) for z in (0.0, size[2])])
    quads = np.array([[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]])
    faces = outward(corners, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), size / 2)
    vertices, triangles, count = [corners], [faces], len(corners)
    for inclusion in inclusions:
        for solid in inclusion.solids(size):
            points, facets = solid.triangles(FACET_SIZE * inclusion.refine(settings.inclusion_size))
            vertices.append(points)
            triangles.append(facets + count)
            count += len(points)
    return np.vstack(vertices), np.vstack(triangles)


def tetrahedra_in_child(request: dict[str, Array], time_limit: float) -> tuple[Array, Array]:
    """Corners (n, 3) in m and tetrahedra (E, 4) that fTetWild makes of a request, in a process that is stopped in time.

    Raises
    ------
    ConvergenceError
        If the mesher dies, takes longer than ``time_limit`` in s, or gives no tetrahedra.
    OutOfTime
        If the time of the whole computation has passed.
    InputError
        If pytetwild is not installed.
    """
    with tempfile.TemporaryDirectory(prefix="tactsim-mesh-") as folder:
        asked, answer = Path(folder) / "request.npz", Path(folder) / "answer.npz"
        np.savez(asked, **request)  # type: ignore[arg-type]
        allowed = max(0.0, min(time_limit, seconds_left()))
        with elapsed_time("meshing"):
            done = run_child(MODULE, [str(asked), str(answer)], time_limit=allowed, environment=EVERYWHERE)
        if done.out_of_time:
            check_time()
        if done.code or not answer.exists():
            raise _failure(done, time_limit)
        arrays = read_arrays(answer.read_bytes(), "the mesher's answer")
        corners, simplices = arrays["corners"], arrays["simplices"]
    if not len(simplices) or not np.isfinite(corners).all():
        raise ConvergenceError("the mesher gave no tetrahedra")
    return corners, simplices.astype(np.int64)


def _failure(done: Ended, time_limit: float) -> InputError | ConvergenceError:
    if done.out_of_time:
        return ConvergenceError(f"the mesher was stopped after {time_limit:g} s; take larger elements or a longer time_limit")
    if "No module named 'pytetwild'" in done.last_line:
        return InputError("meshing a block with inclusions needs the package pytetwild: pip install pytetwild")
    if done.out_of_memory:
        return ConvergenceError("the mesher needs more memory than this machine has; take larger elements")
    return ConvergenceError(f"the mesher failed ({done.ending}): {done.last_line or 'no message'}")


def main(asked: str, answer: str) -> None:
    """Answer one request; what the child process does."""
    import pytetwild
    from pytetwild import PyfTetWildWrapper

    fix_random_device(Path(PyfTetWildWrapper.__file__))
    request: dict[str, Any] = dict(read_arrays(Path(asked).read_bytes(), "the request"))
    request |= {name: float(request[name]) for name in ("edge_length_abs", "epsilon", "stop_energy")}
    corners, simplices = pytetwild.tetrahedralize(**request, vtk_ordering=True, disable_filtering=True, quiet=True)
    np.savez(answer, corners=corners, simplices=simplices)


if __name__ == "__main__":
    main(*sys.argv[1:])
