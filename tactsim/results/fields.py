"""``fields.pvd`` and its ``.vtu`` files: fields of the accepted steps for ParaView."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from tactsim.errors import StorageError
from tactsim.outside.files import opened
from tactsim.outside.text import one_line
from tactsim.results.result import FieldFrame

INDEX = "fields.pvd"
DISPLACEMENT, PRESSURE = "displacement [m]", "pressure [Pa]"
"""Arrays of the nodes of a frame; positive pressure is compression."""
REGION, CORNER_PRESSURE, AXIAL_STRESS, VON_MISES = "region [1]", "corner_pressure [Pa]", "axial_stress [Pa]", "von_mises [Pa]"
"""Arrays of its cells that later stages read: the axial stress is the Cauchy stress across the axis, tension positive."""


def write_fields(frames: Sequence[FieldFrame], directory: Path) -> None:
    """Writes one ``.vtu`` per frame and the index that names them by relative path."""
    if not frames:
        return
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for number, frame in enumerate(frames, start=1):
        name = f"fields_{number:04d}.vtu"
        _write_frame(frame, directory / name)
        ElementTree.SubElement(collection, "DataSet", timestep=repr(float(frame.time)), part="0", file=name)
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(directory / INDEX, encoding="utf-8", xml_declaration=True)


def read_fields(directory: Path) -> tuple[FieldFrame, ...]:
    """The frames that ``write_fields`` wrote, empty if none were written.

    Raises
    ------
    StorageError
        If a file is missing or damaged.
    """
    index = directory / INDEX
    if not index.exists():
        return ()
    try:
        entries = [dict(entry.attrib) for entry in ElementTree.fromstring(opened(index, "description").text()).iter("DataSet")]
        times = [float(entry["timestep"]) for entry in entries]
        return _read_frames([directory / Path(entry["file"]).name for entry in entries], times)
    except (ElementTree.ParseError, KeyError, ValueError) as error:
        raise StorageError(f"{index} is damaged: {one_line(error)}") from None


def field_files(directory: Path) -> list[str]:
    """Names of the index and of all files of frames in a folder."""
    return sorted(path.name for path in directory.glob("fields*") if path.suffix in (".pvd", ".vtu"))


def _write_frame(frame: FieldFrame, path: Path) -> None:
    import meshio
    from meshio.vtu import write

    sizes = np.cumsum([len(connectivity) for connectivity in frame.cells.values()])[:-1]
    mesh = meshio.Mesh(
        np.ascontiguousarray(frame.points, dtype=float),
        list(frame.cells.items()),
        point_data={name: _columns(values) for name, values in frame.point_data.items()},
        cell_data={name: np.split(_columns(values), sizes) for name, values in frame.cell_data.items()},
    )
    write(path, mesh)


def _columns(values: np.ndarray) -> np.ndarray:
    """Field values as VTK wants them: one row per point, a tensor as nine columns, no booleans."""
    array = np.asarray(values)
    array = array.astype(np.uint8) if array.dtype == bool else array
    return np.ascontiguousarray(array if array.ndim < 3 else array.reshape(len(array), -1))


def _read_frames(paths: Sequence[Path], times: Sequence[float]) -> tuple[FieldFrame, ...]:
    from tactsim.outside.mesh_files import read_mesh_files  # starts processes, which most runs never need

    meshes = read_mesh_files([opened(path, "field file") for path in paths]) if paths else []
    return tuple(
        FieldFrame(
            time, mesh.points, dict(mesh.cells), mesh.point_data, {k: np.concatenate(v) for k, v in mesh.cell_data.items()}
        )
        for time, mesh in zip(times, meshes, strict=True)
    )
