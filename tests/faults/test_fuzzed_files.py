"""Damaged files of every kind that is read: each is read, or refused by an error of ours, within seconds and a bounded memory.

Some 300 inputs, the same every time. A long run takes the number of inputs from the environment::

    TACTSIM_FUZZ=20000 pytest tests/faults/test_fuzzed_files.py tests/faults/test_fuzzed_cases.py

Most meshes are read by what the child process runs, but in this one, under the same limits, as a child takes half a second.
"""

from __future__ import annotations

import math
import resource
import signal
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
from damage import (
    DAMAGES,
    FORMATS,
    HEADERS,
    Damage,
    accepted,
    damaged,
    fuzz,
    kept_mesh,
    weights,
    with_damaged_entry,
    with_header,
    written_meshes,
)
from hypothesis import given
from hypothesis import strategies as st
from live_pages import description, frame_line, grasp_folder, line

from tactsim.errors import TactsimError
from tactsim.identification.columns import read_columns
from tactsim.identification.dma_data import read_dma
from tactsim.identification.uniaxial_data import read_uniaxial_curve
from tactsim.live.sources.feed import Feed
from tactsim.localization.networks import read_weights
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

pytestmark = pytest.mark.filterwarnings("ignore::tactsim.outside.mesh_files.MeshFileWarning")
MOST_MEMORY = 2**30
"""In bytes, of all inputs."""


@pytest.fixture(scope="module", autouse=True)
def memory() -> Iterator[None]:
    """No input may take much memory, here or in a child."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    before = [1024 * resource.getrusage(kind).ru_maxrss for kind in kinds]
    yield
    after = [1024 * resource.getrusage(kind).ru_maxrss for kind in kinds]
    assert after[0] - before[0] < MOST_MEMORY
    assert after[1] < max(MOST_MEMORY, before[1] + 1)


# Meshes and surfaces


@pytest.fixture(scope="module")
def formats(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, bytes]]:
    """Ending and content of a small valid file in each format."""
    return written_meshes(tmp_path_factory.mktemp("formats"))


IMPATIENCE = 1.0
"""Time in s after which a reader that does not end is stopped here; a child has longer."""


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
            with limited(min(time_limit, IMPATIENCE), memory):
                mesh_files.main(*arguments)
        except _TimeIsUp:
            return Ended(-1, "", out_of_time=True)
        except (Exception, SystemExit):  # noqa: BLE001  whatever ends a child ends it only
            return Ended(1, traceback.format_exc())
        return Ended(0, "")

    monkeypatch.setattr(mesh_files, "run_child", run)


def read_all_ways(path: Path) -> None:
    """Reads a file as mesh and, if that is possible, as tetrahedra in regions and as surface."""
    try:
        read_foreign(path)
    except TactsimError:
        return
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
            loaded = read_foreign(path)
            assert len(loaded.points) >= 4, name
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
    assert mesh_store._stored(path) is None, "a damaged mesh counts as none"


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
    assert feed.state_now()["fault"].isprintable()
