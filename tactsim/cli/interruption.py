"""Stopping a run: the first signal ends the computation in good order, the second ends the process."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from tactsim.errors import INTERRUPTED

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Interruption:
    """Whether a stop was asked for, and whether it must wait."""

    def __init__(self) -> None:
        self.requested = False
        self._deferred = False

    @contextmanager
    def deferred(self) -> Iterator[None]:
        """A block that the first signal does not break, such as writing what was computed."""
        self._deferred = True
        try:
            yield
        finally:
            self._deferred = False

    def receive(self, number: int, frame: FrameType | None) -> None:
        """Handles a signal.

        Raises
        ------
        KeyboardInterrupt
            At the first signal, unless it is deferred.
        """
        if self.requested:
            os._exit(INTERRUPTED)
        self.requested = True
        if not self._deferred:
            raise KeyboardInterrupt


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Turns SIGINT, SIGTERM and SIGHUP into one KeyboardInterrupt, and a second of them into the end of the process.

    Raises
    ------
    KeyboardInterrupt
        If the block around this one was stopped already and goes on: a library swallowed its KeyboardInterrupt, as some do while
        they are imported.
    """
    interruption = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield interruption
        return
    ignored = (signal.SIG_IGN, None)  # the caller asked to ignore the signal, as ``nohup`` does
    heeded = [number for number in SIGNALS if signal.getsignal(number) not in ignored]
    around = [getattr(signal.getsignal(number), "__self__", None) for number in heeded]
    if any(isinstance(one, Interruption) and one.requested for one in around):
        raise KeyboardInterrupt
    earlier = {number: signal.signal(number, interruption.receive) for number in heeded}
    try:
        yield interruption
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)
