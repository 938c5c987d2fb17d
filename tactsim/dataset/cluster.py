"""The same tasks on a Dask cluster that Dask's own commands started."""

from __future__ import annotations

import re
import time
from typing import Any

from tactsim.dataset.executor import Executor, Outcome
from tactsim.errors import CaseError, InputError, StorageError, shown

ADDRESS = re.compile(r"([a-z]+://)?([^\s/:]+|\[[0-9a-fA-F:]+\]):\d{1,5}")
"""What Dask prints as the address of a scheduler."""
CONNECTING = 30.0
"""Seconds to wait for the scheduler."""
TASKS_PER_THREAD = 2
"""Tasks under way for each thread of the cluster, so that none waits for the network."""


class Cluster(Executor):
    """A client of a Dask scheduler; losing it ends the sweep, losing a worker does not."""

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
        from tactsim.dataset.computing import computed

        self._tasks[self._client.submit(computed, self._text, samples, folder=self._folder, pure=False)] = samples

    def wait(self, seconds: float) -> list[Outcome]:
        """What the cluster finished, and the tasks that it gave up."""
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
        """Leaves the cluster; once is enough."""
        if self._client.status == "closed":
            return
        self._client.cancel(list(self._tasks))
        self._tasks = {}
        self._client.close()

    def _outcome(self, future: Any, samples: tuple[int, ...]) -> Outcome:
        from distributed.scheduler import KilledWorker

        if future.status == "finished":
            return Outcome(samples, future.result())
        error = future.exception() if future.status == "error" else None
        if error is None or isinstance(error, KilledWorker):
            return Outcome(samples, None, "its Dask worker was lost")
        if isinstance(error, CaseError):
            raise error
        raise StorageError(f"the cluster cannot compute samples {samples[0]} to {samples[-1]}: {type(error).__name__}: {error}")
