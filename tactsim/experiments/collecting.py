"""How a run ends before its end: the one place that turns a failed or interrupted path into a result."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from tactsim.deadline import check_time, time_limit
from tactsim.errors import Collapsed, ConvergenceError, OutOfMemory, Unfinished
from tactsim.interfaces import Experiment, Progress
from tactsim.results.result import Result, Status, StepRecord

NO_MEMORY = "the memory does not suffice: take larger elements, fewer taxels, steps or samples, or a machine with more of it"


class Record(Protocol):
    """What collects accepted steps."""

    def result(self, status: Status, reason: str) -> Result:
        """The result with everything that was accepted."""


def run_within(seconds: float | None, experiment: Experiment, progress: Progress) -> Result:
    """The result of an experiment that may take so many seconds; None means no limit.

    Raises
    ------
    OutOfTime
        If it took longer and had no steps to keep.
    OutOfMemory
        If the memory did not suffice and it had no steps to keep.
    """

    def heeding(step: StepRecord) -> None:
        progress(step)
        check_time()

    try:
        with time_limit(seconds):
            return experiment.run(heeding)
    except MemoryError as error:
        raise OutOfMemory(NO_MEMORY) from error


def ended_early(record: Record, steps: Iterable[StepRecord], progress: Progress) -> Result | None:
    """Tells of every step as it is accepted; the result if the path fails or is interrupted, None at its end."""
    try:
        for step in steps:
            progress(step)
    except Unfinished as error:
        return record.result(Status.FAILED, failure(error))
    except MemoryError:
        return record.result(Status.FAILED, NO_MEMORY)
    except KeyboardInterrupt:
        return record.result(Status.INTERRUPTED, "interrupted; the accepted steps are kept, the run is incomplete")
    return None


def failure(error: Unfinished) -> str:
    """The reason of a run that ended before its end."""
    return f"stopped converging: {error}" if isinstance(error, ConvergenceError | Collapsed) else str(error)
