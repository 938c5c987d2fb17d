"""Workers that share requests: others than the first begin only if it pays."""

from __future__ import annotations

from contextlib import closing

import pytest

from tactsim.dataset.running.executors import WORTH_A_PROCESS, LocalWorkers
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.outside import worker_pool
from tactsim.outside.worker_pool import WorkerPool


class Pretended:
    """A worker that has begun and answers nothing."""

    begun = 0

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


def test_a_sweep_has_no_more_processes_than_samples_and_as_many_as_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tactsim.dataset.running.executors.usable_cores", lambda: 16)
    sweep = load_sweep("sweep_closed_form", samples=3)
    assert LocalWorkers.of(sweep, None).slots == 3
    assert LocalWorkers.of(sweep, 5).slots == 5
    assert WORTH_A_PROCESS > 0
