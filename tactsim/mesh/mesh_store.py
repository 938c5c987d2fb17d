"""Meshes of blocks, made once and kept: results must repeat, also where the mesher gives another mesh every time.

A mesh is looked up among those shipped with the cases, then in the user's cache, and only then made.
"""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError, StorageError
from tactsim.interfaces import Inclusion
from tactsim.mesh.any_inclusion import check_inclusions
from tactsim.mesh.block import BlockMesh, BlockMeshSettings
from tactsim.mesh.fitting.curving import assembled
from tactsim.mesh.fitting.labelling import Surfaces
from tactsim.mesh.manifest import shipped_entry
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.mesh.shipped import shipped_folders
from tactsim.mesh.tetrahedra import block_mesh, mesh_key, mesher_version
from tactsim.outside.arrays import read_arrays
from tactsim.outside.files import opened
from tactsim.user_cache import user_cache

MAKING = 2
"""Raised when the mesher is run in another way: meshes in a user's cache are made anew, but those shipped stay, which they would
not if ``tetrahedra.REVISION`` were raised."""
_DAMAGE = (OSError, ValueError, LookupError, RuntimeError)


@dataclass(frozen=True)
class StoredMesh:
    """A mesh and where it came from.

    Attributes
    ----------
    content : hash of nodes, elements and regions, by which a result names its mesh
    origin : "shipped", "cache", or "made" just now
    """

    block: BlockMesh
    content: str
    origin: Literal["shipped", "cache", "made"]


def stored_block_mesh(
    size: Sequence[float],
    inclusions: Sequence[Inclusion] = (),
    settings: BlockMeshSettings | None = None,
    *,
    shipped: Path | None = None,
    cache: Path | None = None,
) -> StoredMesh:
    """The block mesh that ``tetrahedra.block_mesh`` makes, made at most once.

    Parameters
    ----------
    shipped : folder of the meshes that come with the cases, with its manifest; by default ``shipped.shipped_folders``
    cache : folder of meshes made before; by default the user's cache folder

    Raises
    ------
    StorageError
        If a shipped mesh is not the one its manifest describes.
    InputError, ConvergenceError
        As ``block_mesh``.
    """
    settings, extent = settings or BlockMeshSettings(), np.asarray(size, float)
    check_inclusions(extent, inclusions, settings.least_gap)
    key = mesh_key(size, inclusions, settings)
    for folder in shipped_folders() if shipped is None else (shipped,):
        entry = shipped_entry(folder, key)
        if entry is not None:
            stored = _read(folder / entry.file, extent, inclusions, key)
            if stored is None or stored[1] != entry.content:
                raise StorageError(f"{folder / entry.file} is not the mesh that the manifest describes; restore the file")
            return StoredMesh(*stored, "shipped")
    place = (cache or cache_folder()) / f"{key}-{mesher_version()}-{MAKING}.npz"
    stored = _read(place, extent, inclusions, key)
    if stored is not None:
        return StoredMesh(*stored, "cache")
    block = block_mesh(size, inclusions, settings)
    content = content_hash(block.mesh)
    if _kept(block, place):
        return StoredMesh(block, content, "made")
    stored = _read(place, extent, inclusions, key)  # another process was first: all use its mesh
    return StoredMesh(block, content, "made") if stored is None else StoredMesh(*stored, "cache")


def cache_folder() -> Path:
    """The user's cache folder of meshes."""
    return user_cache("meshes")


def content_hash(mesh: QuadraticMesh) -> str:
    """Thirty-two hexadecimal digits that change with any node, element or region."""
    digest = hashlib.sha256()
    for array, kind in ((mesh.nodes, "<f8"), (mesh.elements, "<i8"), (mesh.regions, "<i8")):
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array, kind).tobytes())
    return digest.hexdigest()[:32]


def write_block_mesh(block: BlockMesh, place: Path) -> None:
    """Write nodes, elements, regions and how the mesh was made into a file of arrays.

    Raises
    ------
    StorageError
        If the file cannot be written.
    """
    try:
        with open(place, "wb") as file:
            np.savez_compressed(
                file,
                nodes=block.mesh.nodes,
                elements=block.mesh.elements.astype(np.int64),
                regions=block.mesh.regions.astype(np.int64),
                straightened=np.array(block.quality.straightened),
                seconds=np.array(block.seconds),
                part=np.array(block.part),
                content=np.array(content_hash(block.mesh)),
            )
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise StorageError(f"cannot write {place}: {error.strerror or error}") from None


def _stored(place: Path) -> tuple[QuadraticMesh, dict[str, float], str] | None:
    """The mesh in a file, how it was made, and its content hash.

    None if there is none, it is damaged, or the mesh is not the one it was written with.
    """
    try:
        arrays = read_arrays(opened(place, "kept file").read(), place.name)
        mesh = QuadraticMesh(arrays["nodes"], arrays["elements"], arrays["regions"])
        made = {"seconds": float(arrays["seconds"]), "straightened": int(arrays["straightened"])}
        made["part"] = float(arrays["part"]) if "part" in arrays else 1.0  # files of before do not say
        content = str(arrays["content"])
        return (mesh, made, content) if content == content_hash(mesh) else None
    except (*_DAMAGE, TypeError):
        return None


def _read(place: Path, size: Array, inclusions: Sequence[Inclusion], key: str) -> tuple[BlockMesh, str] | None:
    """The mesh in a file and its content hash, None if there is none or it is damaged."""
    stored = _stored(place)
    if stored is None:
        return None
    mesh, made, content = stored
    surfaces = Surfaces(size, [inclusion.solids(size) for inclusion in inclusions])
    try:
        block = assembled(mesh, surfaces, inclusions, key=key, **made)  # type: ignore[arg-type]
    except (*_DAMAGE, IndexError, ConvergenceError, InputError):
        return None
    return block, content


def _kept(block: BlockMesh, place: Path) -> bool:
    """Write a mesh into the cache unless a valid one is there; whether it was written. An unwritable cache only costs time."""
    waiting = place.with_name(f".{place.name}.{os.getpid()}-{threading.get_ident()}.partial")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        write_block_mesh(block, waiting)
        try:
            os.link(waiting, place)
        except OSError:
            if _stored(place) is not None:
                return False
            os.replace(waiting, place)
    except OSError:
        return True
    finally:
        with suppress(OSError):
            waiting.unlink(missing_ok=True)
    return True
