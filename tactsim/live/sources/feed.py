"""The state of a live feed: the latest description and frame, and what could not be read."""

from __future__ import annotations

import asyncio
import math
import time
from collections import Counter
from typing import Any

from tactsim.errors import InputError
from tactsim.live.sources.frame_lines import LineSplitter, read_line
from tactsim.live.sources.scene import Frame, PageScene
from tactsim.outside.text import one_line

STANDS = 3.0
"""Time in s without a frame after which the picture is no longer that of now."""
RECENT = 10.0
"""Time in s for which the page shows a line that could not be read; it stays counted."""


class Feed:
    """Takes bytes, keeps the latest frame, and wakes those who wait; nothing else of the past is kept."""

    def __init__(self, name: str):
        self.name = name
        self.scene: PageScene | None = None
        self.frame: Frame | None = None
        self.state = "waiting"
        self._count: Counter[str] = Counter()
        self._fault = ""
        self._ended = False
        self._last_frame, self._last_fault = -math.inf, -math.inf
        self._listeners: set[asyncio.Event] = set()

    def listen(self, event: asyncio.Event) -> None:
        """Sets an event whenever something is new."""
        self._listeners.add(event)

    def forget(self, event: asyncio.Event) -> None:
        """Ends `listen`."""
        self._listeners.discard(event)

    def stream(self, *, trusted: bool = True) -> FeedStream:
        """A new stream of bytes into the feed, whose lines count from 1; see `FeedStream`."""
        return FeedStream(self, trusted)

    def take(self, line: bytes | None, number: int) -> bool:
        """Takes a line, None for one that was too long; whether it could be read."""
        try:
            content = read_line(line, self.scene)
        except InputError as error:
            self.blame(f"line {number}: {error}")
            return False
        if isinstance(content, PageScene):
            self.scene, self.frame = content, None
        else:
            self.frame = content
            self._count["frame"] += 1
        self.state, self._ended, self._last_frame = "running", False, time.monotonic()
        self._wake()
        return True

    def blame(self, fault: str) -> None:
        """Counts something that could not be read."""
        self._count["malformed"] += 1
        self._fault, self._last_fault = one_line(fault), time.monotonic()
        self._wake()

    def end(self, state: str) -> None:
        """Notes that nothing comes any more, or for now, and why."""
        self.state, self._ended = state, True
        self._wake()

    def state_now(self) -> dict[str, Any]:
        """What the page says of it; ``over`` if the picture is not of now, a fault only for some seconds after it came."""
        silent = time.monotonic() - self._last_frame
        still = self.state == "running" and silent > STANDS
        return {
            "name": self.name,
            "state": f"no frame for {int(silent)} s" if still else self.state,
            "frames": self._count["frame"],
            "malformed": self._count["malformed"],
            "fault": self._fault,
            "over": still or self._ended,
            "recent": time.monotonic() - self._last_fault < RECENT,
        }

    def _wake(self) -> None:
        for event in self._listeners:
            event.set()


class FeedStream:
    """One file, pipe or connection.

    One that is not ``trusted`` is ``refused`` from its first line on if that cannot be read: so a web page elsewhere that makes
    the browser post something to the socket gets nothing in, as HTTP begins with a line of its own.
    """

    def __init__(self, feed: Feed, trusted: bool):
        self._feed, self._splitter, self._trusted = feed, LineSplitter(), trusted
        self._number = 0
        self.refused = False

    def take(self, chunk: bytes) -> None:
        """Takes bytes as they come."""
        for line in self._splitter.lines(chunk):
            self._number += 1
            read = self._feed.take(line, self._number)
            if not (read or self._trusted) and self._number == 1:
                self.refused = True
                return
