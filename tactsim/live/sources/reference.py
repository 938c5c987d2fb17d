"""The same grasp without a lump: what its taxels read at any closing, and the fast forward model of its tissue."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from tactsim.dataset.ranking.reference import PlainGrasp
from tactsim.errors import InputError
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.source import SAME_CLOSING, reference_notes, stored_grasp
from tactsim.live.sources.recorded import SOURCES, result_recordings
from tactsim.live.sources.scene import Frame, PageScene, Recording
from tactsim.localization.lump_response import LumpResponse
from tactsim.units import format_quantity


@dataclass(eq=False)
class PlainResult:
    """The result of one plain grasp; its response is computed when it is first asked for."""

    folder: str
    recordings: dict[str, Recording]
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _response: LumpResponse | None = None

    @property
    def any_recording(self) -> Recording:
        """One of its recordings."""
        return next(iter(self.recordings.values()))

    @cached_property
    def closing(self) -> float | None:
        """Closing of each jaw at its end in m."""
        return self.any_recording.frame(len(self.any_recording.times) - 1).closing

    def response(self) -> LumpResponse:
        """The fast forward model; computed once, which may take half a minute, and kept."""
        with self._lock:
            if self._response is None:
                self._response = stored_response(self.folder)
            return self._response


@dataclass(frozen=True, eq=False)
class Reference:
    """One plain grasp, followed step by step, or several of different closings, between whose ends forces are interpolated."""

    results: tuple[PlainResult, ...]

    @classmethod
    def open(cls, folders: Sequence[str]) -> Reference:
        """The reference in some folders.

        Raises
        ------
        InputError
            If one is not the result of a grasp with taxels, or several do not close by different ways.
        StorageError
            If there is no result, or it is damaged.
        """
        for folder in folders:
            stored_grasp(folder)  # refuses what is no grasp
        results = [PlainResult(folder, result_recordings(folder)) for folder in folders]
        results.sort(key=lambda result: result.closing or 0.0)
        closings = np.array([result.closing or 0.0 for result in results])
        if len(results) > 1 and not (np.diff(closings, prepend=0.0) > 0).all():
            raise InputError("several references need different closings above 0; give one result for every closing")
        return cls(tuple(results))

    @property
    def scene(self) -> PageScene:
        """Block and matrices."""
        return self.results[-1].any_recording.scene

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user must know about it."""
        return reference_notes(self.scene.inclusions or ())

    def response(self, closing: float | None) -> LumpResponse:
        """The fast forward model of the tissue: that at the end of the reference, or of the one of several nearest in closing.

        Raises
        ------
        InputError
            If the jaws have closed by another way in m than one single reference at its end, for which the model holds.
        """
        if len(self.results) > 1 and closing is not None:
            return min(self.results, key=lambda result: abs((result.closing or 0.0) - closing)).response()
        last = self.results[-1].closing
        if closing is not None and last is not None and abs(closing - last) > SAME_CLOSING * abs(last):
            raise InputError(
                f"the model of the tissue holds for a closing of {format_quantity(last, 'm')}, where the reference ends; "
                f"here it is {format_quantity(closing, 'm')}: go to that step, or give a reference that ends here too"
            )
        return self.results[-1].response()

    def frame_for(self, frame: Frame) -> Frame:
        """What the reference reads, by the same means, at the closing of a frame.

        Raises
        ------
        InputError
            If the reference was not read through sensors but the frame was, or several do not reach its closing.
        """
        if any(frame.source not in result.recordings for result in self.results):
            raise InputError(
                f"the reference has no {SOURCES[frame.source]}: run it with the readout of this grasp, "
                f"or choose {next(iter(SOURCES.values()))}"
            )
        recordings = [result.recordings[frame.source] for result in self.results]
        if len(recordings) == 1:
            return _on_the_way(recordings[0], frame)
        ends = [recording.frame(len(recording.times) - 1) for recording in recordings]
        closings = np.array([result.closing for result in self.results], dtype=float)
        if frame.closing is None or not 0 <= frame.closing <= closings[-1] * (1 + SAME_CLOSING):
            known = ", ".join(format_quantity(float(closing), "m") for closing in closings)
            here = "not known" if frame.closing is None else format_quantity(frame.closing, "m")
            raise InputError(f"the closing is {here}, those of the references are {known}; needed: at most the largest")
        forces = np.stack([np.zeros_like(ends[0].forces), *(end.forces for end in ends)])
        between = PlainGrasp(np.append(0.0, closings), forces, ends[-1].readings(self.scene)).at(frame.closing)
        return Frame(between, np.logical_and.reduce([end.valid for end in ends]), frame.time, frame.closing, frame.source)


def _on_the_way(recording: Recording, frame: Frame) -> Frame:
    """The recording at the closing of a frame: at the same time, else anywhere on its way to its closing, else at its end."""
    closing, last = frame.closing, recording.frame(len(recording.times) - 1)
    if closing is None or recording.closings is None:
        return last
    if frame.time is not None:
        found = recording.at(frame.time)
        if found.closing is not None and abs(found.closing - closing) <= SAME_CLOSING * abs(closing):
            return found
    way = recording.closings
    rising = len(way) > 1 and bool((np.diff(way) > 0).all()) and way[0] <= closing <= way[-1]
    return recording.at(float(np.interp(closing, way, recording.times))) if rising else last
