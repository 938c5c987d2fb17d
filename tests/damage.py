"""Small valid files of every kind that is read, and what can happen to them."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from tactsim.errors import TactsimError
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.localization.networks import LearnedWeights, Network

INPUTS = int(os.environ.get("TACTSIM_FUZZ", "300"))
"""Of all tests together."""
MOST_TIME = 10.0
"""In s, of one input."""


def fuzz(share: float) -> settings:
    """Settings of a test that takes a share of all inputs."""
    checks = [
        HealthCheck.function_scoped_fixture,
        HealthCheck.too_slow,
        HealthCheck.data_too_large,
        HealthCheck.large_base_example,
    ]
    count = max(4, round(INPUTS * share))
    return settings(derandomize=True, deadline=1e3 * MOST_TIME, max_examples=count, suppress_health_check=checks, database=None)


def accepted(read: Callable[[], Any]) -> None:
    """Reads; only an error of ours may come."""
    with suppress(TactsimError):
        read()


NUMBERS = [
    "0",
    "-1",
    "1e300",
    "-1e300",
    "1e-400",
    "1e400",
    "nan",
    "inf",
    "4000000000",
    "99999999999999999999",
    "0.5",
    "",
    "x",
    "1 2",
]
Damage = tuple[str, float, float, bytes]
DAMAGES = st.lists(
    st.tuples(
        st.sampled_from(["cut", "delete", "overwrite", "insert", "repeat", "number", "number", "number", "line"]),
        st.floats(0, 1),
        st.floats(0, 1),
        st.binary(min_size=1, max_size=8) | st.sampled_from([number.encode() for number in NUMBERS]),
    ),
    min_size=1,
    max_size=4,
)
"""What is done to a file, where as a part of its length, how long as a part of what remains, and with which bytes."""


def damaged(content: bytes, damages: Sequence[Damage]) -> bytes:
    """The content after all damages."""
    for what, where, length, new in damages:
        at = int(where * len(content))
        end = at + int(length**4 * (len(content) - at)) + 1
        if what == "cut":
            content = content[:at]
        elif what == "delete":
            content = content[:at] + content[end:]
        elif what == "overwrite":
            content = content[:at] + new + content[at + len(new) :]
        elif what == "insert":
            content = content[:at] + new + content[at:]
        elif what == "repeat":
            content = content[:end] + content[at:end] * 3 + content[end:]
        else:
            content = _replaced(content, at, new, rb" \n\r\t,\"<>=[]" if what == "number" else b"\n")
    return content


def _replaced(content: bytes, at: int, new: bytes, borders: bytes) -> bytes:
    """The content with another word or line where a place is."""
    begin = max((content.rfind(bytes([border]), 0, at) for border in borders), default=-1) + 1
    ends = [end for border in borders if (end := content.find(bytes([border]), at)) >= 0]
    return content[:begin] + new + content[min(ends, default=len(content)) :]


def _solid() -> meshio.Mesh:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    cells, tags = np.array([[0, 1, 2, 3], [1, 2, 3, 4]]), [np.array([1, 2])]
    return meshio.Mesh(points, [("tetra", cells)], cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags, "region": tags})


def _shell() -> meshio.Mesh:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    return meshio.Mesh(points, [("triangle", np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))])


FORMATS: dict[str, tuple[str, Callable[[], meshio.Mesh], dict[str, Any]]] = {
    "gmsh 4, text": (".msh", _solid, {"file_format": "gmsh", "binary": False}),
    "gmsh 4, binary": (".msh", _solid, {"file_format": "gmsh", "binary": True}),
    "gmsh 2, text": (".msh", _solid, {"file_format": "gmsh22", "binary": False}),
    "gmsh 2, binary": (".msh", _solid, {"file_format": "gmsh22", "binary": True}),
    "ansys": (".msh", _solid, {"file_format": "ansys"}),
    "vtu, text": (".vtu", _solid, {"binary": False}),
    "vtu, binary": (".vtu", _solid, {"compression": None}),
    "vtu, zlib": (".vtu", _solid, {"compression": "zlib"}),
    "vtu, lzma": (".vtu", _solid, {"compression": "lzma"}),
    "vtk 4, text": (".vtk", _solid, {"file_format": "vtk42", "binary": False}),
    "vtk 5, text": (".vtk", _solid, {"file_format": "vtk51", "binary": False}),
    "vtk 5, binary": (".vtk", _solid, {"file_format": "vtk51", "binary": True}),
    "medit, text": (".mesh", _solid, {}),
    "medit, binary": (".meshb", _solid, {}),
    "abaqus": (".inp", _solid, {}),
    "nastran": (".bdf", _solid, {}),
    "netgen": (".vol", _solid, {}),
    "avs": (".avs", _solid, {}),
    "dolfin": (".xml", _solid, {}),
    "flac": (".f3grid", _solid, {}),
    "kratos": (".mdpa", _solid, {}),
    "permas": (".dato", _solid, {}),
    "su2": (".su2", _solid, {}),
    "tecplot": (".dat", _solid, {}),
    "ugrid": (".ugrid", _solid, {}),
    "xdmf": (".xdmf", _solid, {"data_format": "XML"}),
    "stl, text": (".stl", _shell, {"binary": False}),
    "stl, binary": (".stl", _shell, {"binary": True}),
    "ply, text": (".ply", _shell, {"binary": False}),
    "ply, binary": (".ply", _shell, {"binary": True}),
    "obj": (".obj", _shell, {}),
    "off": (".off", _shell, {}),
}


def written_meshes(folder: Path) -> dict[str, tuple[str, bytes]]:
    """Ending and content of a small valid file in each format."""
    copies: dict[str, tuple[str, bytes]] = {}
    for number, (name, (suffix, mesh, options)) in enumerate(FORMATS.items()):
        path = folder / f"{number}{suffix}"
        written = mesh()
        if name.startswith(
            ("medit", "netgen", "flac", "kratos", "permas", "su2", "tecplot", "ugrid", "abaqus", "nastran", "ansys")
        ):
            written.cell_data = {}
        if name == "ugrid":
            path = path.with_name("ugrid.lb8.ugrid")
        with np.errstate(all="ignore"), suppress(ImportError):
            meshio.write(path, written, **options)
            copies[name] = (".lb8.ugrid" if name == "ugrid" else suffix, path.read_bytes())
    assert len(copies) >= len(FORMATS) - 2
    return copies


def weights() -> bytes:
    """Weights of a small learned estimator."""
    layout, rng = TaxelLayout(rows=2, columns=2, pitch=1e-2, size=9e-3), np.random.default_rng(0)
    place = Network((rng.normal(size=(10, 4)),), (rng.normal(size=4),))
    presence = Network((rng.normal(size=(10, 1)),), (rng.normal(size=1),))
    numbers = {"block_size": np.full(3, 0.02), "middle": np.zeros(10), "scale": np.ones(10), "growth": np.zeros(2)}
    return LearnedWeights(layout=layout, places=(place,), presence=presence, covariance=np.eye(4), **numbers).content()


def kept_mesh() -> bytes:
    """A file of arrays such as the cache of meshes holds."""
    content = io.BytesIO()
    nodes, elements = np.zeros((10, 3)), np.arange(10)[None]
    np.savez_compressed(content, nodes=nodes, elements=elements, regions=np.zeros(1, np.int64), content=np.array("x"))
    return content.getvalue()


def with_damaged_entry(content: bytes, entry: int, damages: Sequence[Damage]) -> bytes:
    """The archive with one of its entries damaged, its checksum put right."""
    written = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as new:
        names = old.namelist()
        for number, name in enumerate(names):
            inner = old.read(name)
            new.writestr(name, damaged(inner, damages) if number == entry % len(names) else inner)
    return written.getvalue()


HEADERS = [
    "{'descr': '<f8', 'fortran_order': False, 'shape': (4000000000,), }",
    "{'descr': '|O', 'fortran_order': False, 'shape': (), }",
]
HEADERS += [
    "{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 4), }",
    "{" * 500,
    "{'descr': [('a', '<f8')] * 9, 'shape': ()}",
]
HEADERS += [
    "{'descr': '<f8', 'fortran_order': False, 'shape': (0, 9000000000000000000), }",
    "{'descr': '<U99999999', 'fortran_order': False, 'shape': (), }",
]


def with_header(content: bytes, entry: int, header: str) -> bytes:
    """The archive with another header of one of its arrays."""
    text = header.encode().ljust(117) + b"\n"
    array = b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + bytes(64)
    written = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as new:
        names = old.namelist()
        for number, name in enumerate(names):
            new.writestr(name, array if number == entry % len(names) else old.read(name))
    return written.getvalue()
