"""The same sweep on a Dask cluster of this machine, its workers started as Dask's own commands do."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sweeps import assert_same, small_store, sweep_file

from tactsim.cli import main
from tactsim.dataset.running import run as running
from tactsim.dataset.running.executors import Cluster
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.errors import InputError, StorageError

ENVIRONMENT = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
QUIET = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning", "ignore::FutureWarning")


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler on loopback, and its workers of one thread each."""
    address = folder / "scheduler.json"
    dask, started = [sys.executable, "-m", "dask"], []
    options = {"cwd": folder, "env": ENVIRONMENT, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        loopback = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(address)]
        started.append(subprocess.Popen([*dask, "scheduler", *loopback], **options))  # type: ignore[call-overload]
        while not address.exists():
            time.sleep(0.1)
        for _ in range(workers):
            command = [*dask, "worker", "--scheduler-file", str(address), "--nthreads", "1", "--no-nanny", "--no-dashboard"]
            started.append(subprocess.Popen(command, **options))  # type: ignore[call-overload]
        yield json.loads(address.read_text())["address"], started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


@QUIET
@pytest.mark.slow
def test_two_workers_give_the_same_data(tmp_path: Path) -> None:
    (tmp_path / "local").mkdir()
    whole = small_store(tmp_path / "local")
    with cluster(tmp_path, 2) as (address, _):
        case, place = str(sweep_file(tmp_path)), tmp_path / "cluster.zarr"
        assert main(["sweep", case, "--out", str(place), "--scheduler", address, "--quiet"]) == 0
    assert_same(whole, place)


@QUIET
@pytest.mark.slow
def test_a_worker_killed_in_the_middle_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "MOST_IN_TASK", 2)
    (tmp_path / "local").mkdir()
    whole = small_store(tmp_path / "local")
    sweep, place = load_sweep(sweep_file(tmp_path)), tmp_path / "cluster.zarr"
    with cluster(tmp_path, 2) as (address, workers), opened_run(sweep, place) as going:
        executor = Cluster(sweep.text, address)

        def kill_one(tally: object) -> None:
            if going.tally.done > 2 and workers[0].poll() is None:
                workers[0].send_signal(signal.SIGKILL)

        try:
            going.compute(executor, kill_one)
        finally:
            executor.close()
        assert workers[0].poll() is not None
    assert_same(whole, place)


@QUIET
def test_a_scheduler_that_does_not_answer_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tactsim.dataset.running.executors.CONNECTING", 0.3)
    with pytest.raises(StorageError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        Cluster(load_sweep(sweep_file(tmp_path)).text, "tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="'nonsense' is no address; expected HOST:PORT"):
        Cluster("", "nonsense")
