"""Fields for ParaView."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pretence import pretended_result

from tactsim.errors import StorageError
from tactsim.outside import mesh_files
from tactsim.results import FieldFrame, Status, StepRecord
from tactsim.results.fields import read_fields, write_fields

FRAMES = pretended_result(Status.CONVERGED, "", tuple(StepRecord(k, 1, 0.0, {"displacement": k * 1e-4}) for k in (1, 2))).frames
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
TETRAHEDRON = np.vstack([CORNERS, [CORNERS[[i, j]].mean(axis=0) for i, j in EDGES]])


def test_a_viewer_reads_them(tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    write_fields(FRAMES, tmp_path)
    reader = pyvista.get_reader(str(tmp_path / "fields.pvd"))
    assert reader.time_values == [1.0, 2.0]
    reader.set_active_time_value(2.0)
    (grid,) = reader.read()
    assert set(grid.celltypes) == {pyvista.CellType.QUADRATIC_TRIANGLE}
    assert grid.point_data["displacement [m]"] == pytest.approx(np.full((6, 3), 2e-4))
    assert grid.cell_data["pressure [Pa]"] == pytest.approx([17.2e3])


def test_a_quadratic_tetrahedron_keeps_its_volume(tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    frame = FieldFrame(0.0, TETRAHEDRON, {"tetra10": np.arange(10)[None]}, {})
    write_fields([frame], tmp_path)
    grid = pyvista.read(tmp_path / "fields_0001.vtu")
    assert set(grid.celltypes) == {pyvista.CellType.QUADRATIC_TETRA}
    assert grid.compute_cell_sizes()["Volume"] == pytest.approx([1 / 6])


def test_the_index_names_files_relative_to_itself(tmp_path: Path) -> None:
    write_fields(FRAMES, tmp_path)
    text = (tmp_path / "fields.pvd").read_text(encoding="utf-8")
    assert 'file="fields_0002.vtu"' in text
    assert str(tmp_path) not in text


def test_frames_come_back_as_they_were(tmp_path: Path) -> None:
    cells = {"triangle": np.array([[0, 1, 2]]), "quad": np.array([[0, 1, 2, 3]])}
    flags = np.array([True, False, True, False])
    stress = np.arange(36.0).reshape(4, 3, 3)
    frame = FieldFrame(0.5, CORNERS, cells, {"flag": flags, "stress [Pa]": stress}, {"region": np.array([7, 8])})
    write_fields([frame], tmp_path)
    (again,) = read_fields(tmp_path)
    assert again.time == 0.5
    np.testing.assert_array_equal(again.points, CORNERS)
    np.testing.assert_array_equal(again.cells["quad"], cells["quad"])
    np.testing.assert_array_equal(again.point_data["flag"], flags)
    np.testing.assert_array_equal(again.point_data["stress [Pa]"], stress.reshape(4, 9))
    np.testing.assert_array_equal(again.cell_data["region"], [7, 8])


def test_all_frames_are_read_by_one_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_fields(FRAMES, tmp_path)
    started = []
    run_child = mesh_files.run_child
    monkeypatch.setattr(mesh_files, "run_child", lambda *args, **others: started.append(args) or run_child(*args, **others))
    assert [frame.time for frame in read_fields(tmp_path)] == [1.0, 2.0]
    assert len(started) == 1


def test_the_damaged_one_of_several_is_named(tmp_path: Path) -> None:
    write_fields(FRAMES, tmp_path)
    second = tmp_path / "fields_0002.vtu"
    second.write_bytes(second.read_bytes()[:900])
    with pytest.raises(StorageError, match=r"fields_0002\.vtu"):
        read_fields(tmp_path)


def test_no_frames_no_files(tmp_path: Path) -> None:
    write_fields([], tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert read_fields(tmp_path) == ()


def test_a_damaged_file_is_reported(tmp_path: Path) -> None:
    write_fields(FRAMES, tmp_path)
    content = (tmp_path / "fields_0001.vtu").read_bytes()
    for length in (0, len(content) // 3, len(content) - 20):  # the fuzzed files are cut everywhere
        (tmp_path / "fields_0001.vtu").write_bytes(content[:length])
        with pytest.raises(StorageError, match=r"fields_0001\.vtu"):
            read_fields(tmp_path)
    (tmp_path / "fields_0001.vtu").unlink()
    with pytest.raises(StorageError, match=r"fields_0001\.vtu"):
        read_fields(tmp_path)
    (tmp_path / "fields.pvd").write_text("<VTKFile", encoding="utf-8")
    with pytest.raises(StorageError, match=r"fields\.pvd is damaged"):
        read_fields(tmp_path)
