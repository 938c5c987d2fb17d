"""How a run ends before its end: the one place that turns a failed or interrupted path into a result."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from tactsim.errors import ConvergenceError
from tactsim.interfaces import Progress
from tactsim.results.result import Result, Status, StepRecord


class Record(Protocol):
    """What collects accepted steps."""

    def result(self, status: Status, reason: str) -> Result:
        """The result with everything that was accepted."""


def ended_early(record: Record, steps: Iterable[StepRecord], progress: Progress) -> Result | None:
    """Tells of every step as it is accepted; the result if the path fails or is interrupted, None at its end."""
    try:
        for step in steps:
            progress(step)
    except ConvergenceError as error:
        return record.result(Status.FAILED, f"stopped converging: {error}")
    except KeyboardInterrupt:
        return record.result(Status.INTERRUPTED, "interrupted; the accepted steps are kept, the run is incomplete")
    return None
