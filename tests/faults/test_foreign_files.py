"""Files of strangers that are too large once unpacked, no regular files, or none of a case's business: refused at once."""

from __future__ import annotations

import io
import os
import resource
import time
import zipfile
import zlib
from base64 import b64encode
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from live_pages import grasp_folder

from tactsim.cli import main
from tactsim.errors import InvalidQuantity, StorageError, TactsimError
from tactsim.identification.columns import read_columns
from tactsim.identification.table import read_table
from tactsim.identification.uniaxial_data import read_uniaxial_curve
from tactsim.localization.networks import read_weights
from tactsim.mesh.foreign import read_foreign
from tactsim.mesh.inclusions.surface import read_surface
from tactsim.outside.arrays import read_arrays
from tactsim.outside.files import CasePath

PATIENCE = 20.0
"""Time in s for what is refused at once on an idle machine."""
CURVE = "strain [%], nominal stress [kPa]\n1,2\n2,4\n3,6\n"
SECRET = "root:$6$hunter2:19000:0:99999:7:::"
DMA = "schema: tactsim/case/1\nexperiment:\n  kind: dma_identification\n  data: {{kind: file, path: {path}}}\n"
MESH = """schema: tactsim/case/1
experiment:
  kind: grasp
  block: {{size: [40 mm, 40 mm, 20 mm], tissue: icf_stable}}
  matrix: {{rows: 3, columns: 3, pitch: 10 mm, size: 9 mm}}
  loading: {{control: displacement, pieces: [{{kind: ramp, to: 1 mm, duration: 1 s}}]}}
  mesh: {{kind: file, path: {path}, unit: mm}}
"""


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs a command that must end soon with an error in words, which it returns."""

    def run(*arguments: str, codes: tuple[int, ...] = (2, 5)) -> str:
        begin = time.monotonic()
        assert main(list(arguments)) in codes
        assert time.monotonic() - begin < PATIENCE
        printed = capsys.readouterr().err
        assert "internal error" not in printed
        assert "Traceback" not in printed
        return printed

    return run


def children_memory() -> int:
    """Largest memory in bytes that any child of this process has had."""
    return 1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss


def small_vtu_of_many_zeros(blocks: int = 3000, each: int = 2**20) -> bytes:
    """A compressed file of less than 3 MB whose points unpack to 3 GB, in the form that VTK writes."""
    packed = zlib.compress(bytes(each), 9)
    head = np.array([blocks, each, 0, *[len(packed)] * blocks], "<u4").tobytes()
    data = (b64encode(head) + b64encode(packed * blocks)).decode()
    array = f'<DataArray type="Float64" Name="P" NumberOfComponents="3" format="binary">{data}</DataArray>'
    ints = '<DataArray type="Int64" Name="{}" format="ascii">{}</DataArray>'
    cells = "".join(ints.format(*pair) for pair in (("connectivity", "0 1 2 3"), ("offsets", "4"), ("types", "10")))
    count = blocks * each // 24
    piece = f'<Piece NumberOfPoints="{count}" NumberOfCells="1"><Points>{array}</Points><Cells>{cells}</Cells></Piece>'
    head_line = 'type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" compressor="vtkZLibDataCompressor"'
    return f'<?xml version="1.0"?><VTKFile {head_line}><UnstructuredGrid>{piece}</UnstructuredGrid></VTKFile>'.encode()


def bomb(header: str, size: int = 64) -> bytes:
    """An npz file whose only array says something of itself; its content is ``size`` zeros."""
    text = header.encode().ljust(117) + b"\n"
    written = io.BytesIO()
    with (
        zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("schema.npy", "w") as entry,
    ):
        entry.write(b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text)
        for _ in range(max(1, size // 2**24)):
            entry.write(bytes(min(size, 2**24)))
    return written.getvalue()


def test_a_small_file_that_unpacks_to_gigabytes(tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    path.write_bytes(small_vtu_of_many_zeros())
    assert path.stat().st_size < 6e6
    before = children_memory()
    with pytest.raises(TactsimError, match="more memory than a file of"):
        read_foreign(path)
    assert children_memory() < max(before + 1, 1.5e9)


@pytest.mark.parametrize(
    "header",
    [
        "{'descr': '<f8', 'fortran_order': False, 'shape': (4000000000,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (0, 4000000000), }",
        "{'descr': '<U999999999', 'fortran_order': False, 'shape': (), }",
        "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
        "{{{{{{{{{{{{{{{{",
    ],
)
def test_headers_that_promise_too_much(tmp_path: Path, refused: Callable[..., str], header: str) -> None:
    path = tmp_path / "w.npz"
    path.write_bytes(bomb(header))
    with pytest.raises(StorageError):
        read_weights(path)
    folder = str(grasp_folder(tmp_path / "grasp"))
    assert refused("show", folder, "--web", "--no-browser", "--learned", str(path), codes=(5,))


@pytest.mark.slow
def test_weights_that_unpack_to_gigabytes(tmp_path: Path) -> None:
    path = tmp_path / "w.npz"
    path.write_bytes(bomb("{'descr': '|u1', 'fortran_order': False, 'shape': (1600000000,), }", 1_600_000_000))
    assert path.stat().st_size < 9e6
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(StorageError, match="unpacks to more than"):
        read_weights(path)
    assert 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) < 3e8


@pytest.mark.parametrize("what", ["pipe", "device", "folder", "link to a pipe", "nothing"])
@pytest.mark.parametrize(
    "where", ["case", "mesh.path", "data.path", "surface", "--learned", "--fit", "result", "--reference", "--live"]
)
def test_what_is_no_file_is_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: Callable[..., str], what: str, where: str
) -> None:
    monkeypatch.chdir(tmp_path)
    place = tmp_path / ("x.stl" if where == "surface" else "x.vtu")
    if what == "folder":
        place.mkdir()
    elif what == "device":
        place.symlink_to("/dev/zero")
    elif what != "nothing":
        pipe = tmp_path / "pipe" if "link" in what else place
        os.mkfifo(pipe)
        if pipe != place:
            place.symlink_to(pipe)
    case = tmp_path / "case.yaml"
    if where in ("mesh.path", "data.path"):
        case.write_text((MESH if where == "mesh.path" else DMA).format(path=place.name), encoding="utf-8")
    if where == "surface":
        with pytest.raises(TactsimError):
            read_surface(str(place))
        return
    page = ["--web", "--no-browser"]
    commands = {
        "case": ["run", str(place)],
        "mesh.path": ["run", str(case), "--out", "out"],
        "data.path": ["run", str(case), "--out", "out"],
        "--learned": ["show", "grasp", *page, "--learned", str(place)],
        "--fit": ["material", "--fit", str(place)],
        "result": ["show", str(place)],
        "--reference": ["show", "grasp", *page, "--reference", str(place)],
        "--live": ["show", *page, "--live", str(place)],
    }
    if "grasp" in commands[where]:
        grasp_folder(tmp_path / "grasp")
    assert refused(*commands[where]).startswith("error: ")


def test_a_result_whose_files_are_pipes(tmp_path: Path, refused: Callable[..., str]) -> None:
    for name in ("result.json", "provenance.json"):
        folder = grasp_folder(tmp_path / name.partition(".")[0])
        (folder / name).unlink()
        os.mkfifo(folder / name)
        assert "allowed: a regular file" in refused("show", str(folder), codes=(5,))


@pytest.mark.parametrize("content", [SECRET + "\n", SECRET + "\nmore, text\n", SECRET.replace(":", ",") + "\n1,2,3\n4,5,6\n"])
@pytest.mark.parametrize("named", ["absolute", "link"])
def test_no_case_can_have_the_content_of_another_file_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: Callable[..., str], content: str, named: str
) -> None:
    hidden, case = tmp_path / "etc" / "shadow", tmp_path / "work" / "case.yaml"
    for path in (hidden, case):
        path.parent.mkdir()
    hidden.write_text(content, encoding="utf-8")
    link = case.with_name("data.csv")
    link.symlink_to(hidden)
    case.write_text(DMA.format(path=hidden if named == "absolute" else link.name), encoding="utf-8")
    monkeypatch.chdir(case.parent)
    assert "hunter2" not in refused("run", str(case), "--out", "out")


def assert_not_reported(folder: Path, suffix: str) -> None:
    """Refuse a reader of meshes that quotes a file anywhere on the machine which a case names."""
    (folder / "work").mkdir(exist_ok=True)
    hidden = folder / f"shadow{suffix}"
    hidden.write_text(f"{SECRET}\n" * 3, encoding="utf-8")
    with pytest.raises(TactsimError) as caught:
        read_foreign(CasePath(str(hidden), folder / "work"))
    assert "hunter2" not in str(caught.value)


@pytest.mark.usefixtures("reader_here")
@pytest.mark.parametrize(
    "suffix", [".obj", ".inp", ".mesh", ".msh", ".bdf", ".vtk", ".stl", ".ply", ".su2", ".off", ".vtu", ".mdpa"]
)
def test_no_reader_of_meshes_reports_the_content_of_another_file(tmp_path: Path, suffix: str) -> None:
    assert_not_reported(tmp_path, suffix)


@pytest.mark.parametrize("suffix", [".inp", ".vtu"])
def test_no_reader_in_a_process_of_its_own_reports_it_either(tmp_path: Path, suffix: str) -> None:
    assert_not_reported(tmp_path, suffix)


def test_a_table_of_text_is_not_quoted_even_beside_the_case(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(SECRET, encoding="utf-8")
    for read in (read_uniaxial_curve, lambda path: read_columns(path, {"time": "s", "force": "N"})):
        with pytest.raises(InvalidQuantity) as caught:
            read(path)
        assert "hunter2" not in str(caught.value)
        assert "(contents hidden: no row of the file holds two numbers or more" in str(caught.value)


@pytest.mark.parametrize(
    "header",
    [
        "Strain (%),Stress (kPa)",
        "strain [%],nominal stress [kPa]",
        "strain [%],engineering stress [kPa]",
        "STRAIN [%], Stress [KPa]".replace("KPa", "kPa"),
        "engineering_strain_%,engineering_stress_kPa",
        "Engineering Strain (percent), Nominal Stress (kPa)",
    ],
)
def test_headers_as_instruments_write_them(tmp_path: Path, header: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"{header}\n1,2\n2,4\n3,6\n", encoding="utf-8")
    curve = read_uniaxial_curve(path)
    np.testing.assert_allclose(curve.stretch, [1.01, 1.02, 1.03])
    np.testing.assert_allclose(curve.nominal_stress, [2e3, 4e3, 6e3])


@pytest.mark.parametrize("separator", [";", "\t"])
def test_decimal_commas_are_read_where_columns_are_separated_otherwise(tmp_path: Path, separator: str) -> None:
    path = tmp_path / "a.csv"
    rows = ("strain [%];stress [kPa]", "0,5;1,5", "1,5;4,5", "2;6")
    path.write_text("\n".join(rows).replace(";", separator), encoding="utf-8")
    np.testing.assert_allclose(read_uniaxial_curve(path).stretch, [1.005, 1.015, 1.02])


def test_decimal_commas_among_commas_are_reported(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(CURVE + "0,5;1,5\n", encoding="utf-8")
    with pytest.raises(InvalidQuantity, match="3 values in a row of 2 columns"):
        read_uniaxial_curve(path)


def test_a_table_of_millions_of_cells_is_refused_before_it_is_taken_apart(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for content in (b"\n" * 4_000_000, b"1," * 11_000_000):
        path.write_bytes(content)
        with pytest.raises(InvalidQuantity, match="more than 3000000 lines or 10000000 cells"):
            read_table(path)


def test_arrays_without_length_take_nothing() -> None:
    with pytest.raises(StorageError):
        read_arrays(bomb("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 9223372036854775807, 9), }"), "a")


@pytest.mark.parametrize("kind", ["<U4", ">U4"])
def test_characters_that_do_not_exist_are_damage(kind: str) -> None:
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': (), }}".encode().ljust(117) + b"\n"
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w") as archive:
        archive.writestr("schema.npy", b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + b"\x7f\x7f\x7f\x7f" * 4)
    with pytest.raises(StorageError, match="characters that do not exist"):
        read_arrays(written.getvalue(), "a")
