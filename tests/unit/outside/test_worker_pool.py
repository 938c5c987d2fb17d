"""Workers that share requests: others than the first begin only if it pays."""

from __future__ import annotations

from contextlib import closing

import pytest

from tactsim.dataset.running.executors import LocalWorkers
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.outside import worker_pool
from tactsim.outside.worker_pool import WorkerPool


class Pretended:
    """A worker that has begun and answers nothing."""

    begun, pid = 0, 10**9

    def __init__(self, *arguments: object, **options: object):
        type(self).begun += 1
        self.connection = self

    def send_bytes(self, request: bytes) -> None: ...

    def stop(self) -> None: ...


@pytest.mark.parametrize(("patience", "later"), [(0.0, 2), (8.0, 1)])
def test_others_than_the_first_wait_for_what_it_answers_meanwhile(
    patience: float, later: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = [100.0]
    monkeypatch.setattr(Pretended, "begun", 0)
    monkeypatch.setattr(worker_pool, "Worker", Pretended)
    monkeypatch.setattr(worker_pool, "own_cores", list)
    monkeypatch.setattr(worker_pool.time, "monotonic", lambda: clock[0])
    waited: list[float | None] = []
    monkeypatch.setattr(worker_pool, "wait", lambda busy, seconds: waited.append(seconds) or [])
    with closing(WorkerPool[int]("module", (), 2, patience=patience)) as pool:
        for number in range(3):
            pool.submit(number, b"")
        assert Pretended.begun == later
        clock[0] += 7.5
        pool.wait(1.0)
        assert waited == [1.0 if later == 2 else 0.5], "not beyond the time at which another one begins"
        clock[0] += 0.5
        pool.wait(1.0)
        assert Pretended.begun == 2, "no more than there may be"


@pytest.mark.parametrize(("count", "kept"), [(2, [4, 7, 4]), (1, []), (3, [])], ids=["as many as cores", "fewer", "more"])
def test_as_many_workers_as_cores_keep_to_one_each(count: int, kept: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    """One that takes the place of a lost one gets its core."""
    chosen = []
    monkeypatch.setattr(worker_pool, "Worker", Pretended)
    monkeypatch.setattr(worker_pool, "own_cores", lambda: [4, 7])
    monkeypatch.setattr(worker_pool, "usable_cores", lambda: 2)
    monkeypatch.setattr(worker_pool.os, "sched_setaffinity", lambda _, cores: chosen.extend(cores))
    with closing(WorkerPool[int]("module", (), count)) as pool:
        pool.submit(0, b"")
        pool.submit(1, b"")
        pool._workers.pop(0)
        pool.submit(2, b"")
    assert chosen == kept


def test_a_sweep_has_no_more_processes_than_samples_and_as_many_as_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tactsim.dataset.running.executors.usable_cores", lambda: 16)
    sweep = load_sweep("sweep_closed_form", samples=3)
    assert LocalWorkers.of(sweep, None).slots == 3
    assert LocalWorkers.of(sweep, 5).slots == 5


@pytest.mark.parametrize(("samples", "begun"), [(4, 1), (40, 2)], ids=["short", "long"])
def test_all_processes_of_a_long_sweep_begin_at_once(samples: int, begun: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tactsim.dataset.running.executors.usable_cores", lambda: 2)
    monkeypatch.setattr(worker_pool, "Worker", Pretended)
    monkeypatch.setattr(worker_pool, "own_cores", list)
    monkeypatch.setattr(Pretended, "begun", 0)
    with closing(LocalWorkers.of(load_sweep("sweep_closed_form", samples=samples), None)) as workers:
        workers.submit((0,))
        workers.submit((1,))
    assert Pretended.begun == begun
