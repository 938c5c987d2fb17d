"""How a run ends: at its end, by a failure, without memory or time, interrupted, or before it began."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Literal

import pytest

from tactsim.deadline import timed
from tactsim.errors import Collapsed, ConvergenceError, InputError, InvalidQuantity, OutOfMemory, OutOfTime, UnknownName
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import NO_MEMORY, Course, Findings, returned_by, run_within_another
from tactsim.registry import forget, kinds
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, Status, StepRecord, rows
from tactsim.units import Length


def raised(error: BaseException | None) -> None:
    if error is not None:
        raise error


@pytest.fixture
def made() -> Iterator[Callable[..., Experiment]]:
    """Makes an experiment of two steps that ends by an error after them, or before it begins."""

    class Scripted(Experiment):
        """Counts to two."""

        kind: Literal["scripted"] = "scripted"
        history_units: ClassVar[dict[str, str]] = {"count": "1"}
        after: ClassVar[BaseException | None] = None
        before: ClassVar[BaseException | None] = None
        status: ClassVar[Status] = Status.CONVERGED

        def begin(self) -> Course:
            raised(self.before)
            steps: list[StepRecord] = []
            return Course(self._counted(steps), lambda: self._findings(steps), "the counts are kept", setup_is_timed=True)

        def _counted(self, steps: list[StepRecord]) -> Iterator[StepRecord]:
            for record in rows(self.history_units, [[1.0, 2.0]]):
                steps.append(record)
                yield record
            raised(self.after)

        def _findings(self, steps: list[StepRecord]) -> Findings:
            count = {"count": Quantity(len(steps), "1", "steps")}
            return Findings("counted", steps, quantities=count, warnings=["w"], status=self.status, timing={"extra": 1.0})

        @classmethod
        def example(cls) -> Scripted:
            return cls()

    def make(
        after: BaseException | None = None, before: BaseException | None = None, status: Status = Status.CONVERGED
    ) -> Experiment:
        Scripted.after, Scripted.before, Scripted.status = after, before, status
        return Scripted()

    yield make
    forget(Scripted)


def test_a_run_to_its_end(made: Callable[..., Experiment]) -> None:
    seen: list[StepRecord] = []
    result = made().run(seen.append)
    assert (result.kind, result.status, result.reason) == ("scripted", Status.CONVERGED, "counted")
    assert list(result.steps) == seen
    assert [step.values["count"] for step in seen] == [1.0, 2.0]
    assert (result.units, result.warnings, result.assumptions, result.frames) == ({"count": "1"}, ("w",), (), ())
    assert list(result.timing) == ["extra", "setup", "total"]
    assert 0 <= result.timing["setup"] <= result.timing["total"]
    failed = made(status=Status.FAILED).run()
    assert (failed.status, failed.reason) == (Status.FAILED, "counted")


@pytest.mark.parametrize(
    ("error", "status", "reason"),
    [
        (ConvergenceError("no luck"), Status.FAILED, "stopped converging: no luck"),
        (Collapsed("flat"), Status.FAILED, "stopped converging: flat"),
        (OutOfTime("took longer than the 5 s that it was given"), Status.FAILED, "took longer than the 5 s that it was given"),
        (OutOfMemory("the memory does not suffice for a factor"), Status.FAILED, "the memory does not suffice for a factor"),
        (MemoryError(), Status.FAILED, NO_MEMORY),
        (KeyboardInterrupt(), Status.INTERRUPTED, "interrupted; the counts are kept"),
    ],
)
def test_what_was_accepted_before_an_early_end_is_kept(
    made: Callable[..., Experiment], error: BaseException, status: Status, reason: str
) -> None:
    result = made(after=error).run()
    assert (result.status, result.reason, len(result.steps)) == (status, reason, 2)
    assert result.quantities["count"].value == 2


@pytest.mark.parametrize("error", [None, OutOfTime("took longer than the 5 s that it was given"), KeyboardInterrupt()])
def test_doubts_are_warnings_of_every_result(
    made: Callable[..., Experiment], monkeypatch: pytest.MonkeyPatch, error: BaseException | None
) -> None:
    doubtful = made(after=error)
    monkeypatch.setattr(type(doubtful), "doubts", lambda self: ["a block of 4 km"])
    assert doubtful.run().warnings == ("a block of 4 km", "w")
    assert returned_by(run_within_another(made())).warnings == ("a block of 4 km", "w")


def test_a_single_text_is_one_doubt_below_what_a_case_is_refused_for(
    made: Callable[..., Experiment], monkeypatch: pytest.MonkeyPatch
) -> None:
    doubtful = made(before=InputError("no such mesh"))
    monkeypatch.setattr(type(doubtful), "doubts", lambda self: "a block of 4 km")
    with pytest.raises(InputError, match=r"^no such mesh\na block of 4 km$"):
        doubtful.run()
    monkeypatch.setattr(type(doubtful), "doubts", lambda self: [4.0])
    with pytest.raises(InputError, match=r"^doubts of Scripted: \[4\.0\]; needed: a tuple of texts"):
        doubtful.run()


def test_an_interruption_by_whoever_watches_keeps_the_step(made: Callable[..., Experiment]) -> None:
    def stop(step: StepRecord) -> None:
        raise KeyboardInterrupt

    result = made().run(stop)
    assert (result.status, len(result.steps)) == (Status.INTERRUPTED, 1)


@pytest.mark.parametrize(
    ("error", "seen"),
    [
        (InputError("no such file"), InputError),
        (OutOfTime("too late"), OutOfTime),
        (MemoryError(), OutOfMemory),
        (KeyboardInterrupt(), KeyboardInterrupt),
    ],
)
def test_a_run_that_cannot_begin_raises(made: Callable[..., Experiment], error: BaseException, seen: type[BaseException]) -> None:
    with pytest.raises(seen):
        made(before=error).run()


def test_other_errors_of_a_step_are_not_hidden(made: Callable[..., Experiment]) -> None:
    with pytest.raises(InputError, match="a wrong number"):
        made(after=InputError("a wrong number")).run()


def drained(experiment: Experiment) -> tuple[list[StepRecord], Result]:
    """Steps and result of an experiment within another."""
    results: list[Result] = []

    def outer() -> Iterator[StepRecord]:
        results.append((yield from run_within_another(experiment)))

    return list(outer()), results[0]


def test_an_experiment_within_another(made: Callable[..., Experiment]) -> None:
    steps, result = drained(made())
    assert len(steps) == 2
    assert result.quantities["count"].value == 2
    failed = returned_by(run_within_another(made(after=ConvergenceError("no luck"))))
    assert (failed.status, failed.reason, len(failed.steps)) == (Status.FAILED, "stopped converging: no luck", 2)
    assert returned_by(run_within_another(made(status=Status.FAILED))).status is Status.FAILED


@pytest.mark.parametrize(
    ("error", "seen"),
    [
        (KeyboardInterrupt(), KeyboardInterrupt),
        (OutOfTime("too late"), OutOfTime),
        (OutOfMemory("too large"), OutOfMemory),
        (MemoryError(), OutOfMemory),
    ],
)
def test_what_ends_an_experiment_within_another_from_outside_ends_both(
    made: Callable[..., Experiment], error: BaseException, seen: type[BaseException]
) -> None:
    with pytest.raises(seen):
        returned_by(run_within_another(made(after=error)))


def test_times_of_parts() -> None:
    timing: dict[str, float] = {}
    with timed(timing, "part"):
        pass
    with pytest.raises(ValueError, match="lost"), timed(timing, "other"):
        raise ValueError("lost")
    assert list(timing) == ["part"]


def test_a_quantity_that_a_run_did_not_get_to_is_not_called_a_slip_alone(made: Callable[..., Experiment]) -> None:
    with pytest.raises(UnknownName, match=r"unknown quantity 'threshold'; known: count"):
        made().run(None)["threshold"]
    with pytest.raises(UnknownName, match=r"unknown quantity of this failed run 'threshold'; known: count"):
        made(after=ConvergenceError("no way on")).run(None)["threshold"]


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ({"displacement": "mm", "force": "parrot"}, "Weighed.history_units: force: 'parrot' is no unit that is known"),
        (["N"], "Weighed.history_units is a list; needed: a unit by each name"),
    ],
)
def test_units_of_a_history_that_are_none_are_refused_as_the_class_is_defined(units: Any, words: str) -> None:
    with pytest.raises(InvalidQuantity, match=re.escape(words)):

        class Weighed(Experiment):
            """Its force has no unit."""

            kind: Literal["weighed"] = "weighed"
            history_units: ClassVar[Any] = units

            def begin(self) -> Course:
                return Course.computed(Findings("weighed"))

            @classmethod
            def example(cls) -> Weighed:
                return cls()

    assert "weighed" not in kinds(Experiment)


def test_a_default_that_is_text_where_a_number_belongs_is_refused_as_the_class_is_defined() -> None:
    words = "Sized.size: the default '3 mm' is text; needed: a number in SI"
    with pytest.raises(InvalidQuantity, match=words):

        class Sized(Experiment):
            """A length that nothing reads."""

            kind: Literal["sized"] = "sized"
            size: Length = "3 mm"

            def begin(self) -> Course:
                return Course.computed(Findings("sized"))

            @classmethod
            def example(cls) -> Sized:
                return cls()

    assert "sized" not in kinds(Experiment)
