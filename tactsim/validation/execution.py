"""Runs the simulations of studies in processes of one thread each; what was computed before is taken from a cache."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import monotonic

from tactsim.case import load_case
from tactsim.code_identity import code_identity
from tactsim.errors import ConvergenceError, OutOfMemory, StorageError, TactsimError
from tactsim.outside.files import opened
from tactsim.outside.processes import BROKEN, serve
from tactsim.outside.text import counted
from tactsim.outside.worker_pool import Answer, WorkerPool
from tactsim.results.scene import Scene
from tactsim.storage.files import replace_file
from tactsim.units import rough_time
from tactsim.user_cache import user_cache
from tactsim.validation.solver_identity import solver_identity
from tactsim.validation.study import RunOutcome, Study

MODULE = "tactsim.validation.execution"
Studies = dict[str, tuple[RunOutcome, ...]]
"""Outcomes of the studies of a table by name."""
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Task:
    """A simulation to run: its name, the path of its case file, and the overrides."""

    name: str
    path: str
    overrides: tuple[str, ...]


@dataclass(frozen=True)
class StudyRunner:
    """How studies are run."""

    workers: int = 2
    fresh: bool = False
    """Whether earlier results are ignored."""
    cache: Path | None = None
    """Where results are kept; by default the user's cache folder."""
    computed: set[str] = field(default_factory=set, compare=False)
    """Cases that were computed until now, by their id."""
    from_cache: set[str] = field(default_factory=set, compare=False)
    """Cases whose outcomes an earlier validation left."""

    def outcomes(self, tables: Mapping[str, Sequence[Study]], folder: Path, progress: Progress) -> Iterator[tuple[str, Studies]]:
        """Each table, as soon as it is complete, with the outcome of every run of its studies; equal cases are run once.

        Raises
        ------
        CaseError
            If a case of a study is refused.
        StorageError
            If the file of a case cannot be read.
        ConvergenceError
            If a process died.
        TactsimError
            If a process met a defect of this program.
        """
        tasks = {
            (table, study.name, run.id): Task(f"{study.name}, {run.id}", str(folder / study.case), study.overrides(run))
            for table, studies in tables.items()
            for study in studies
            for run in study.runs
        }
        identities = {key: load_case(task.path, task.overrides).case_id for key, task in tasks.items()}
        outcomes: dict[str, RunOutcome] = {}
        if not self.fresh:
            stored = {case_id: self._stored(case_id) for case_id in set(identities.values())}
            outcomes = {case_id: outcome for case_id, outcome in stored.items() if outcome is not None}
            self.from_cache.update(outcomes.keys() - self.computed)
        pending = dict(tables)

        def complete() -> Iterator[tuple[str, Studies]]:
            for table in [name for name in pending if all(identities[key] in outcomes for key in tasks if key[0] == name)]:
                named = {key: outcomes[identities[key]].model_copy(update={"id": key[-1]}) for key in tasks if key[0] == table}
                studies = pending.pop(table)
                yield table, {study.name: tuple(named[table, study.name, run.id] for run in study.runs) for study in studies}

        yield from complete()
        waiting = {identities[key]: task for key, task in reversed(tasks.items()) if identities[key] not in outcomes}
        for case_id, outcome in self._computed(dict(reversed(waiting.items())), progress):
            outcomes[case_id] = outcome
            self.computed.add(case_id)
            self._store(outcome)
            yield from complete()

    def _computed(self, waiting: dict[str, Task], progress: Progress) -> Iterator[tuple[str, RunOutcome]]:
        if not waiting:
            return
        progress(f"{counted(len(waiting), 'simulation')} in {counted(min(self.workers, len(waiting)), 'process', 'processes')}")
        with closing(WorkerPool[str](MODULE, (), self.workers)) as pool:
            for case_id, task in waiting.items():
                pool.submit(case_id, json.dumps(asdict(task)).encode())
            count, begun = 0, monotonic()
            while count < len(waiting):
                for answer in pool.wait():
                    count, outcome = count + 1, _outcome_of(answer)
                    ended = f"{outcome.id}: {outcome.status}, {outcome.seconds:.0f} s"
                    left = rough_time((monotonic() - begun) / count * (len(waiting) - count))
                    progress(f"{count}/{len(waiting)}  {ended}" + (f"; about {left} left" if count < len(waiting) else ""))
                    yield answer.key, outcome

    def _place(self, case_id: str) -> Path:
        return (self.cache or user_cache("validation")) / f"{case_id}-{code_identity()}-{solver_identity()}.json"

    def _stored(self, case_id: str) -> RunOutcome | None:
        """The outcome that the cache holds, None if it holds none that can be read."""
        with suppress(StorageError, ValueError):
            return RunOutcome.model_validate_json(opened(self._place(case_id), "result").text())
        return None

    def _store(self, outcome: RunOutcome) -> None:
        """Keeps an outcome; a cache that cannot be written costs only time, and an interrupted run is no outcome."""
        if outcome.status == "interrupted":
            return
        with suppress(OSError):
            place = self._place(outcome.case_id)
            place.parent.mkdir(parents=True, exist_ok=True)
            replace_file(place, outcome.model_dump_json().encode())


def _outcome_of(answer: Answer[str]) -> RunOutcome:
    """What a process computed.

    Raises
    ------
    ConvergenceError
        If it died.
    TactsimError
        If it met a defect of this program.
    """
    if answer.content is None:
        message = f"a process of the simulations ended ({answer.ending}); is there enough memory? take fewer workers"
        raise ConvergenceError(message)
    if answer.content.startswith(BROKEN):
        raise TactsimError(f"a simulation failed: {answer.content[len(BROKEN) :].decode(errors='replace')}")
    return RunOutcome.model_validate_json(answer.content)


def simulated(task: Task) -> RunOutcome:
    """Runs one case to its end; a refusal on the way is an outcome that failed.

    Raises
    ------
    CaseError
        If the case is refused.
    StorageError
        If its file cannot be read.
    """
    case = load_case(task.path, task.overrides)
    try:
        result = case.experiment.run(None)
    except TactsimError as error:
        status = "interrupted" if isinstance(error, StorageError | OutOfMemory) else "failed"  # by the machine, or by itself
        return RunOutcome(
            id=task.name, case_id=case.case_id, status=status, reason=str(error), quantities={}, history={}, seconds=0.0
        )
    scalars = {key: quantity.value for key, quantity in result.quantities.items() if isinstance(quantity.value, int | float)}
    return RunOutcome(
        id=task.name,
        case_id=case.case_id,
        status=str(result.status),
        reason=result.reason,
        quantities={key: float(value) for key, value in scalars.items() if math.isfinite(value)},
        history={key: tuple(step.values[key] for step in result.steps) for key in result.units if _recorded(result.steps, key)},
        disc_share=result.scene.disc_share if isinstance(result.scene, Scene) else 1.0,
        seconds=result.timing["total"],
    )


def _recorded(steps: Sequence, key: str) -> bool:
    return bool(steps) and all(key in step.values for step in steps)


def main(descriptor: str) -> None:
    """The life of a process: cases in, outcomes out."""
    serve(descriptor, _outcome)


def _outcome(task: bytes) -> bytes:
    return simulated(Task(**json.loads(task))).model_dump_json().encode()


if __name__ == "__main__":
    main(*sys.argv[1:])
