"""Slow work beside the frames, in threads that end with the process: estimates and shapes.

One of each at a time, and only the latest that is wanted; closing the page waits for none of them.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable
from concurrent.futures import Future
from functools import partial
from queue import SimpleQueue
from typing import Any, TypeVar

from tactsim.errors import TactsimError
from tactsim.interfaces.readings import Readings
from tactsim.live.defects import report
from tactsim.live.session.choices import Choice
from tactsim.live.session.estimating import estimated
from tactsim.live.session.messages import plain_json
from tactsim.live.sources.reference import Reference
from tactsim.live.sources.scene import PageScene
from tactsim.outside.text import one_line

Send = Callable[[str], Awaitable[None]]
PATIENCE = 0.3
"""Time in s after which the page says that an estimate is being computed."""
REST = 0.1
"""Time in s from one message to the next: estimates in words cannot be read faster."""
Made = TypeVar("Made")
MOST_THREADS = 4
"""Estimates and shapes that are made at the same time, of all pages together."""


class Latest:
    """Does one thing at a time; what is wanted meanwhile replaces what was wanted before and not begun."""

    def __init__(self, send: Send, threads: Threads, *, waiting: str | None = None):
        self._send, self._threads, self._waiting = send, threads, waiting
        self._wanted: Callable[[], str] | None = None
        self._task: asyncio.Task[None] | None = None

    def want(self, make: Callable[[], str]) -> None:
        """Makes a message in a thread and sends it."""
        self._wanted = make
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._work())

    def cancel(self) -> None:
        """Sends no more."""
        if self._task is not None:
            self._task.cancel()

    async def _work(self) -> None:
        while self._wanted is not None:
            make, self._wanted = self._wanted, None
            working = asyncio.ensure_future(self._threads.run(partial(message_or_fault, make)))
            if self._waiting is not None:
                await asyncio.wait([working], timeout=PATIENCE)
                if not working.done():
                    await self._send(self._waiting)
            message = await working
            await self._send(message)
            await asyncio.sleep(REST)


class Thinking:
    """Estimates and shapes of one page."""

    def __init__(self, send: Send, threads: Threads):
        busy = plain_json({"is": "estimate", "busy": True})
        self._estimates, self._shapes = Latest(send, threads, waiting=busy), Latest(send, threads)

    def estimate(self, scene: PageScene, readings: Readings | TactsimError, choice: Choice, reference: Reference | None) -> None:
        """Has an estimate made and sent."""
        self._estimates.want(lambda: estimate_message(scene, readings, choice, reference))

    def shape(self, scene: PageScene, make: Callable[[PageScene], str]) -> None:
        """Has shapes made and sent."""
        self._shapes.want(lambda: make(scene))

    def cancel(self) -> None:
        """Sends no more."""
        self._estimates.cancel()
        self._shapes.cancel()


def message_or_fault(make: Callable[[], str]) -> str:
    """The message that is made, or one that says what went wrong."""
    try:
        return make()
    except TactsimError as error:
        words = str(error)
    except Exception as error:  # noqa: BLE001  whatever goes wrong beside the frames, the page goes on and tells it
        words = report(error)
    return plain_json({"is": "fault", "words": words})


def estimate_message(scene: PageScene, readings: Readings | TactsimError, choice: Choice, reference: Reference | None) -> str:
    """What the estimator finds, or why it cannot."""
    found: dict[str, Any] = {"present": None, "words": [], "errors": [], "inclusions": []}
    try:
        if isinstance(readings, TactsimError):
            raise readings
        found = estimated(scene, readings, choice, reference)
        fault = ""
    except TactsimError as error:
        fault = str(error)
    except Exception as error:  # noqa: BLE001  whatever an estimator does wrong, the page goes on and tells it
        fault = f"internal error of the estimator ({type(error).__name__}: {one_line(error, 200)}); please report it"
    return plain_json({"is": "estimate", "busy": False, "estimator": choice.name, "fault": fault} | found)


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
