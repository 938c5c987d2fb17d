"""The state of a live feed: the latest description and frame, and what could not be read."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import dataclass

from tactsim.errors import InputError
from tactsim.live.sources.frame_lines import LONGEST_LINE, LineSplitter, read_line
from tactsim.live.sources.scene import Frame, PageScene
from tactsim.outside.text import one_line


@dataclass(frozen=True)
class FeedCounts:
    """How much came in, and the last fault in words."""

    frames: int = 0
    malformed: int = 0
    fault: str = ""


class Feed:
    """Takes bytes, keeps the latest frame, and wakes those who wait; nothing else of the past is kept."""

    def __init__(self, name: str):
        self.name = name
        self.scene: PageScene | None = None
        self.frame: Frame | None = None
        self.state = "waiting"
        self._count: Counter[str] = Counter()
        self._fault = ""
        self._listeners: set[asyncio.Event] = set()

    @property
    def counts(self) -> FeedCounts:
        """So far."""
        return FeedCounts(self._count["frame"], self._count["malformed"], self._fault)

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
            if line is None:
                raise InputError(f"longer than {LONGEST_LINE} bytes")
            found = read_line(line, self.scene)
        except InputError as error:
            self.blame(f"line {number}: {error}")
            return False
        if isinstance(found, PageScene):
            self.scene, self.frame = found, None
        else:
            self.frame = found
            self._count["frame"] += 1
        self.state = "running"
        self._wake()
        return True

    def blame(self, fault: str) -> None:
        """Counts something that could not be read."""
        self._count["malformed"] += 1
        self._fault = one_line(fault)
        self._wake()

    def tell(self, state: str) -> None:
        """Says how the source is: waiting, running, ended."""
        self.state = state
        self._wake()

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
