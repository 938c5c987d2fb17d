"""Where samples are computed: processes of this machine, one thread each, or a Dask cluster that Dask's own commands started."""

from __future__ import annotations

import json
import re
import sys
import time
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Self

from tactsim.dataset.sampling.sweep import Sweep
from tactsim.errors import CaseError, InputError, StorageError, TactsimError, shown
from tactsim.outside.environment import usable_cores
from tactsim.outside.processes import BROKEN, serve
from tactsim.outside.worker_pool import Answer, WorkerPool

MODULE = "tactsim.dataset.running.executors"
DONE, REFUSED = b"=", b"?"
"""First byte of an answer: a block as it stands in the journal, or a fault of the sweep."""
ADDRESS = re.compile(r"([a-z]+://)?([^\s/:]+|\[[0-9a-fA-F:]+\]):\d{1,5}")
"""What Dask prints as the address of a scheduler."""
CONNECTING = 30.0
"""Seconds to wait for the scheduler."""
WORTH_A_PROCESS = 8.0
"""Time in s that a short sweep must take before another process pays: it takes 3 to 5 s to begin, on the core of the first."""
SHORT = 8
"""Samples for each process below which a sweep is short."""
TASKS_PER_THREAD = 2
"""Tasks under way for each thread of the cluster, so that none waits for the network."""


@dataclass(frozen=True)
class TaskOutcome:
    """What became of a task: the bytes of its block, or None if its worker was lost, with the reason."""

    samples: tuple[int, ...]
    block: bytes | None
    reason: str = ""


class Executor(ABC):
    """Computes tasks, each a tuple of numbers of samples."""

    @property
    @abstractmethod
    def slots(self) -> int:
        """How many tasks it can use at once."""

    @abstractmethod
    def submit(self, samples: tuple[int, ...]) -> None:
        """Begins a task."""

    @abstractmethod
    def wait(self, seconds: float) -> list[TaskOutcome]:
        """Tasks that ended, as soon as there is one; empty after so many seconds.

        Raises
        ------
        CaseError
            If the sweep itself is at fault.
        TactsimError
            If a worker met a defect of this program.
        """

    @abstractmethod
    def close(self) -> None:
        """Gives up what is not finished and frees the workers."""


class LocalWorkers(Executor):
    """Talks to its processes in bytes: the sweep and then numbers of samples as JSON, blocks as they stand in the journal.

    Processes after the first begin ``patience`` in s later.
    """

    def __init__(self, text: str, count: int, *, folder: str | None = None, patience: float = 0.0):
        self._text, self._folder = text, folder
        self._pool: WorkerPool[tuple[int, ...]] = WorkerPool(MODULE, (), count, patience=patience)

    @classmethod
    def of(cls, sweep: Sweep, count: int | None) -> Self:
        """Those of a sweep; by default one per core, not more than samples, and at first one alone if the sweep is short.

        Raises
        ------
        InputError
            If the count is no whole number from 1 on.
        """
        if count is not None:
            if not isinstance(count, int) or count < 1:
                raise InputError(f"workers is {shown(count)}; allowed: whole numbers from 1 on, or None for one per core")
            return cls(sweep.text, count, folder=sweep.folder)
        count = min(usable_cores(), sweep.samples)
        patience = WORTH_A_PROCESS if sweep.samples < SHORT * count else 0.0
        return cls(sweep.text, count, folder=sweep.folder, patience=patience)

    @property
    def slots(self) -> int:
        """Number of processes."""
        return self._pool.count

    @property
    def processes(self) -> list[int]:
        """Their identifiers."""
        return self._pool.processes

    def submit(self, samples: tuple[int, ...]) -> None:
        """Gives a task to an idle process, starting one if need be."""
        self._pool.submit(samples, json.dumps({"sweep": self._text, "folder": self._folder, "samples": samples}).encode())

    def wait(self, seconds: float) -> list[TaskOutcome]:
        """What the processes finished, and the tasks of those that died.

        Raises
        ------
        CaseError, TactsimError
            As ``Executor.wait``.
        """
        return [_outcome(answer) for answer in self._pool.wait(seconds)]

    def close(self) -> None:
        """Ends the processes."""
        self._pool.close()


def _outcome(answer: Answer[tuple[int, ...]]) -> TaskOutcome:
    """What became of a task.

    Raises
    ------
    CaseError
        If the sweep itself is at fault.
    TactsimError
        If the process met a defect of this program.
    """
    task = answer.key
    if answer.content is None:
        return TaskOutcome(task, None, f"its process ended ({answer.ending})")
    kind, content = answer.content[:1], answer.content[1:]
    if kind == REFUSED:
        raise CaseError(content.decode(errors="replace"))
    if kind == BROKEN:
        raise TactsimError(f"a worker failed at samples {task[0]} to {task[-1]}: {content.decode(errors='replace')}")
    return TaskOutcome(task, content)


class Cluster(Executor):
    """A client of a Dask scheduler; losing it ends the sweep, losing a worker does not.

    Raises
    ------
    InputError
        If Dask is not installed, or ``address`` is not of the form HOST:PORT.
    StorageError
        If no scheduler answers at the address.
    """

    def __init__(self, text: str, address: str, *, folder: str | None = None):
        try:
            import distributed
        except ImportError:
            raise InputError("--scheduler needs Dask; install it with: pip install 'tactsim[cluster]'") from None
        if not ADDRESS.fullmatch(address):
            raise InputError(f"--scheduler {shown(address)} is no address; expected HOST:PORT, such as tcp://host:8786")
        try:
            self._client: Any = distributed.Client(address, timeout=CONNECTING, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            raise StorageError(f"no Dask scheduler answers at {address}: {error}; start one with: dask scheduler") from None
        self._text, self._folder = text, folder
        self._tasks: dict[Any, tuple[int, ...]] = {}

    @property
    def slots(self) -> int:
        """Tasks for the threads that the cluster has now, at least one."""
        return max(1, TASKS_PER_THREAD * sum(self._client.nthreads().values()))

    def submit(self, samples: tuple[int, ...]) -> None:
        """Sends a task to the cluster."""
        from tactsim.dataset.running.computing import computed

        self._tasks[self._client.submit(computed, self._text, samples, folder=self._folder, pure=False)] = samples

    def wait(self, seconds: float) -> list[TaskOutcome]:
        """What the cluster finished, and the tasks that it gave up.

        Raises
        ------
        CaseError
            If the sweep itself is at fault.
        StorageError
            If the cluster cannot compute a task.
        """
        import distributed

        if not self._tasks:
            time.sleep(min(seconds, 0.05))
            return []
        try:
            with self._client.as_current():
                done = distributed.wait(list(self._tasks), timeout=seconds, return_when="FIRST_COMPLETED").done
        except (TimeoutError, distributed.TimeoutError):
            return []
        return [self._outcome(future, self._tasks.pop(future)) for future in done]

    def close(self) -> None:
        """Leaves the cluster; a second call does nothing."""
        if self._client.status == "closed":
            return
        self._client.cancel(list(self._tasks))
        self._tasks = {}
        self._client.close()

    def _outcome(self, future: Any, samples: tuple[int, ...]) -> TaskOutcome:
        from distributed.scheduler import KilledWorker

        if future.status == "finished":
            return TaskOutcome(samples, future.result())
        error = future.exception() if future.status == "error" else None
        if error is None or isinstance(error, KilledWorker):
            return TaskOutcome(samples, None, "its Dask worker was lost")
        if isinstance(error, CaseError):
            raise error
        raise StorageError(f"the cluster cannot compute samples {samples[0]} to {samples[-1]}: {type(error).__name__}: {error}")


def main(descriptor: str) -> None:
    """The life of a process: tasks in, blocks out."""
    serve(descriptor, _block)


def _block(task: bytes) -> bytes:
    from tactsim.dataset.running.computing import computed

    asked = json.loads(task)
    try:
        return DONE + computed(asked["sweep"], asked["samples"], folder=asked["folder"])
    except CaseError as error:
        return REFUSED + str(error).encode()


if __name__ == "__main__":
    main(*sys.argv[1:])
