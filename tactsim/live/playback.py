"""Where in a recording the page is, and how it moves on while it plays."""

from __future__ import annotations

import time

from tactsim.live.scene import Frame, Recording

SHORTEST, LONGEST = 4.0, 20.0
"""Limits in s of the time that a recording takes to play; between them it plays at its own speed."""


class Playback:
    """The time shown; ``playing`` moves it on by the clock, from the begin if it has come to the end."""

    def __init__(self) -> None:
        self.playing = False
        self._at: float | None = None
        self._speed = 1.0
        self._started = 0.0

    def begin_anew(self, recording: Recording | None) -> None:
        """Stands at the end of a recording, where the jaws have closed."""
        self.playing = False
        self._at = None if recording is None else float(recording.times[-1])

    def go_to(self, recording: Recording, step: int) -> None:
        """Stands at a step."""
        self._at = recording.frame(step).time

    def play(self, recording: Recording) -> None:
        """Moves on from here; a recording of one step stays."""
        first, last = float(recording.times[0]), float(recording.times[-1])
        if last <= first:
            return
        if self._at is None or self._at >= last:
            self._at = first
        length = last - first
        self._speed = length / min(max(length, SHORTEST), LONGEST)
        self._started, self.playing = time.monotonic(), True

    def pause(self) -> None:
        """Stays here."""
        self.playing = False

    def frame(self, recording: Recording) -> Frame:
        """The frame of now."""
        if self._at is None:
            self._at = float(recording.times[-1])
        if self.playing:
            now = time.monotonic()
            self._at += self._speed * (now - self._started)
            self._started = now
            if self._at >= recording.times[-1]:
                self._at, self.playing = float(recording.times[-1]), False
        return recording.at(self._at)
