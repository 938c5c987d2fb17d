"""Slow work beside the frames, in threads that end with the process: estimates and shapes.

One of each at a time, and only the latest that is wanted; closing the page waits for none of them.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
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
from tactsim.live.sources.watch import Watch
from tactsim.outside.defect_place import unless_own
from tactsim.outside.text import one_line

Send = Callable[[str], Awaitable[None]]
PATIENCE = 0.3
"""Time in s after which the page says that an estimate is being computed."""
BEAT = 0.5
"""Time in s after which it says so anew, with how far it is."""
REST, LONGEST_REST = 0.1, 3.0
"""Time in s from an answer to the next one: words cannot be read faster, and what took long stands as long, up to the longest."""
NOTHING: dict[str, Any] = {"present": None, "words": [], "errors": [], "noise": "", "inclusions": []}
"""What the page shows where there is no estimate."""
Make = Callable[[Watch], str]
Waiting = Callable[[Watch, float], str]
Made = TypeVar("Made")
MOST_THREADS = 4
"""Estimates and shapes that are made at the same time, of all pages together."""


class Latest:
    """Does one thing at a time; what is wanted meanwhile replaces what was wanted before and not begun."""

    def __init__(self, send: Send, threads: Threads):
        self._send, self._threads = send, threads
        self._wanted: tuple[Make, Waiting | None] | None = None
        self._task: asyncio.Task[None] | None = None
        self._watch = Watch()

    def want(self, make: Make, waiting: Waiting | None = None) -> None:
        """Makes a message in a thread and sends it; meanwhile, after some patience, sends what ``waiting`` says."""
        self._wanted = make, waiting
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._work())

    def drop(self, *, cancelled: bool = False) -> None:
        """Sends no more of what is being made or wanted; ``cancelled`` also stops what a later one could use."""
        self._wanted, self._watch.dropped = None, True
        self._watch.cancelled = self._watch.cancelled or cancelled
        if self._task is not None:
            self._task.cancel()
            self._task = None

    async def _work(self) -> None:
        while self._wanted is not None:
            (make, waiting), self._wanted = self._wanted, None
            watch = self._watch = Watch()
            begun, patience = time.monotonic(), PATIENCE
            working = asyncio.ensure_future(self._threads.run(partial(message_or_fault, partial(make, watch))))
            try:
                while waiting is not None and not (await asyncio.wait([working], timeout=patience))[0]:
                    await self._send(waiting(watch, time.monotonic() - begun))
                    patience = BEAT
                await self._send(await working)
            finally:
                working.cancel()
            await asyncio.sleep(min(max(REST, time.monotonic() - begun), LONGEST_REST))


class Thinking:
    """Estimates and shapes of one page."""

    def __init__(self, send: Send, threads: Threads):
        self._estimates, self._shapes = Latest(send, threads), Latest(send, threads)

    def estimate(self, task: Task) -> None:
        """Has an estimate made and sent."""
        self._estimates.want(partial(_estimated_by, task), partial(busy_message, task.choice, task.moment))

    def shape(self, scene: PageScene, make: Callable[[PageScene], str]) -> None:
        """Has shapes made and sent."""
        self._shapes.want(lambda watch: make(scene))

    def drop_shapes(self) -> None:
        """Sends no more of the shapes that are being made: those of another scene would stand in the next one."""
        self._shapes.drop()

    def drop_estimate(self, *, cancelled: bool = False) -> None:
        """Sends no more of the estimate that is being made."""
        self._estimates.drop(cancelled=cancelled)

    def end(self) -> None:
        """Sends no more; the page has gone."""
        self._estimates.drop()
        self._shapes.drop()


@dataclass(frozen=True, eq=False)
class Task:
    """An estimate that is wanted: of which readings, by which estimator, and the moment of the readings as the page states it."""

    scene: PageScene
    readings: Readings | TactsimError
    choice: Choice
    reference: Reference | None
    moment: Mapping[str, Any]


def busy_message(choice: Choice, moment: Mapping[str, Any], watch: Watch | None = None, seconds: float = 0.0) -> str:
    """What the page says while an estimate is computed: by which estimator, of which moment, how far it is, and since when."""
    watch = watch or Watch()
    head = {"is": "estimate", "busy": True, "estimator": choice.name, "label": choice.label, "moment": moment}
    return plain_json(head | {"stage": watch.stage, "systems": watch.systems, "seconds": round(seconds, 1)})


def cancelled_message(choice: Choice, moment: Mapping[str, Any], words: str) -> str:
    """What the page says when there is no estimate and none is computed, and why."""
    head = {"is": "estimate", "busy": False, "estimator": choice.name, "label": choice.label, "moment": moment}
    return plain_json(head | NOTHING | {"fault": words, "cancelled": True})


def _estimated_by(task: Task, watch: Watch) -> str:
    return estimate_message(task.scene, task.readings, task.choice, task.reference, moment=task.moment, watch=watch)


def message_or_fault(make: Callable[[], str]) -> str:
    """The message that is made, or one that says what went wrong."""
    try:
        return make()
    except TactsimError as error:
        words = str(error)
    except Exception as error:  # noqa: BLE001  whatever goes wrong beside the frames, the page goes on and states it
        words = report(error)
    return plain_json({"is": "fault", "words": words})


def estimate_message(
    scene: PageScene,
    readings: Readings | TactsimError,
    choice: Choice,
    reference: Reference | None,
    *,
    moment: Mapping[str, Any] | None = None,
    watch: Watch | None = None,
) -> str:
    """The estimate as the page states it, or why there is none; by which estimator and of which moment."""
    stated, fault = NOTHING, str(readings) if isinstance(readings, TactsimError) else ""
    try:
        if not isinstance(readings, TactsimError):
            stated = estimated(scene, readings, choice, reference, watch)
    except TactsimError as error:
        fault = str(error)
    except Exception as error:  # noqa: BLE001  whatever an estimator does wrong, the page goes on and states it
        words = f"{type(error).__name__}: {one_line(error, 200)}"
        fault = f"internal error of the estimator ({words}); please report it{unless_own(error)}"
    head = {"is": "estimate", "busy": False, "estimator": choice.name, "label": choice.label, "moment": moment or {}}
    return plain_json(head | {"fault": fault, "cancelled": False} | stated)


class Threads:
    """Daemon threads that share the work; asyncio's own would hold up the end of the process until they are done."""

    def __init__(self) -> None:
        self._started = 0
        self._work: SimpleQueue[tuple[Future[Any], Callable[[], Any]] | None] = SimpleQueue()

    async def run(self, make: Callable[[], Made]) -> Made:
        """What ``make`` returns or raises; it is not begun if nobody waits any more."""
        answer: Future[Made] = Future()
        self._work.put((answer, make))
        if self._started < MOST_THREADS:
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
