"""Points, cells and tags of meshes and surfaces made by other programs, checked before anything is computed with them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.outside.files import OutsideFile, opened
from tactsim.outside.mesh_files import MeshArrays, read_mesh_file

LARGEST_COORDINATE = 1e9
"""In the unit of the file: beyond it squares of lengths overflow long before any tissue is so large."""


@dataclass(frozen=True)
class ForeignMesh:
    """What a file holds.

    Attributes
    ----------
    points : (n, d) in the unit of the file
    cells : type and node numbers (m, k) of every block, as meshio names and numbers them
    tags : by name, the whole numbers (m,) that every block's cells carry
    tag_names : whole number of every named group
    """

    points: Array
    cells: tuple[tuple[str, Array], ...]
    tags: dict[str, tuple[Array, ...]]
    tag_names: dict[str, int]


LengthUnit = Literal["m", "cm", "mm", "um"]
"""What the coordinates of a file may be in, which holds no unit itself."""
METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}
"""One of each in m."""


def read_foreign(path: str | Path | OutsideFile) -> ForeignMesh:
    """The points and cells of a file.

    Raises
    ------
    StorageError
        If the file cannot be read, is damaged or takes longer than its size asks for.
    InputError
        If a coordinate is not a finite number or a cell names a point that does not exist.
    """
    file = path if isinstance(path, OutsideFile) else opened(path, "mesh")
    mesh = read_mesh_file(file)
    _check(mesh, file.named)
    tags = {name: parts for name, parts in mesh.cell_data.items() if all(map(_whole, parts))}
    numbers = {name: tuple(part.astype(np.int64) for part in parts) for name, parts in tags.items()}
    return ForeignMesh(mesh.points, mesh.cells, numbers, mesh.groups)


def _whole(values: Array) -> bool:
    """Whether every cell has one whole number."""
    return values.ndim == 1 and bool(np.isfinite(values).all()) and bool((values == np.round(values)).all())


def _check(mesh: MeshArrays, name: str) -> None:
    if not mesh.points.size or not (np.abs(mesh.points) <= LARGEST_COORDINATE).all():
        allowed = f"allowed: finite numbers up to {LARGEST_COORDINATE:g} in the unit of the file, at least one point"
        raise InputError(f"{name}: a coordinate is missing, not finite or too large; {allowed}")
    for kind, cells in mesh.cells:
        if cells.size and (cells.min() < 0 or cells.max() >= len(mesh.points)):
            allowed = f"allowed: 0 to {len(mesh.points) - 1}"
            raise InputError(f"{name}: the nodes of {kind} cells run from {cells.min()} to {cells.max()}; {allowed}")
