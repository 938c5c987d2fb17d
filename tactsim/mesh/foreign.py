"""Files of other programs, read by meshio in a process of its own: some readers never end on a truncated file."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactsim.errors import InputError, StorageError

Array = np.ndarray
TIME_LIMIT = 120.0
"""Time in s after which a reader is stopped."""
MODULE = "tactsim.mesh.foreign"


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


def read_foreign(path: str | Path, time_limit: float = TIME_LIMIT) -> ForeignMesh:
    """The points and cells of a file.

    Raises
    ------
    StorageError
        If the file cannot be read, is damaged or takes longer than ``time_limit`` in s.
    InputError
        If a coordinate is not a finite number or a cell names a point that does not exist.
    """
    place = Path(path)
    try:
        with open(place, "rb") as file:
            file.read(1)
    except OSError as error:
        raise StorageError(f"cannot read {path}: {error.strerror or error}") from None
    with tempfile.TemporaryDirectory(prefix="tactsim-read-") as folder:
        answer = Path(folder) / "answer.npz"
        command = [sys.executable, "-m", MODULE, str(place.absolute()), str(answer)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=time_limit, check=False, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise StorageError(f"cannot read {path}: the reader was stopped after {time_limit:g} s; is it complete?") from None
        if done.returncode or not answer.exists():
            said = (done.stdout + done.stderr).decode(errors="replace").strip().splitlines()[-1:] or ["damaged or unknown format"]
            raise StorageError(f"cannot read {path}: {said[0][:200]}")
        return _checked(_loaded(answer), str(path))


def _loaded(answer: Path) -> ForeignMesh:
    with np.load(answer, allow_pickle=False) as file:
        types = [str(name) for name in file["types"]]
        cells = tuple((name, file[f"cells_{k}"]) for k, name in enumerate(types))
        tags = {
            str(name): tuple(file[f"tag_{number}_{k}"] for k in range(len(types)))
            for number, name in enumerate(file["tag_names"])
        }
        groups = dict(zip(map(str, file["group_names"]), map(int, file["group_numbers"]), strict=True))
        return ForeignMesh(file["points"], cells, tags, groups)


def _checked(mesh: ForeignMesh, name: str) -> ForeignMesh:
    if not len(mesh.points) or not np.isfinite(mesh.points).all():
        raise InputError(f"{name}: the coordinates must be finite numbers, at least one point")
    for kind, cells in mesh.cells:
        if len(cells) and (cells.min() < 0 or cells.max() >= len(mesh.points)):
            allowed = f"allowed: 0 to {len(mesh.points) - 1}"
            raise InputError(f"{name}: the nodes of {kind} cells run from {cells.min()} to {cells.max()}; {allowed}")
    return mesh


def main(path: str, answer: str) -> int:
    """Read one file and write its arrays; what the child process does."""
    import meshio

    with np.errstate(all="ignore"):  # meshio guesses from the first bytes whether a file is binary
        mesh = meshio.read(path)
    blocks = [block for block in mesh.cells if block.data.ndim == 2]
    kept = [k for k, block in enumerate(mesh.cells) if block.data.ndim == 2]
    whole = {
        name: [np.asarray(values[k]) for k in kept]
        for name, values in mesh.cell_data.items()
        if all(np.ndim(values[k]) == 1 and np.array_equal(values[k], np.round(values[k])) for k in kept)
    }
    arrays = {f"cells_{k}": block.data.astype(np.int64) for k, block in enumerate(blocks)}
    for number, values in enumerate(whole.values()):
        arrays |= {f"tag_{number}_{k}": value.astype(np.int64) for k, value in enumerate(values)}
    groups = {name: int(np.ravel(value)[0]) for name, value in mesh.field_data.items()}
    np.savez(
        answer,
        points=np.asarray(mesh.points, float),
        types=np.array([block.type for block in blocks], dtype=str),
        tag_names=np.array(list(whole), dtype=str),
        group_names=np.array(list(groups), dtype=str),
        group_numbers=np.array(list(groups.values()), dtype=np.int64),
        **arrays,
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
