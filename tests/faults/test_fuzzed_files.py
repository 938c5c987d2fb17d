"""Damaged files of every kind that is read: each is read, or refused by an error of ours, within seconds and a bounded memory.

Some 550 inputs, the same every time. A long run takes the number of inputs from the environment::

    TACTSIM_FUZZ=20000 pytest tests/faults/test_fuzzed_files.py

Most meshes are read by what the child process runs, but in this one, under the same limits, as a child takes half a second.
"""

from __future__ import annotations

import io
import json
import math
import os
import resource
import signal
import traceback
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from live_pages import description, frame_line, grasp_folder, line
from ruamel.yaml import YAML

from tactsim.case import load_case
from tactsim.dataset.sweep import load_sweep
from tactsim.errors import TactsimError
from tactsim.identification.columns import read_columns
from tactsim.identification.dma_data import read_dma
from tactsim.identification.uniaxial_data import read_uniaxial_curve
from tactsim.live.feed import Feed
from tactsim.localization.networks import LearnedWeights, Network, read_weights
from tactsim.mesh import mesh_store
from tactsim.mesh.foreign import read_foreign
from tactsim.mesh.inclusions.surface import read_surface
from tactsim.mesh.reading import read_mesh
from tactsim.outside import mesh_files
from tactsim.outside.arrays import read_arrays
from tactsim.outside.processes import Ended
from tactsim.results.document import parse_document
from tactsim.results.fields import read_fields, write_fields
from tactsim.results.result import FieldFrame
from tactsim.sensors.taxel_layout import TaxelLayout

ROOT = Path(__file__).parents[2]
INPUTS = int(os.environ.get("TACTSIM_FUZZ", "550"))
"""Of all tests together."""
MOST_TIME, MOST_MEMORY = 10.0, 2**30
"""In s and in bytes, of one input."""


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


@pytest.fixture(scope="module", autouse=True)
def memory() -> Iterator[None]:
    """No input may take much memory, here or in a child."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    before = [1024 * resource.getrusage(kind).ru_maxrss for kind in kinds]
    yield
    after = [1024 * resource.getrusage(kind).ru_maxrss for kind in kinds]
    assert after[0] - before[0] < MOST_MEMORY
    assert after[1] < max(MOST_MEMORY, before[1] + 1)


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
    ends = [found for border in borders if (found := content.find(bytes([border]), at)) >= 0]
    return content[:begin] + new + content[min(ends, default=len(content)) :]


def accepted(read: Callable[[], Any]) -> None:
    """Reads; only an error of ours may come."""
    with suppress(TactsimError):
        read()


# Meshes and surfaces


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


@pytest.fixture(scope="module")
def formats(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, bytes]]:
    """Ending and content of a small valid file in each format."""
    folder, found = tmp_path_factory.mktemp("formats"), {}
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
            found[name] = (".lb8.ugrid" if name == "ugrid" else suffix, path.read_bytes())
    assert len(found) >= len(FORMATS) - 2
    return found


class _TimeIsUp(BaseException):
    """Raised by the clock; no reader catches it."""


@contextmanager
def limited(seconds: float, memory: int) -> Iterator[None]:
    """A block under the limits that a child has."""
    used = 1024 * int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize() // 1024
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)

    def stop(number: int, frame: object) -> None:
        raise _TimeIsUp

    before = signal.signal(signal.SIGALRM, stop)
    resource.setrlimit(resource.RLIMIT_DATA, (used + memory, hard))
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        resource.setrlimit(resource.RLIMIT_DATA, (hard, hard))
        signal.signal(signal.SIGALRM, before)


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a child would run is run here, and ends as a child would."""

    def run(module: str, arguments: Sequence[str], *, time_limit: float, memory: int, environment: object) -> Ended:
        try:
            with limited(min(time_limit, 5.0), memory):
                mesh_files.main(*arguments)
        except _TimeIsUp:
            return Ended(-1, "", out_of_time=True)
        except (Exception, SystemExit):  # noqa: BLE001  whatever ends a child ends it only
            return Ended(1, traceback.format_exc())
        return Ended(0, "")

    monkeypatch.setattr(mesh_files, "run_child", run)


def read_all_ways(path: Path) -> None:
    """Reads a file as mesh, as tetrahedra in regions and as surface."""
    accepted(lambda: read_foreign(path))
    accepted(lambda: read_mesh(path, unit="mm"))
    accepted(lambda: read_mesh(path, {1: 0, 2: 1}, unit="m", tag="region"))
    if path.suffix in (".stl", ".ply", ".obj"):
        accepted(lambda: read_surface(str(path)))


def test_the_undamaged_meshes_are_read(tmp_path: Path, formats: dict[str, tuple[str, bytes]], in_this_process: None) -> None:
    read = 0
    for name, (suffix, content) in formats.items():
        path = tmp_path / f"a{suffix}"
        path.write_bytes(content)
        with suppress(TactsimError):
            found = read_foreign(path)
            assert len(found.points) >= 4, name
            read += 1
    assert read >= len(formats) - 4, "otherwise the damaged ones test nothing"


@fuzz(0.36)
@given(st.sampled_from(sorted(FORMATS)), DAMAGES)
def test_damaged_meshes(
    tmp_path: Path, formats: dict[str, tuple[str, bytes]], in_this_process: None, name: str, damages: list[Damage]
) -> None:
    if name in formats:
        suffix, content = formats[name]
        path = tmp_path / f"a{suffix}"
        path.write_bytes(damaged(content, damages))
        read_all_ways(path)


@fuzz(0.04)
@given(st.sampled_from(sorted(FORMATS)), st.sampled_from(sorted(FORMATS)), st.floats(0, 1), st.floats(0, 1))
def test_spliced_meshes(
    tmp_path: Path,
    formats: dict[str, tuple[str, bytes]],
    in_this_process: None,
    first: str,
    second: str,
    cut: float,
    begin: float,
) -> None:
    if first in formats and second in formats:
        (suffix, head), (_, tail) = formats[first], formats[second]
        path = tmp_path / f"a{suffix}"
        path.write_bytes(head[: int(cut * len(head))] + tail[int(begin * len(tail)) :])
        read_all_ways(path)


@fuzz(0.02)
@given(st.sampled_from(["gmsh 2, binary", "vtu, zlib", "stl, binary", "ply, text", "medit, text", "obj"]), DAMAGES)
def test_damaged_meshes_in_a_child(
    tmp_path: Path, formats: dict[str, tuple[str, bytes]], name: str, damages: list[Damage]
) -> None:
    suffix, content = formats[name]
    path = tmp_path / f"a{suffix}"
    path.write_bytes(damaged(content, damages))
    accepted(lambda: read_foreign(path))


# Cases


CASES = sorted(path.name for path in (ROOT / "cases").glob("*.yaml"))
VALUES: list[Any] = [
    None,
    True,
    0,
    -1,
    10**30,
    1e300,
    1e-320,
    "nan",
    "1e-400 mm",
    "1e400 mm",
    "0 mm",
    "-1 mm",
    "1e300 m",
    "1e300 N",
    "1e9 Pa",
    "1e-30 s",
    "\x00",
    "\x1b[31m",
    "x" * 5000,
    "1 furlong",
    "../../../etc/passwd",
    "/dev/zero",
    [],
    [[]],
    {},
    [0] * 2000,
    ["1 mm"] * 500,
    {"kind": "none"},
    {"kind": ["x"]},
    "sphere",
]
Change = tuple[float, str, int]
CHANGES = st.lists(
    st.tuples(
        st.floats(0, 1, exclude_max=True),
        st.sampled_from(["delete", "value", "value", "value", "repeat", "wrap", "rename"]),
        st.integers(0, 999),
    ),
    min_size=1,
    max_size=3,
)


@cache
def case_content(name: str) -> str:
    """A shipped case as JSON."""
    return json.dumps(YAML(typ="safe", pure=True).load((ROOT / "cases" / name).read_text(encoding="utf-8")))


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every container in a document with each of its keys."""
    entries = list(value.items()) if isinstance(value, dict) else list(enumerate(value)) if isinstance(value, list) else []
    for key, item in entries:
        yield value, key
        yield from places(item)


def changed(content: Any, changes: Sequence[Change]) -> Any:
    """The document after all changes."""
    for where, what, number in changes:
        found = list(places(content))
        if not found:
            return content
        holder, key = found[int(where * len(found))]
        if what == "delete":
            del holder[key]
        elif what == "repeat":
            holder[key] = [holder[key]] * (2 + number % 3)
        elif what == "wrap":
            holder[key] = {"kind": holder[key]}
        elif what == "rename" and isinstance(holder, dict):
            holder["x\x1b" if number % 2 else "kind"] = holder.pop(key)
        else:
            holder[key] = VALUES[number % len(VALUES)]
        content = json.loads(json.dumps(content))  # so that no part stands in two places
    return content


@fuzz(0.2)
@given(st.sampled_from(CASES), CHANGES)
def test_changed_cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, changes: list[Change]) -> None:
    monkeypatch.chdir(ROOT)
    path = tmp_path / name
    path.write_text(json.dumps(changed(json.loads(case_content(name)), changes)), encoding="utf-8")
    accepted(lambda: (load_sweep if name.startswith("sweep") else load_case)(path))


# Tables


TABLES = [
    "strain [%], nominal stress [kPa]\n" + "".join(f"{k},{k * 0.3}\n" for k in range(1, 9)),
    "frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n" + "".join(f"{k},{k + 1},{k / 2}\n" for k in range(1, 9)),
    "time [s], force [N]\n" + "".join(f"{k / 10},{k}\n" for k in range(9)),
]
"""A curve, a dynamic measurement and a signal."""
GARBAGE = st.binary(max_size=200) | st.text(alphabet="0123456789.,;eE+-nainf \t\n\r\"'#\x00\u2028", max_size=200).map(str.encode)


@fuzz(0.16)
@given(st.builds(damaged, st.sampled_from([table.encode() for table in TABLES]), DAMAGES) | GARBAGE)
def test_damaged_tables(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    accepted(lambda: read_uniaxial_curve(path))
    accepted(lambda: read_dma(path))
    accepted(lambda: read_columns(path, {"time": "s", "force": "N"}))
    accepted(lambda: read_columns(path, {"time": "s", "force": "N"}, complete=True))


# Results


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a result with fields."""
    folder = grasp_folder(tmp_path_factory.mktemp("results") / "a")
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    frame = FieldFrame(1.0, points, {"tetra": np.array([[0, 1, 2, 3]])}, {"displacement": points}, {"region": np.array([0])})
    write_fields([frame], folder)
    return folder


@fuzz(0.08)
@given(DAMAGES)
def test_damaged_results(result: Path, damages: list[Damage]) -> None:
    content = damaged((result / "result.json").read_bytes(), damages).decode("utf-8", "replace")
    accepted(lambda: parse_document(content, "r"))


@fuzz(0.03)
@given(DAMAGES, st.booleans())
def test_damaged_fields(result: Path, tmp_path: Path, in_this_process: None, damages: list[Damage], index: bool) -> None:
    for path in result.glob("fields*"):
        hit = (path.suffix == ".pvd") == index
        (tmp_path / path.name).write_bytes(damaged(path.read_bytes(), damages) if hit else path.read_bytes())
    accepted(lambda: read_fields(tmp_path))


# Arrays: weights and kept meshes


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


@fuzz(0.11)
@given(
    st.sampled_from([weights(), kept_mesh()]),
    st.integers(0, 20),
    DAMAGES | st.sampled_from(HEADERS),
    st.booleans(),
)
def test_damaged_arrays(tmp_path: Path, content: bytes, entry: int, change: list[Damage] | str, inside: bool) -> None:
    if isinstance(change, str):
        content = with_header(content, entry, change)
    else:
        content = with_damaged_entry(content, entry, change) if inside else damaged(content, change)
    path = tmp_path / "a.npz"
    path.write_bytes(content)
    accepted(lambda: read_weights(path))
    accepted(lambda: read_arrays(content, "a"))
    assert mesh_store._arrays(path) is None, "a damaged mesh counts as none"


# Frames


LINES = line(description(title="x")) + b"".join(line(frame_line(float(k), closing=1e-3)) for k in range(2))


@fuzz(0.08)
@given(st.builds(damaged, st.just(LINES), DAMAGES) | st.binary(max_size=100), st.integers(1, 50))
def test_damaged_frames(content: bytes, piece: int) -> None:
    feed = Feed("test")
    stream = feed.stream()
    for begin in range(0, len(content), piece):
        stream.take(content[begin : begin + piece])
    stream.take(b"\n" + LINES)
    assert feed.frame is not None
    assert math.isclose(feed.frame.time or 0.0, 1.0), "the feed goes on after whatever came"
    assert feed.counts.fault.isprintable()
