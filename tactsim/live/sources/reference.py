"""The same grasp without a lump: what its taxels read at any closing, and the fast forward model of its tissue."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from tactsim.dataset.ranking.reference import PlainGrasp
from tactsim.deadline import stopped_by
from tactsim.errors import InputError, OutOfTime
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.source import SAME_CLOSING, jaw_notes, reference_notes, same_closing
from tactsim.live.sources.recorded import SOURCES, result_recordings
from tactsim.live.sources.scene import Frame, PageScene, Recording
from tactsim.live.sources.watch import Watch
from tactsim.localization.lump_response import LumpResponse
from tactsim.units import format_quantity

COMPUTING = "solving the plain tissue and its response to lumps, once for this reference; it takes a minute or two"
LOCK_PERIOD = 0.2
"""Time in s after which a thread that waits for the model of another one looks whether it is still wanted."""


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
        return self.any_recording.last.closing

    def response(self, watch: Watch | None = None) -> LumpResponse:
        """The fast forward model; computed once, which may take a minute or two, and kept.

        A thread that waits for another one's model gives up once it is dropped; the computation stops only if it is cancelled, as
        the next estimate needs it as well.

        Raises
        ------
        OutOfTime
            If the user has cancelled it.
        """
        watch = watch or Watch()
        watch.stage = COMPUTING
        while not self._lock.acquire(timeout=LOCK_PERIOD):
            if watch.dropped or watch.cancelled:
                raise OutOfTime("another estimate was wanted meanwhile")
        try:
            if self._response is None:
                with stopped_by(watch.asked_to_cancel):
                    self._response = stored_response(self.folder)
            return self._response
        finally:
            self._lock.release()


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

    def notes(self, scene: PageScene) -> tuple[str, ...]:
        """What the user must know about it beside what is shown; of a real sensor the jaws are not known."""
        jaws = jaw_notes(scene.grasp, self.scene.grasp) if scene.truth_known else ()
        return (*reference_notes(self.scene.inclusions or ()), *jaws)

    def response(self, closing: float | None, watch: Watch | None = None) -> LumpResponse:
        """The fast forward model of the tissue at a closing in m, by interpolation between those at the ends of the references.

        Between the ends of references the response over the force that plain tissue reads is interpolated; below the first end it
        stays. The response is an integral of stress, and stress rises as the force does: so scaled from a closing of 1 mm to one
        of 0.6 mm, that of ``cases/grasp_plain.yaml`` misses the computed one by 6 % (median over balls; 8 % at most for 99 in
        100), a sixth of the error of the forward model that the estimators state.

        Raises
        ------
        InputError
            If the jaws have closed by more than any reference.
        OutOfTime
            If the user has cancelled its computation.
        """
        ends = [result.closing for result in self.results]
        if closing is None or ends[-1] is None or same_closing(closing, ends[-1]):
            return self.results[-1].response(watch)
        known = np.array(ends, dtype=float)
        self._check_reach(closing, float(known[-1]))
        upper = int(np.searchsorted(known, closing))
        force = self._total_force(closing)
        parts = [(upper, 1.0)]
        if upper > 0:
            share = float((closing - known[upper - 1]) / (known[upper] - known[upper - 1]))
            parts = [(upper - 1, 1 - share), (upper, share)]
        tables = [(self.results[k].response(watch), force / self._total_force(float(known[k])) * share) for k, share in parts]
        first = tables[0][0]
        return LumpResponse(first.axes, first.radii, np.sum([share * table.values for table, share in tables], axis=0))

    def _total_force(self, closing: float) -> float:
        """Sum in N of what all taxels read on plain tissue at a closing in m."""
        end = self.results[-1].any_recording.last
        return float(np.nansum(self.frame_for(replace(end, time=None, closing=closing)).forces))

    def frame_for(self, frame: Frame) -> Frame:
        """Readings of the reference by the same means at the closing of a frame, by monotone interpolation over the closing.

        Raises
        ------
        InputError
            If the reference was not read through sensors but the frame was, or its closings do not reach that of the frame.
        """
        if any(frame.source not in result.recordings for result in self.results):
            raise InputError(
                f"the reference has no {SOURCES[frame.source]}: run it with the readout of this grasp, "
                f"or choose {next(iter(SOURCES.values()))}"
            )
        recordings = [result.recordings[frame.source] for result in self.results]
        if len(recordings) == 1 and (known := _known_frame(recordings[0], frame)) is not None:
            return known
        if len(recordings) == 1:
            closings, forces, valid = recordings[0].closings, recordings[0].forces, recordings[0].valid
        else:
            ends = [recording.last for recording in recordings]
            closings = np.array([result.closing for result in self.results], dtype=float)
            forces, valid = np.stack([end.forces for end in ends]), np.stack([end.valid for end in ends])
        assert closings is not None  # of one recording by _known_frame, of several since they were opened
        if frame.closing is None:
            raise InputError("the closing of these readings is not known; needed to choose between several references")
        self._check_reach(frame.closing, float(closings[-1]))
        if len(closings) < 2:
            raise InputError(
                f"the reference is known at a closing of {format_quantity(float(closings[0]), 'm')} only, here it is "
                f"{format_quantity(frame.closing, 'm')}; needed: a reference that closes in several steps "
                "(--set experiment.time.steps=12), or several results (more --reference FOLDER)"
            )
        if closings[0] > 0:
            closings, forces = np.append(0.0, closings), np.concatenate([np.zeros_like(forces[:1]), forces])
        end = self.results[-1].any_recording.last.readings(self.scene)
        plain = PlainGrasp(closings, np.where(np.isfinite(forces), forces, 0.0), end, self.scene.grasp)
        return Frame(plain.at(frame.closing), np.asarray(valid.all(axis=0)), frame.time, frame.closing, frame.source)

    def _check_reach(self, closing: float, most: float) -> None:
        if not 0 <= closing <= most * (1 + SAME_CLOSING):
            known = ", ".join("unknown" if one.closing is None else format_quantity(one.closing, "m") for one in self.results)
            raise InputError(
                f"the jaws have closed by {format_quantity(closing, 'm')}, those of the reference by {known}; "
                "needed: a reference that closes at least as far (another --reference FOLDER)"
            )


def _known_frame(recording: Recording, frame: Frame) -> Frame | None:
    """The recording at the time of a frame if it has the closing of the frame then; None if it is to be interpolated.

    A recording whose closing does not rise from step to step is compared at its end.
    """
    closing, last = frame.closing, recording.last
    if closing is None or recording.closings is None:
        return last
    if frame.time is not None:
        then = recording.at(frame.time)
        if then.closing is not None and same_closing(then.closing, closing):
            return then
    rising = recording.closings[0] >= 0 and bool((np.diff(recording.closings) > 0).all())
    same = last.closing is not None and same_closing(last.closing, closing)
    return last if same or not rising else None
