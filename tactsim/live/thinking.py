"""Slow work beside the frames, in threads: estimates and shapes. One of each at a time, and only the latest that is wanted."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

from tactsim.errors import TactsimError
from tactsim.interfaces.readings import Readings
from tactsim.live.choices import Choice
from tactsim.live.defects import report
from tactsim.live.estimating import estimated
from tactsim.live.messages import plain_json
from tactsim.live.reference import Reference
from tactsim.live.scene import Scene
from tactsim.live.threads import Threads
from tactsim.outside.text import one_line

Send = Callable[[str], Awaitable[None]]
PATIENCE = 0.3
"""Time in s after which the page says that an estimate is being computed."""
REST = 0.1
"""Time in s from one message to the next: estimates in words cannot be read faster."""


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

    def estimate(self, scene: Scene, readings: Readings | TactsimError, choice: Choice, reference: Reference | None) -> None:
        """Has an estimate made and sent."""
        self._estimates.want(lambda: estimate_message(scene, readings, choice, reference))

    def shape(self, scene: Scene, make: Callable[[Scene], str]) -> None:
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


def estimate_message(scene: Scene, readings: Readings | TactsimError, choice: Choice, reference: Reference | None) -> str:
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
