"""How a run goes and ends: the one place that times it, limits it, and turns whatever ends it into a result.

A kind of experiment gives a `Course`: steps that compute, one record for each that is accepted, and findings that are asked
for once the steps have ended, for whatever reason.
"""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Self, TypeVar, cast, final

from tactsim.deadline import allowed_seconds, check_time, time_limit
from tactsim.errors import Collapsed, ConvergenceError, InputError, OutOfMemory, OutOfTime, Unfinished, shown
from tactsim.interfaces.doubts import doubts_beside, doubts_of
from tactsim.interfaces.history_units import KindWithHistory
from tactsim.interfaces.seeds import seeds_in
from tactsim.interfaces.variation import Variation, check_places
from tactsim.presenter import presenter
from tactsim.progress import COMPILATION, Extent, quiet, step_bar
from tactsim.results.checked import checked_texts, without_number
from tactsim.results.quantity import Quantity
from tactsim.results.result import FieldFrame, Result, Status, StepRecord
from tactsim.results.scene import Scene

Progress = Callable[[StepRecord], None]
Made = TypeVar("Made")

NO_MEMORY = "the memory does not suffice: take larger elements, fewer taxels, steps or samples, or a machine with more of it"
ACCEPTED_STEPS = "the accepted steps are kept, the run is incomplete"


@dataclass(frozen=True)
class Findings:
    """What a run computed, complete or not; fields as those of `Result`."""

    reason: str
    """Why a run that came to its end is what ``status`` says; not used if it ended before."""
    steps: Iterable[StepRecord] = ()
    """The history: one record for each row."""
    quantities: dict[str, Quantity] = field(default_factory=dict)
    assumptions: Iterable[str] = ()
    warnings: Iterable[str] = ()
    frames: Iterable[FieldFrame] = ()
    scene: Scene | None = None
    status: Status = Status.CONVERGED
    """Of a run that came to its end: converged, or failed at what it was for, such as a threshold that was not reached."""
    timing: Mapping[str, float] = field(default_factory=dict)
    """Times in s beside those that every run has."""
    units: Mapping[str, str] | None = None
    """Units of the history's values where they are not the ``history_units`` of the kind."""

    def ended(self, status: Status, reason: str) -> Self:
        """The same of a run that ended otherwise."""
        return replace(self, status=status, reason=reason)


@dataclass(frozen=True)
class Course:
    """A run that has begun.

    Parameters
    ----------
    steps : computes; yields the record of every step that is accepted, and raises `Unfinished` if there is no way on
    findings : gives what was accepted until now; called once, after the steps have ended for whatever reason
    kept : what an interruption leaves, in words
    setup_is_timed : whether the time that `Experiment.begin` took is reported beside the total
    advice : what stands behind the reason of a run without a way on: what leads on, or takes less time
    """

    steps: Iterable[StepRecord]
    findings: Callable[[], Findings]
    kept: str = ACCEPTED_STEPS
    setup_is_timed: bool = False
    advice: Callable[[Unfinished], str] = field(default=lambda error: "")

    @classmethod
    def computed(cls, findings: Findings) -> Self:
        """The course of a kind that computes everything at once."""
        return cls(findings.steps, lambda: findings)


class Runnable(KindWithHistory):
    """What can be run: what is the same for every kind of `Experiment`."""

    @property
    def extent(self) -> Extent | None:
        """How far a run goes; None if the end is not known beforehand."""
        return None

    def doubts(self) -> list[str]:
        """What looks wrong in the case, such as a unit: shown on a terminal before the run, and a warning of every result."""
        return []

    def _repr_html_(self) -> str:
        return str(presenter().case_html(self))

    @classmethod
    def starting_case(cls) -> Self:
        """What ``tactsim new`` writes to begin with: the example, if its mesh is one that a user wants."""
        return cls.example()

    def vary(self, places: Mapping[str, Any]) -> Variation:
        """The experiment with distributions at some places: ``{"thickness": tactsim.uniform("2 mm", "6 mm")}``.

        A place is a key path as in a case file; entries of a list have their numbers: ``"inclusions.0.shape.center.2"``.

        Raises
        ------
        CaseError
            If it has no such place, one of another dimension, or the places are no mapping from key paths.
        """
        check_places(self, places)
        return Variation(self, dict(places))

    def seeds(self) -> dict[str, int]:
        """Every seed of random numbers by its key path, such as ``readout.seed``; empty if nothing is random."""
        return dict(seeds_in(self))

    @abstractmethod
    def begin(self) -> Course:
        """What computes the steps and collects their results; what is made before the first step, such as a mesh, is made here.

        ::

            class Squeeze(Experiment):
                kind: Literal["squeeze"] = "squeeze"
                closings: tuple[Length, ...]
                history_units: ClassVar[dict[str, str]] = {"closing": "m", "force": "N"}

                def begin(self) -> Course:
                    record = SqueezeRecord(self)
                    return Course((record.accept(closing) for closing in self.closings), record.findings)

        ``accept`` computes a step and returns its `StepRecord`; ``findings`` returns the `Findings` of all accepted steps.

        Raises
        ------
        InputError
            If something that the experiment names, such as a file, cannot be used.
        Unfinished
            If it cannot begin: there is nothing to keep yet.
        """

    def unloaded(self) -> Findings:
        """The body and what will press on it, before the first step: their frame and scene.

        Raises
        ------
        InputError
            If the kind has no body with a mesh, or something that the experiment names cannot be used.
        """
        raise InputError(f"{self.kind}: nothing to show at rest; indentations, grasps and boundary value problems have a mesh")

    @final
    def at_rest(self) -> Result:
        """What would be computed, as the result of a run that ended before its first step; its figure is a sketch of it.

        Raises
        ------
        InputError
            As `unloaded`.
        """
        with doubts_beside(self):
            return _result(self, self.unloaded().ended(Status.INTERRUPTED, "at rest; nothing is computed"), {})

    @final
    def run(self, progress: Progress | Literal["bar"] | None = "bar", *, time_limit: float | str | None = None) -> Result:
        """Run to the end, calling ``progress`` after each accepted step; by default a bar on a terminal and in a notebook.

        A run that does not converge, lacks memory, takes longer than ``time_limit`` (s, or text such as "5 min"; None: as long as
        it needs) or is interrupted returns a result with that status, the reason, and what was accepted.

        Raises
        ------
        InputError
            If something that the experiment names, such as a file, cannot be used.
        Unfinished
            If it ended before its first step was begun: there is nothing to keep.
        """
        seconds = allowed_seconds(time_limit)
        if progress is not None and progress != "bar" and not callable(progress):
            raise InputError(f"progress is {shown(progress)}; needed: a function of a step, 'bar', or None")
        if progress != "bar":
            with quiet(progress is None):
                return run_experiment(self, progress, seconds)
        with step_bar(self.kind.replace("_", " "), self.extent) as bar:
            return run_experiment(self, bar, seconds)


def run_experiment(experiment: Runnable, progress: Progress | None, seconds: float | None) -> Result:
    """The result that `Runnable.run` returns.

    Raises
    ------
    InputError, Unfinished
        As `Runnable.begin`.
    OutOfMemory
        If the memory does not suffice to begin, or to report what was computed.
    """
    started = time.perf_counter()
    COMPILATION.of_another_run()
    try:
        with time_limit(seconds), doubts_beside(experiment):
            course = _course(experiment)
            setup = time.perf_counter() - started
            early = _ended_early(course, progress)
        findings = course.findings() if early is None else course.findings().ended(*early)
    except MemoryError as error:
        raise OutOfMemory(NO_MEMORY) from error
    timing = dict(findings.timing) | ({"setup": setup} if course.setup_is_timed else {})
    return _result(experiment, findings, timing | {"total": time.perf_counter() - started})


def _course(experiment: Runnable) -> Course:
    course: Any = experiment.begin()
    if isinstance(course, Course):
        return course
    raise InputError(f"begin() of {type(experiment).__name__} returned a {type(course).__name__}; needed: a Course")


def _ended_early(course: Course, progress: Progress | None) -> tuple[Status, str] | None:
    """Reports every step as it is accepted; status and reason if the steps fail or are interrupted, None at their end."""
    try:
        for step in course.steps:
            if progress is not None:
                progress(step)
            check_time()
    except Unfinished as error:
        return Status.FAILED, failure(error) + course.advice(error)
    except MemoryError:
        return Status.FAILED, NO_MEMORY
    except KeyboardInterrupt:
        return Status.INTERRUPTED, f"interrupted; {course.kept}"
    return None


def failure(error: Unfinished) -> str:
    """The reason of a run that ended before its end."""
    return f"stopped converging: {error}" if isinstance(error, ConvergenceError | Collapsed) else str(error)


def _result(experiment: Runnable, findings: Findings, timing: Mapping[str, float]) -> Result:
    if findings.status is Status.CONVERGED and (lost := without_number(findings.quantities)):
        findings = findings.ended(Status.FAILED, f"not finite: {', '.join(lost)}; needed: numbers, or None where there is none")
    name = type(experiment).__name__
    return Result(
        kind=experiment.kind,
        status=findings.status,
        reason=findings.reason,
        quantities=findings.quantities,
        assumptions=checked_texts(findings.assumptions, f"assumptions of {name}"),
        warnings=(
            *doubts_of(experiment),
            *checked_texts(findings.warnings, f"warnings of {name}"),
        ),
        timing=dict(timing),
        steps=tuple(findings.steps),
        units=dict(experiment.history_units if findings.units is None else findings.units),
        frames=tuple(findings.frames),
        scene=findings.scene,
        experiment=experiment,
    )


def run_within_another(experiment: Runnable) -> Generator[StepRecord, None, Result]:
    """Yields the steps of an experiment that is part of another and returns its result, converged or failed.

    An interruption, and the end of the time allowed or of the memory, are no failures of the part: they end the other one too.

    Raises
    ------
    OutOfTime, OutOfMemory
        If the time allowed has passed, or the memory does not suffice.
    """
    try:
        course = _course(experiment)
        try:
            yield from course.steps
        except (OutOfTime, OutOfMemory):
            raise
        except Unfinished as error:
            return _result(experiment, course.findings().ended(Status.FAILED, failure(error)), {})
        return _result(experiment, course.findings(), {})
    except MemoryError as error:
        raise OutOfMemory(NO_MEMORY) from error


def returned_by(steps: Generator[StepRecord, None, Made]) -> Made:
    """What steps return at their end, such as those of `run_within_another`; they are reported to nobody."""
    with quiet():
        while True:
            try:
                next(steps)
            except StopIteration as end:
                return cast(Made, end.value)
