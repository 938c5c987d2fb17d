"""Processes of this machine, one thread each; a lost one costs its own task only and is replaced."""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress

from tactsim.dataset.executor import Executor, Outcome
from tactsim.errors import CaseError, TactsimError
from tactsim.outside.processes import requests
from tactsim.outside.worker_pool import Answer, WorkerPool

MODULE = "tactsim.dataset.local_workers"
DONE, REFUSED, BROKEN = b"=", b"?", b"!"
"""First byte of an answer: a block as it stands in the journal, a fault of the sweep, a defect."""


class LocalWorkers(Executor):
    """Talks to its processes in bytes: the sweep and then numbers of samples as JSON, blocks as they stand in the journal."""

    def __init__(self, text: str, count: int, *, folder: str | None = None):
        self._text, self._folder = text, folder
        self._pool: WorkerPool[tuple[int, ...]] = WorkerPool(MODULE, (), count)

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

    def wait(self, seconds: float) -> list[Outcome]:
        """What the processes finished, and the tasks of those that died."""
        return [_outcome(answer) for answer in self._pool.wait(seconds)]

    def close(self) -> None:
        """Ends the processes."""
        self._pool.close()


def _outcome(answer: Answer[tuple[int, ...]]) -> Outcome:
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
        return Outcome(task, None, f"its process ended ({answer.ending})")
    kind, content = answer.content[:1], answer.content[1:]
    if kind == REFUSED:
        raise CaseError(content.decode(errors="replace"))
    if kind == BROKEN:
        raise TactsimError(f"a worker failed at samples {task[0]} to {task[-1]}: {content.decode(errors='replace')}")
    return Outcome(task, content)


def main(descriptor: str) -> None:
    """The life of a process: tasks in, blocks out, until the other end is gone."""
    connection = requests(descriptor)
    from tactsim.dataset.computing import computed

    with suppress(EOFError, OSError):
        while True:
            task = json.loads(connection.recv_bytes())
            try:
                answer = DONE + computed(task["sweep"], task["samples"], folder=task["folder"])
            except CaseError as error:
                answer = REFUSED + str(error).encode()
            except Exception as error:  # noqa: BLE001  a defect must reach the parent, not look like a lost process
                answer = BROKEN + f"{type(error).__name__}: {error}".encode()
            connection.send_bytes(answer)


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


if __name__ == "__main__":
    main(*sys.argv[1:])
