"""An experiment within another, and how it may end."""

from __future__ import annotations

import pytest

from tactsim.errors import ConvergenceError, OutOfTime
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.results import Status, StepRecord

TOO_LONG = "took longer than the 5 s that it was given"
ENDS = {
    "failure": (ConvergenceError("no luck"), Status.FAILED, "stopped converging: no luck"),
    "interruption": (KeyboardInterrupt(), Status.INTERRUPTED, "interrupted; "),
    "time": (OutOfTime(TOO_LONG), Status.FAILED, TOO_LONG),
}
"""What ends a part, and the status and the reason of the whole: a reason of the part's own stands behind its name."""
every_end = pytest.mark.parametrize(("error", "status", "reason"), ENDS.values(), ids=ENDS)


def pretend_to_end(monkeypatch: pytest.MonkeyPatch, kind: type[Experiment], error: BaseException) -> None:
    """Let experiments of a kind accept one step and end by an error."""

    def steps():
        yield StepRecord(1, 3, 0.0, {"displacement": 1e-4})
        raise error

    monkeypatch.setattr(kind, "begin", lambda self: Course(steps(), lambda: Findings("its end was not reached")))
