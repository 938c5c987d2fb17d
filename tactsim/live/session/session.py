"""One open page: what it has chosen, and the frames that are pushed to it, never more than it can draw."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Protocol, TypeVar

from tactsim.errors import TactsimError
from tactsim.live.defects import report
from tactsim.live.session.commands import Cancel, Choosing, Command, Drawn, EstimateNow, Pause, Play, Show, read_command
from tactsim.live.session.content import Content
from tactsim.live.session.estimating import frame_readings
from tactsim.live.session.messages import Scales, frame_message, plain_json, scene_message, shapes_message
from tactsim.live.session.selection import Playback, Selection
from tactsim.live.session.thinking import Task, Thinking, Threads, busy_message, cancelled_message
from tactsim.live.sources.scene import Frame, PageScene, Recording

Made = TypeVar("Made")
IN_FLIGHT = 2
"""Frames that are sent before the page says that it has drawn one: the rest is skipped, so that nothing piles up."""
PERIOD = 1 / 40
"""Time in s between two pushed frames of a recording that plays."""
FEED_PERIOD = 0.25
"""Time in s between two messages about the feed."""
MOST_WAITING = 2.0
"""Time in s after which a frame is sent even if the page has not said that it drew the last, as when it is in the background."""


class Socket(Protocol):
    """What a session needs of a web socket."""

    async def send_str(self, data: str) -> None:
        """Sends text."""

    async def send_bytes(self, data: bytes) -> None:
        """Sends bytes."""


class Session:
    """Commands come in by `receive`; `run` sends until it is cancelled."""

    def __init__(self, content: Content, socket: Socket, threads: Threads):
        self._content, self._socket = content, socket
        self._chosen = Selection(content)
        self._playback = Playback()
        self._changed, self._drawn = asyncio.Event(), asyncio.Event()
        self._in_flight = 0
        self._scales = Scales()
        self._scene: PageScene | None = None
        self._shown: Frame | None = None
        self._thinking = Thinking(self._send_text, threads)
        self._estimating, self._moment = True, dict[str, Any]()

    async def run(self) -> None:
        """Sends the scene and then frames, until it is cancelled or the page is gone."""
        feed = self._content.feed
        if feed is not None:
            feed.listen(self._changed)
        self._changed.set()
        feed_states = asyncio.create_task(self._send_feed_states())
        try:
            await self._send_text(plain_json(self._chosen.offered()))
            while True:
                await self._wait()
                await self._push_or_explain()
        finally:
            feed_states.cancel()
            self._thinking.end()
            if feed is not None:
                feed.forget(self._changed)

    async def _push_or_explain(self) -> None:
        """What there is to send, or why it cannot be sent; what is chosen next may be."""
        try:
            await self._push()
        except ConnectionError:
            raise
        except Exception as error:  # noqa: BLE001  whatever the data hold, the page goes on and states it
            self._playback.pause()
            words = str(error) if isinstance(error, TactsimError) else report(error)
            await self._send_fault(words)
            await self._send_text(cancelled_message(self._chosen.choice, {}, "there are no readings"))

    async def receive(self, text: str | bytes) -> None:
        """Takes a command of the page; one that cannot be used is answered by a fault."""
        try:
            command = read_command(text)
            self._do(command)
            if isinstance(command, Cancel):
                await self._send_text(cancelled_message(self._chosen.choice, self._moment, "cancelled"))
            elif isinstance(command, Show | EstimateNow | Choosing):
                await self._send_text(busy_message(self._chosen.choice, {}))
        except TactsimError as error:
            await self._send_fault(str(error))
        except Exception as error:  # noqa: BLE001  whatever a stored sample does, the page goes on and states it
            await self._send_fault(report(error))

    def _do(self, command: Command) -> None:
        recording = self._chosen.recording
        if isinstance(command, Drawn):
            self._in_flight = max(0, self._in_flight - 1)
            self._drawn.set()
            return
        if isinstance(command, Cancel):
            self._estimating = False
            self._thinking.drop_estimate(cancelled=True)
            return
        if isinstance(command, Show | EstimateNow | Choosing):
            self._estimating, self._shown = True, None
            self._thinking.drop_estimate()
        if isinstance(command, Play):
            if recording is not None:
                self._playback.play(recording)
        elif isinstance(command, Pause | Show):
            self._playback.pause()
            if recording is not None and isinstance(command, Show):
                self._playback.go_to(recording, command.step)
        elif not isinstance(command, EstimateNow):
            self._choose(command)
        self._changed.set()

    def _choose(self, command: Choosing) -> None:
        """Another estimator, other forces, another sample or another filter."""
        if self._chosen.take(command):
            self._playback.begin_anew(self._chosen.recording)
            self._scene = None
        self._scales = Scales()

    async def _wait(self) -> None:
        """Until there is something to send and room for it."""
        if self._playback.playing:
            await asyncio.sleep(PERIOD)
        else:
            await self._changed.wait()
        self._changed.clear()
        while self._in_flight >= IN_FLIGHT:
            self._drawn.clear()
            try:
                await asyncio.wait_for(self._drawn.wait(), MOST_WAITING)
            except TimeoutError:
                self._in_flight = 0

    async def _push(self) -> None:
        recording = self._chosen.recording
        if self._chosen.live:
            feed = self._content.feed
            assert feed is not None
            scene, frame = feed.scene, feed.frame
        else:
            scene, frame = (None, None) if recording is None else (recording.scene, self._playback.frame(recording))
        if scene is not None and scene is not self._scene:
            await self._introduce(scene, recording)
        if scene is None:
            self._thinking.drop_shapes()
            await self._send_text(plain_json({"is": "state"} | self._chosen.state()))
        elif frame is not None and (frame is not self._shown or not self._chosen.live or not self._scales.ends.any()):
            await self._send_frame(scene, frame, recording)

    async def _introduce(self, scene: PageScene, recording: Recording | None) -> None:
        self._scene, self._scales = scene, Scales()
        if not self._chosen.live and recording is not None:
            self._playback.begin_anew(recording)
        times = [] if self._chosen.live or recording is None else recording.times.tolist()
        reference = self._content.reference
        notes = [*scene.notes, *(() if reference is None else reference.notes(scene))]
        state = self._chosen.state() | {"times": times, "live": self._chosen.live, "notes": notes}
        self._thinking.drop_shapes()
        await self._send_text(scene_message(scene, **state))
        self._thinking.shape(scene, shapes_message)

    async def _send_frame(self, scene: PageScene, frame: Frame, recording: Recording | None) -> None:
        choice, content = self._chosen.choice, self._content
        if recording is not None and not self._chosen.live and not self._scales.ends.any():
            self._scales.take_range(self._chosen.signals())
        readings = readings_or_fault(lambda: frame_readings(scene, frame, choice, content.reference, content.noise))
        step = 0 if recording is None or frame.time is None else recording.step_at(frame.time)
        message = frame_message(scene, frame, readings, self._scales, step=step, playing=self._playback.playing)
        self._shown = frame
        self._in_flight += 1
        await self._socket.send_bytes(message)
        steps = 0 if recording is None or self._chosen.live else len(recording.times)
        self._moment = moment_of(frame, step, steps)
        if self._estimating:
            self._thinking.estimate(Task(scene, readings, choice, content.reference, self._moment))

    async def _send_feed_states(self) -> None:
        """How the feed is doing, when that has changed."""
        feed, before = self._content.feed, ""
        while feed is not None:
            message = plain_json({"is": "feed", **feed.state_now()})
            if message != before:
                await self._send_text(message)
                before = message
            await asyncio.sleep(FEED_PERIOD)

    async def _send_fault(self, words: str) -> None:
        await self._send_text(plain_json({"is": "fault", "words": words}))

    async def _send_text(self, text: str) -> None:
        with suppress(ConnectionError):
            await self._socket.send_str(text)


def moment_of(frame: Frame, step: int, steps: int) -> dict[str, Any]:
    """When a frame was read: step counted from 1 of how many, time in s, closing in mm; steps are 0 of a live feed."""
    closing = None if frame.closing is None or not math.isfinite(frame.closing) else 1e3 * frame.closing
    return {"step": step + 1, "steps": steps, "time": frame.time, "closing": closing}


def readings_or_fault(make: Callable[[], Made]) -> Made | TactsimError:
    """What is made, or why it cannot be."""
    try:
        return make()
    except TactsimError as error:
        return error
