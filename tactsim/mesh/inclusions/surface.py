"""A lump bounded by a closed surface of triangles from a file, such as a segmentation of an image."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import ClassVar, Literal, Self

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import Point, Solid, Triangles
from tactsim.mesh.foreign import METRES, LengthUnit, read_foreign
from tactsim.mesh.inclusions.triangulated import TriangulatedSolid
from tactsim.outside.files import OutsideFile, opened
from tactsim.outside.input_path import InputPath
from tactsim.units import Angle

FORMATS = (".stl", ".ply", ".obj")
MOST_TRIANGLES = 500_000


class Surface(Inclusion):
    """A closed surface, turned about the origin of the file and then moved."""

    kind: Literal["surface"] = "surface"
    data_set_number: ClassVar[int | None] = 4
    path: InputPath
    """STL, PLY or OBJ file of triangles; one of ``meshes/`` is also found where this program is kept."""
    unit: LengthUnit
    """Unit of the coordinates in the file."""
    translation: Point = (0.0, 0.0, 0.0)
    """Where the origin of the file comes to lie in the block."""
    rotation: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)
    """Angles of the rotations about the fixed axes x, y, z through the origin of the file, in this order."""

    @classmethod
    def example(cls) -> Self:
        """A lump from a file in millimetres, put into the middle of the default block."""
        return cls(path="meshes/lump.stl", unit="mm", translation=(20e-3, 20e-3, 10e-3))

    def identity(self) -> str:
        """Text that changes with the geometry, whatever the file is called.

        Raises
        ------
        StorageError
            If the file cannot be read or is damaged.
        InputError
            If it holds anything other than triangles in 3D.
        """
        vertices, triangles = read_surface(self.path)
        place = repr((self.unit, self.translation, self.rotation)).encode()
        return hashlib.sha256(vertices.tobytes() + triangles.tobytes() + place).hexdigest()

    def file_content(self) -> str:
        """Hash of the vertices and triangles in the file.

        Raises
        ------
        StorageError
            If the file cannot be read or is damaged.
        InputError
            If it holds anything other than triangles in 3D.
        """
        return _content(*_file(self.path))

    def solids(self, size: Array) -> tuple[Solid, ...]:
        """The body inside the surface, whatever the size (3,) of the block.

        Raises
        ------
        StorageError
            If the file cannot be read or is damaged.
        InputError
            If it holds anything other than triangles in 3D.
        """
        return (_placed(self, *_file(self.path)),)


def _file(path: str) -> tuple[OutsideFile, int]:
    """The file of a surface, and the time in ns at which it was written, by which a change is noticed."""
    file = opened(path, "surface")
    return file, file.path.stat().st_mtime_ns


@lru_cache(maxsize=8)
def _placed(surface: Surface, file: OutsideFile, written: int) -> TriangulatedSolid:
    vertices, triangles = _read_surface(file, written)
    turn = scipy.spatial.transform.Rotation.from_euler("xyz", surface.rotation).as_matrix()
    placed = vertices * METRES[surface.unit] @ turn.T + np.array(surface.translation)
    return TriangulatedSolid(placed, triangles, surface.path)


def read_surface(path: str) -> Triangles:
    """Vertices (n, 3) in the unit of the file and triangles (m, 3), equal vertices joined.

    Raises
    ------
    StorageError
        If the file cannot be read or is damaged.
    InputError
        If it holds anything other than triangles in 3D.
    """
    return _read_surface(*_file(path))


@lru_cache(maxsize=8)
def _read_surface(file: OutsideFile, written: int) -> Triangles:
    path = file.named
    if Path(path).suffix.lower() not in FORMATS:
        raise InputError(f"{path}: surfaces are read from {', '.join(FORMATS)} files")
    mesh = read_foreign(file)
    others = {kind for kind, cells in mesh.cells if kind != "triangle" and len(cells)}
    triangles = [cells for kind, cells in mesh.cells if kind == "triangle"]
    if others or not sum(map(len, triangles)):
        raise InputError(f"{path}: holds {', '.join(sorted(others)) or 'no triangles'}; allowed: triangles only")
    return joined(mesh.points, np.vstack(triangles), path)


@lru_cache(maxsize=8)
def _content(file: OutsideFile, written: int) -> str:
    vertices, triangles = _read_surface(file, written)
    return hashlib.sha256(vertices.tobytes() + triangles.tobytes()).hexdigest()


def joined(points: Array, triangles: Array, name: str) -> Triangles:
    """The ``triangles`` (m, 3) with equal ``points`` (n, 3) joined and collapsed ones left out.

    Raises
    ------
    InputError
        If there are too many triangles, or they do not have three coordinates or collapse to a point.
    """
    if points.shape[1] != 3:
        raise InputError(f"{name}: the points have {points.shape[1]} coordinates; allowed: 3")
    if len(triangles) > MOST_TRIANGLES:
        raise InputError(f"{name}: {len(triangles)} triangles; allowed: at most {MOST_TRIANGLES}")
    extent = np.ptp(points[triangles].reshape(-1, 3), axis=0).max()
    if not extent > 0:
        raise InputError(f"{name}: all points of the surface coincide")
    rounded = np.round((points - points.min(axis=0)) / (1e-7 * extent)).astype(np.int64)  # STL stores single precision
    _, first, number = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    faces = number.reshape(-1)[triangles]
    kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return points[first].astype(float), faces[kept]
