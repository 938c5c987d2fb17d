"""Meshes and surfaces in the formats of other programs, read by meshio in a child process: some of its readers never end on a
truncated file, and a small compressed one may unpack to more than the machine has."""

from __future__ import annotations

import io
import re
import sys
import tempfile
import warnings
from collections.abc import Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import StorageError
from tactsim.outside.arrays import read_arrays
from tactsim.outside.environment import ONE_THREAD
from tactsim.outside.files import MEBIBYTE, OutsideFile
from tactsim.outside.processes import Ended, run_child
from tactsim.outside.text import one_line

TIME, TIME_PER_MEBIBYTE = 8.0, 2.0
"""Time in s in which a file must be read, and how much more for each MiB: ten times what the slowest reader of text takes."""
UNPACKED = 50
"""Bytes in memory for one in the file: three times what the best compressed real meshes ask for."""
ANSWER_MEMORY, READER_MEMORY = 64 * MEBIBYTE, 512 * MEBIBYTE
"""Bytes that any mesh and any reader may take besides."""
MODULE = "tactsim.outside.mesh_files"
READER = "meshio"
"""The library that reads, by which its warnings are known."""
MOST_WARNINGS = 100
WARNED = re.compile(r"^Warning: ", re.MULTILINE)
"""How meshio begins a warning, which it writes to standard error."""
NODES = {"vertex": 1, "line": 2, "line3": 3, "triangle": 3, "triangle6": 6, "tetra": 4, "tetra10": 10}
"""Nodes of a cell of the types that are used."""


class MeshFileWarning(UserWarning):
    """What the reader of a file said of its content: what it passed over or completed."""


@dataclass(frozen=True)
class MeshArrays:
    """The content of a file, in its units: points (n, d), blocks of cells (type, (m, k) node numbers), and data by name.

    ``cell_data`` has one array for each block, ``groups`` the whole number of every named group.
    """

    points: Array
    cells: tuple[tuple[str, Array], ...]
    point_data: dict[str, Array] = field(default_factory=dict)
    cell_data: dict[str, tuple[Array, ...]] = field(default_factory=dict)
    groups: dict[str, int] = field(default_factory=dict)


def read_mesh_file(file: OutsideFile) -> MeshArrays:
    """The content of a file of any format that meshio reads.

    Raises
    ------
    StorageError
        If the file is damaged, of an unknown format, or asks for more time or memory than a file of its size should.

    Warns
    -----
    MeshFileWarning
        For each thing that the reader warned of.
    """
    return read_mesh_files([file])[0]


def read_mesh_files(files: Sequence[OutsideFile]) -> list[MeshArrays]:
    """The content of several files, read by one process, whose start takes longer than most files.

    Raises
    ------
    StorageError
        As `read_mesh_file`, for the first file that cannot be read.
    """
    allowed = sum(TIME + TIME_PER_MEBIBYTE * file.size / MEBIBYTE for file in files)
    largest = [ANSWER_MEMORY + UNPACKED * file.size for file in files]
    with tempfile.TemporaryDirectory(prefix="tactsim-read-") as folder:
        answers = [Path(folder) / f"{number}.npz" for number in range(len(files))]
        arguments = [
            str(part)
            for file, answer, most in zip(files, answers, largest, strict=True)
            for part in (file.path.absolute(), answer, most)
        ]
        memory = READER_MEMORY + 2 * max(largest)
        done = run_child(MODULE, arguments, time_limit=allowed, memory=memory, environment=ONE_THREAD)
        unread = [file for file, answer in zip(files, answers, strict=True) if not answer.exists()]
        if unread or done.code:
            raise StorageError(_why_unread((unread or files)[0], done, allowed))
        return [_answered(answer, file, most) for answer, file, most in zip(answers, files, largest, strict=True)]


def _why_unread(file: OutsideFile, done: Ended, allowed: float) -> str:
    """Why the reader ended at this file."""
    named = f"cannot read {one_line(file.named)}"
    if done.out_of_time:
        return f"{named}: the reader was stopped after {allowed:.3g} s; is it complete?"
    if done.out_of_memory:
        return f"{named}: it asks for more memory than a file of {file.size} bytes should; is it damaged?"
    return f"{named}: {(file.quotable and done.last_line) or f'damaged or of an unknown format ({done.ending})'}"


def _answered(answer: Path, file: OutsideFile, largest: int) -> MeshArrays:
    """What the child wrote about a file; warns of what its reader warned of."""
    arrays = read_arrays(answer.read_bytes(), file.named, largest=largest)
    for line in arrays.pop("warnings").tolist():
        words = line if file.quotable else "a part of the file was passed over or completed"
        warnings.warn_explicit(f"{one_line(file.named)}: {words}", MeshFileWarning, READER, 0)
    mesh = _unpacked(arrays)
    if not _consistent(mesh):
        raise StorageError(
            f"cannot read {one_line(file.named)}: the numbers of points, nodes of cells and data do not fit each other; "
            "is it damaged?"
        )
    return mesh


def _consistent(mesh: MeshArrays) -> bool:
    """Whether points are rows, cells have as many nodes as their type, and data one row for each point or cell."""
    points_fit = mesh.points.ndim == 2 and all(data.shape[:1] == mesh.points.shape[:1] for data in mesh.point_data.values())
    cells_fit = all(cells.shape[1] == NODES.get(kind, cells.shape[1]) for kind, cells in mesh.cells)
    sizes = [len(cells) for _, cells in mesh.cells]
    return points_fit and cells_fit and all([len(part) for part in parts] == sizes for parts in mesh.cell_data.values())


def _unpacked(arrays: dict[str, Array]) -> MeshArrays:
    types = arrays["types"].tolist()
    return MeshArrays(
        arrays["points"],
        tuple((name, arrays[f"cells_{k}"]) for k, name in enumerate(types)),
        {name: arrays[f"point_{number}"] for number, name in enumerate(arrays["point_names"].tolist())},
        {
            name: tuple(arrays[f"cell_{number}_{k}"] for k in range(len(types)))
            for number, name in enumerate(arrays["cell_names"].tolist())
        },
        dict(zip(arrays["group_names"].tolist(), arrays["group_numbers"].tolist(), strict=True)),
    )


def _read(path: str) -> tuple[Any, list[str]]:
    """meshio's mesh, and each different warning on one line; what it writes when it fails goes on to the parent."""
    import meshio

    written = io.StringIO()
    try:
        with warnings.catch_warnings(record=True) as caught, redirect_stderr(written), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", RuntimeWarning)  # meshio guesses from the first bytes whether a file is binary
            mesh = meshio.read(path)
    except BaseException:
        sys.stderr.write(written.getvalue())
        raise
    lines = [*WARNED.split(written.getvalue())[1:], *(str(one.message) for one in caught)]
    return mesh, list(dict.fromkeys(one_line(" ".join(line.split())) for line in lines))[:MOST_WARNINGS]


def main(*files: str) -> int:
    """Read each file and write its arrays; what the child process does.

    Parameters
    ----------
    files : for each of them its path, that of the answer, and the most bytes that its arrays may take

    Raises
    ------
    MemoryError
        If the arrays of one take more; meshio's own errors end the process, too.
    """
    for path, answer, largest in zip(files[::3], files[1::3], files[2::3], strict=True):
        _convert(path, answer, int(largest))
    return 0


def _convert(path: str, answer: str, largest: int) -> None:
    """Read one file and write its arrays.

    Raises
    ------
    MemoryError
        If the arrays take more bytes than ``largest``.
    """
    mesh, lines = _read(path)
    kept = [k for k, block in enumerate(mesh.cells) if np.ndim(block.data) == 2]
    point_data = {name: np.asarray(values) for name, values in mesh.point_data.items()}
    cell_data = {name: [np.atleast_1d(values[k]) for k in kept] for name, values in mesh.cell_data.items()}
    point_data = {name: values for name, values in point_data.items() if values.dtype.kind in "fiub"}
    cell_data = {name: parts for name, parts in cell_data.items() if all(part.dtype.kind in "fiub" for part in parts)}
    groups = {name: int(np.ravel(value)[0]) for name, value in mesh.field_data.items()}
    arrays = {f"cells_{number}": mesh.cells[k].data.astype(np.int64) for number, k in enumerate(kept)}
    arrays |= {f"point_{number}": values for number, values in enumerate(point_data.values())}
    for number, parts in enumerate(cell_data.values()):
        arrays |= {f"cell_{number}_{k}": part for k, part in enumerate(parts)}
    points = np.asarray(mesh.points, float)
    if points.nbytes + sum(array.nbytes for array in arrays.values()) > largest:
        raise MemoryError
    content = io.BytesIO()
    np.savez(
        content,
        points=points,
        types=np.array([mesh.cells[k].type for k in kept], dtype=str),
        point_names=np.array(list(point_data), dtype=str),
        cell_names=np.array(list(cell_data), dtype=str),
        group_names=np.array(list(groups), dtype=str),
        group_numbers=np.array(list(groups.values()), dtype=np.int64),
        warnings=np.array(lines, dtype=str),
        **arrays,
    )
    begun = Path(f"{answer}.begun")
    begun.write_bytes(content.getvalue())
    begun.replace(answer)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
