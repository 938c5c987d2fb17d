"""A number of workers that share requests; a lost worker costs the request it had and is replaced."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Generic, TypeVar

from tactsim.outside.environment import ONE_THREAD, own_cores, usable_cores
from tactsim.outside.processes import Worker

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Answer(Generic[Key]):
    """What became of a request: its content, or how the worker ended that had it."""

    key: Key
    content: bytes | None
    ending: str = ""


class WorkerPool(Generic[Key]):
    """Starts workers of one thread each as requests come, ``count`` at most.

    The first begins at once, the others ``patience`` in s later: what it answers meanwhile need not pay for their beginning. If
    there are as many as cores, each keeps to one, with its caches; fewer are left to the system, which knows what else runs.
    """

    def __init__(self, module: str, arguments: Sequence[str], count: int, *, patience: float = 0.0):
        self._module, self._arguments, self.count = module, arguments, count
        self._patience, self._begun = patience, 0.0
        self._waiting: deque[tuple[Key, bytes]] = deque()
        self._workers: list[Worker] = []
        self._busy: dict[Worker, Key] = {}
        self._cores = own_cores() if count == usable_cores() else []
        self._core: dict[Worker, int] = {}

    @property
    def processes(self) -> list[int]:
        """Their numbers on this machine."""
        return [worker.pid for worker in self._workers]

    def submit(self, key: Key, request: bytes) -> None:
        """Gives a request to an idle worker, starting one if need be."""
        self._waiting.append((key, request))
        self._hand_out()

    def wait(self, seconds: float | None = None) -> list[Answer[Key]]:
        """What was answered, after ``seconds`` at most, and the requests of workers that died."""
        busy = {worker.connection: worker for worker in self._busy}
        patience = self._begun + self._patience - time.monotonic()
        if self._waiting and patience > 0 and (seconds is None or patience < seconds):
            seconds = patience
        answers = [self._answer(busy[ready]) for ready in wait(list(busy), seconds)]  # type: ignore[index]
        self._hand_out()
        return answers

    def close(self) -> None:
        """Ends the workers."""
        for worker in self._workers:
            worker.stop()
        self._workers, self._busy = [], {}
        self._waiting.clear()

    def _answer(self, worker: Worker) -> Answer[Key]:
        key = self._busy.pop(worker)
        try:
            return Answer(key, worker.connection.recv_bytes())
        except (EOFError, OSError):
            self._workers.remove(worker)
            return Answer(key, None, worker.ended())

    def _hand_out(self) -> None:
        while self._waiting:
            idle = next((worker for worker in self._workers if worker not in self._busy), None)
            early = bool(self._workers) and time.monotonic() < self._begun + self._patience
            if idle is None and (early or len(self._workers) >= self.count):
                return
            worker = idle or self._started()
            self._busy[worker], request = self._waiting.popleft()
            with suppress(OSError):  # a worker that died before shows in wait()
                worker.connection.send_bytes(request)

    def _started(self) -> Worker:
        worker = Worker(self._module, self._arguments, environment=ONE_THREAD)
        if not self._workers:
            self._begun = time.monotonic()
        taken = [self._core[other] for other in self._workers if other in self._core]
        if free := [core for core in self._cores if core not in taken]:
            self._core[worker] = free[0]
            os.sched_setaffinity(worker.pid, {free[0]})
        self._workers.append(worker)
        return worker
