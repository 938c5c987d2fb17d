"""Slow work in a few threads that end with the process: closing the page waits for none of them."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, TypeVar

Made = TypeVar("Made")
MOST_THREADS = 4
"""Estimates and shapes that are made at the same time, of all pages together."""


class Threads:
    """Daemon threads that share the work; asyncio's own would hold up the end of the process until they are done."""

    def __init__(self, most: int = MOST_THREADS):
        self._most, self._started = most, 0
        self._work: SimpleQueue[tuple[Future[Any], Callable[[], Any]] | None] = SimpleQueue()

    async def run(self, make: Callable[[], Made]) -> Made:
        """What ``make`` returns or raises; it is not begun if nobody waits any more."""
        answer: Future[Made] = Future()
        self._work.put((answer, make))
        if self._started < self._most:
            threading.Thread(target=self._serve, daemon=True, name="live work").start()
            self._started += 1
        return await asyncio.wrap_future(answer)

    def close(self) -> None:
        """Ends every thread after what it is doing."""
        for _ in range(self._started):
            self._work.put(None)

    def _serve(self) -> None:
        while (work := self._work.get()) is not None:
            answer, make = work
            if not answer.set_running_or_notify_cancel():
                continue
            try:
                answer.set_result(make())
            except BaseException as error:  # noqa: BLE001  it is raised where the answer is awaited
                answer.set_exception(error)
