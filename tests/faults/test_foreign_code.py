"""Files of the working folder or of PYTHONPATH that are called like modules never run in a process that tactsim starts."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from tactsim.mesh.foreign import read_foreign
from tactsim.mesh.tetrahedra import tetrahedra_in_child
from tactsim.outside.processes import run_child
from tactsim.outside.worker_pool import WorkerPool

NAMES = ("tactsim", "numpy", "meshio", "runpy", "multiprocessing", "pytetwild", "pyvista", "sitecustomize", "json")


@pytest.fixture
def hostile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder, also on PYTHONPATH, with a file for every module that a child may import; each leaves a mark."""
    for name in NAMES:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r})\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return tmp_path


def executed(folder: Path) -> str:
    mark = folder / "executed"
    return mark.read_text() if mark.exists() else ""


def test_the_files_are_hostile(hostile: Path) -> None:
    subprocess.run([sys.executable, "-m", "tactsim"], check=False, capture_output=True)
    assert "tactsim" in executed(hostile), "without isolation they do run"


def test_a_reader_of_meshes_is_isolated(hostile: Path) -> None:
    cells = [("tetra", np.array([[0, 1, 2, 3]]))]
    meshio.write("mesh.vtk", meshio.Mesh(np.vstack([np.zeros(3), np.eye(3)]), cells))
    assert len(read_foreign("mesh.vtk").points) == 4
    assert executed(hostile) == ""


def test_the_mesher_is_isolated(hostile: Path) -> None:
    corners = np.vstack([np.zeros(3), np.eye(3)])
    request = {
        "vertices": corners,
        "faces": np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.int32),
        "edge_length_abs": np.array(0.5),
        "epsilon": np.array(1e-3),
        "stop_energy": np.array(10.0),
    }
    assert len(tetrahedra_in_child(request, 60.0)[1])
    assert executed(hostile) == ""


def test_the_renderer_is_isolated(hostile: Path) -> None:
    from tactsim.plotting.off_screen import MODULE

    assert run_child(MODULE, ["no scene", "no picture"], time_limit=60).code != 0
    assert executed(hostile) == ""


def test_workers_are_isolated(hostile: Path) -> None:
    pool: WorkerPool[int] = WorkerPool("tactsim.dataset.running.executors", (), 1)
    pool.submit(0, b'{"sweep": "{}", "samples": [0]}')
    (answer,) = pool.wait()
    pool.close()
    assert answer.content is not None
    assert answer.content[:1] in (b"?", b"!")
    assert executed(hostile) == ""


def test_the_module_run_as_a_program_is_isolated(tmp_path: Path) -> None:
    for name in NAMES[1:]:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r})\n", encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": ""}
    (tmp_path / "json.py").unlink()  # Python itself imports it before any program of ours begins
    (tmp_path / "runpy.py").unlink()
    done = subprocess.run(
        [sys.executable, "-m", "tactsim.cli", "material"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, executed(tmp_path)) == (0, ""), done.stderr
