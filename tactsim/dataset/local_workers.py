"""Processes of this machine, one thread each; a lost one costs its own task only and is replaced."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from tactsim.dataset.child_environment import child_environment
from tactsim.dataset.executor import Executor, Outcome
from tactsim.errors import CaseError, TactsimError

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
ORPHANED = 1.0
"""Seconds between looks at whether the parent still lives."""


@dataclass
class Worker:
    """A process and the task that it has."""

    process: SpawnProcess
    connection: Connection
    task: tuple[int, ...] | None = None


class LocalWorkers(Executor):
    """Talks to its processes in bytes: numbers of samples as JSON, blocks as they stand in the journal."""

    def __init__(self, text: str, count: int):
        self._text, self._count = text, count
        self._waiting: list[tuple[int, ...]] = []
        self._workers: list[Worker] = []

    @property
    def slots(self) -> int:
        """Number of processes."""
        return self._count

    @property
    def processes(self) -> list[int]:
        """Their identifiers."""
        return [worker.process.pid for worker in self._workers if worker.process.pid is not None]

    def submit(self, samples: tuple[int, ...]) -> None:
        """Gives a task to an idle process, starting one if need be."""
        self._waiting.append(samples)
        self._hand_out()

    def wait(self, seconds: float) -> list[Outcome]:
        """What the processes finished, and the tasks of those that died."""
        busy = {worker.connection: worker for worker in self._workers if worker.task is not None}
        ended = [self._outcome(busy[ready]) for ready in wait(list(busy), seconds)]  # type: ignore[index]
        self._hand_out()
        return ended

    def close(self) -> None:
        """Ends the processes."""
        for worker in self._workers:
            worker.connection.close()
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join(5)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
        self._workers = []

    def _outcome(self, worker: Worker) -> Outcome:
        task = worker.task or ()
        try:
            answer = worker.connection.recv_bytes()
        except (EOFError, OSError):
            worker.process.join()
            worker.connection.close()
            self._workers.remove(worker)
            return Outcome(task, None, f"its process ended ({_ending(worker.process.exitcode)})")
        worker.task = None
        if answer[:1] == b"?":
            raise CaseError(answer[1:].decode(errors="replace"))
        if answer[:1] == b"!":
            raise TactsimError(f"a worker failed at samples {task[0]} to {task[-1]}: {answer[1:].decode(errors='replace')}")
        return Outcome(task, answer[1:])

    def _hand_out(self) -> None:
        while self._waiting:
            idle = next((worker for worker in self._workers if worker.task is None), None)
            if idle is None and len(self._workers) >= self._count:
                return
            worker = idle or self._started()
            task = self._waiting.pop(0)
            worker.task = task
            with suppress(OSError):  # a process that died before shows in wait()
                worker.connection.send_bytes(json.dumps(task).encode())

    def _started(self) -> Worker:
        context = multiprocessing.get_context("spawn")
        own, other = context.Pipe()
        with child_environment(dict.fromkeys(THREADS, "1")):
            process = context.Process(target=serve, args=(other, self._text), daemon=True)
            process.start()
        other.close()
        worker = Worker(process, own)
        self._workers.append(worker)
        return worker


def serve(connection: Connection, text: str) -> None:
    """The life of a process: tasks in, blocks out, until the other end is gone."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)  # the parent decides when to stop
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    from tactsim.dataset.computing import computed

    with suppress(EOFError, OSError):
        while True:
            task = json.loads(connection.recv_bytes())
            try:
                answer = b"=" + computed(text, task)
            except CaseError as error:
                answer = f"?{error}".encode()
            except Exception as error:  # noqa: BLE001  a defect must reach the parent, not look like a lost process
                answer = f"!{type(error).__name__}: {error}".encode()
            connection.send_bytes(answer)


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(ORPHANED)
    os._exit(1)


def _ending(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            name = signal.Signals(-code).name
            return f"{name}, perhaps out of memory" if name == "SIGKILL" else name
    return f"exit code {code}"


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
