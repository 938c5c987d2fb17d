"""What the user of one page has chosen: whose forces, which sample, which estimator, and where in the recording the page is."""

from __future__ import annotations

import time
from typing import Any

from tactsim.array import Array, evenly_spaced
from tactsim.dataset.store.arrays import STATUS
from tactsim.errors import InputError, TactsimError, UnknownName
from tactsim.live.session.choices import STORED, Choice
from tactsim.live.session.commands import ChooseEstimator, ChooseSample, ChooseSource, Choosing, FilterSamples
from tactsim.live.session.content import LIVE, Content
from tactsim.live.session.estimating import frame_readings, shown_signal
from tactsim.live.sources.recorded import SOURCES
from tactsim.live.sources.samples import ANY, Samples
from tactsim.live.sources.scene import Frame, Recording

MOST_RANGED = 64
"""Steps of a recording from which the ends of the colour scales are taken beforehand."""

LONGEST_SHOWN = 40
"""Characters of an unknown name that a message shows."""
SHORTEST, LONGEST = 4.0, 20.0
"""Limits in s of the time that a recording takes to play; between them it plays in real time."""


class Selection:
    """Begins with the live feed if there is one, else with the first recording or the first sample that is done."""

    def __init__(self, content: Content):
        self._content = content
        self._filter = (ANY, ANY)
        self._recordings = content.recordings
        self._sample: int | None = None
        self._fault = ""
        self.choice: Choice = _first_choice(content)
        self.source = LIVE if content.feed is not None else next(iter(content.recordings), next(iter(SOURCES)))
        if content.samples is not None:
            self._open_sample(content.samples.near(0, 0, status="done"))

    @property
    def live(self) -> bool:
        """Whether the feed is shown."""
        return self.source == LIVE

    @property
    def recording(self) -> Recording | None:
        """What is shown if it is not the feed; None if there is nothing."""
        return self._recordings.get(self.source)

    def take(self, command: Choosing) -> bool:
        """Makes a choice; whether another scene may result.

        Raises
        ------
        InputError
            If there is no such thing to choose.
        """
        if isinstance(command, ChooseEstimator):
            self.choice = self._estimator(command.name)
            return False
        if isinstance(command, ChooseSource):
            if command.name not in self._names():
                raise UnknownName("source of forces", command.name[:LONGEST_SHOWN], self._names())
            self.source = command.name
        elif self._content.samples is None:
            raise InputError("there are no samples to choose from; open a data set")
        elif isinstance(command, FilterSamples):
            self._narrow(command.split, command.status)
        else:
            self._move(command, self._content.samples)
        return True

    def _estimator(self, name: str) -> Choice:
        known = self._content.by_name
        if name not in known:
            raise UnknownName("estimator", name[:LONGEST_SHOWN], known)
        return known[name]

    def _narrow(self, split: str, status: str) -> None:
        assert self._content.samples is not None
        number = self._content.samples.near(self._sample or 0, 0, split, status)
        self._filter = (split, status)
        self._open_sample(number)

    def _move(self, command: ChooseSample, samples: Samples) -> None:
        if command.move is not None:
            self._open_sample(samples.near(self._sample or 0, command.move, *self._filter))
            return
        if command.number is None or command.number >= samples.count:
            raise InputError(f"there is no sample {command.number}; allowed: 0 to {samples.count - 1}")
        self._open_sample(command.number)

    def _open_sample(self, number: int | None) -> None:
        assert self._content.samples is not None
        self._sample, self._recordings, self._fault = number, {}, ""
        if number is None:
            self._fault = "no sample has this split and status; choose others"
            return
        try:
            self._recordings = self._content.samples.recordings(number)
        except TactsimError as error:
            self._fault = str(error)
        if not self.live and self.source not in self._recordings:
            self.source = next(iter(self._recordings), self.source)

    def _names(self) -> list[str]:
        return ([LIVE] if self._content.feed is not None else []) + list(self._recordings)

    def offered(self) -> dict[str, Any]:
        """What can be chosen at all."""
        samples, reference = self._content.samples, self._content.reference
        return {
            "is": "offer",
            "estimators": [
                {"name": one.name, "label": one.label, "enabled": reference is not None or not one.needs_reference}
                for one in self._content.choices
            ],
            "samples": None if samples is None else {"count": samples.count, "splits": samples.splits, "status": STATUS},
            **self.state(),
        }

    def state(self) -> dict[str, Any]:
        """What is chosen now."""
        words = {LIVE: "live", **SOURCES}
        state: dict[str, Any] = {
            "sources": [{"name": name, "label": words[name]} for name in self._names()],
            "source": self.source,
            "estimator": self.choice.name,
            "sample": None,
            "selection_fault": "" if self.live else self._fault,
        }
        samples = self._content.samples
        if samples is not None:
            status_of = {} if self._sample is None else samples.status_of(self._sample)
            split, status = self._filter
            count = len(samples.chosen(*self._filter))
            state["sample"] = {"number": self._sample, "split": split, "status": status, "chosen": count, "state": status_of}
        return state

    def signals(self) -> list[tuple[Array, Array]]:
        """Signals that the views draw and forces, (jaw, row, column) in N, at some steps, for the ends of the colour scales."""
        recording, signals = self.recording, []
        count = 0 if recording is None else len(recording.times)
        for step in evenly_spaced(count, MOST_RANGED):
            assert recording is not None
            frame = recording.frame(int(step))
            try:
                readings = frame_readings(recording.scene, frame, self.choice, self._content.reference, self._content.noise)
            except TactsimError:
                continue
            signals.append((shown_signal(readings)[0], frame.forces))
        return signals


def _first_choice(content: Content) -> Choice:
    """The stored estimate, else the simplest estimator that takes off the reference, else the simplest one."""
    if content.reference is None or content.choices[0].name == STORED:
        return content.choices[0]
    return next((one for one in content.choices if one.needs_reference), content.choices[0])


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
