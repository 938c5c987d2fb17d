"""Files that a sweep names are looked for beside it, wherever the command and its workers run, before anything is computed."""

from __future__ import annotations

import json
import os
import shutil
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from tactsim.cli import command_sweep, main
from tactsim.dataset.checking import check
from tactsim.dataset.running.computing import computed
from tactsim.dataset.running.executors import Executor, LocalWorkers
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.blocks import decoded
from tactsim.dataset.store.opening import Store
from tactsim.errors import StorageError
from tactsim.outside.worker_pool import WorkerPool

SURFACE = Path(__file__).parents[2] / "meshes/lump.stl"
TEXT = """\
schema: tactsim/sweep/1
experiment:
  kind: grasp
  block: {size: [40 mm, 40 mm, 20 mm], tissue: icf_stable}
  inclusions:
    - shape: {kind: surface, path: mine.stl, unit: mm, translation: [{uniform: [18 mm, 22 mm]}, 18 mm, 11 mm]}
      material: lump
  matrix: {rows: 3, columns: 3, pitch: 10 mm, size: 9 mm}
  loading: {control: displacement, pieces: [{kind: ramp, to: 1 mm, duration: 1 s}]}
  mesh: {kind: tetrahedra, size: 4 mm}
sweep: {samples: 2, seed: 1}
"""


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sweep with a surface beside it; the working folder is another."""
    for name in ("cases", "elsewhere"):
        (tmp_path / name).mkdir()
    path = tmp_path / "cases/sweep.yaml"
    path.write_text(TEXT, encoding="utf-8")
    shutil.copyfile(SURFACE, path.with_name("mine.stl"))
    monkeypatch.chdir(tmp_path / "elsewhere")
    return path


def test_the_folder_goes_with_the_tasks_and_is_no_part_of_the_identity(case: Path) -> None:
    sweep = load_sweep(os.path.relpath(case))
    assert sweep.folder == str(case.parent)
    assert str(case.parent) not in sweep.text
    moved = case.parent.parent / "moved.yaml"
    shutil.copyfile(case, moved)
    assert load_sweep(moved).identity == sweep.identity
    block = decoded(computed(sweep.text, [0, 1], "not run", folder=sweep.folder))
    assert np.isfinite(block["inclusion_center"]).any()
    assert set(block["case_id"]) == set(decoded(computed(load_sweep(case).text, [0, 1], "x", folder=sweep.folder))["case_id"])


@pytest.mark.slow  # it makes the mesh
def test_a_process_finds_the_file(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sweep = load_sweep(case)
    with closing(
        LocalWorkers(sweep.text.replace('"seed": 1', '"seed": 1, "time_limit": 1e-9'), 1, folder=sweep.folder)
    ) as workers:
        workers.submit((0,))
        while not (outcomes := workers.wait(1.0)):
            pass
    block = decoded(outcomes[0].block or b"")
    assert "mine.stl" not in block["reason"][0]
    assert np.isfinite(block["inclusion_center"]).any()


def test_the_folder_is_sent_to_processes(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sweep, sent = load_sweep(case), []
    monkeypatch.setattr(WorkerPool, "submit", lambda pool, key, request: sent.append(json.loads(request)))
    with closing(LocalWorkers(sweep.text, 1, folder=sweep.folder)) as workers:
        workers.submit((0,))
    assert sent[0]["folder"] == str(case.parent)


class Lost(Executor):
    """Gives every sample up without running it."""

    def __init__(self, sweep: object):
        self.sweep, self.tasks = sweep, []

    slots = 1

    def submit(self, samples: tuple[int, ...]) -> None:
        self.tasks.append(samples)

    def wait(self, seconds: float) -> list:
        from tactsim.dataset.running.executors import TaskOutcome

        task = self.tasks.pop()
        return [TaskOutcome(task, computed(self.sweep.text, task, "not run", folder=self.sweep.folder))]

    def close(self) -> None:
        self.tasks = []


def test_a_sweep_from_another_folder(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command_sweep, "_executor", lambda sweep, arguments: Lost(sweep))
    store = case.parent.parent / "s.zarr"
    assert main(["sweep", str(case), "--out", str(store), "--quiet"]) == 3
    assert (Store.open(store).read("inclusion_kind")[:, 0] == 4).all()
    with pytest.raises(StorageError, match=r"mine\.stl.*run tactsim there"):
        check(store)
    monkeypatch.chdir(case.parent)
    assert check(store).findings == ()
    assert main(["data", "info", str(store)]) == 0


def test_a_file_that_is_missing_is_reported_before_anything_is_computed(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.with_name("mine.stl").unlink()
    assert main(["sweep", str(case), "--out", "s.zarr"]) == 5
    error = capsys.readouterr().err
    assert "mine.stl" in error
    assert "looked in the folder of the case and in the working folder" in error
    assert not Path("s.zarr").exists()
