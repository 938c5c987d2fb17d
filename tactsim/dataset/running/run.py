"""One run of a sweep: hands out samples, keeps what comes back, counts, and folds what it kept into the store."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from tactsim.dataset.cost import COST, slow_lines
from tactsim.dataset.running.computing import computed
from tactsim.dataset.running.executors import Executor, TaskOutcome
from tactsim.dataset.sampling.layout import Layout
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import DONE, FAILED
from tactsim.dataset.store.blocks import Block, Journal, decoded, refuse_unfitting
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.writing import write
from tactsim.dataset.text_counts import LONGEST_WARNING, TextCounts
from tactsim.errors import CaseError, StorageError, TactsimError
from tactsim.outside.text import one_line
from tactsim.units import rough_time

TASK_SECONDS = 0.5
"""Time in s that a task should take: short samples are handed out many at a time."""
MOST_IN_TASK = 256
"""Samples of a task, at most, however short they are."""
FOLD_SECONDS = 10.0
FOLD_SAMPLES = 1024
"""The journal is folded into the arrays after so many seconds or samples, whichever is first."""
LOSSES_IN_A_ROW = 30
"""Lost tasks in a row, none coming back between them, after which the workers themselves must be at fault."""
MOST_KINDS = 20
"""Reasons of failures, and warnings, that are listed at the end."""
MOST_LOSSES = 3
"""Lost workers after which a sample is marked failed."""


@dataclass
class Tally:
    """Counts of a sweep that goes on since ``begin`` in s; ``before`` samples were computed by an earlier one."""

    samples: int
    before: int = 0
    done: int = 0
    failed: int = 0
    reasons: TextCounts = field(default_factory=TextCounts)
    warned: TextCounts = field(default_factory=lambda: TextCounts(LONGEST_WARNING))
    """Warnings of samples that are done -> of how many."""
    begin: float = field(default_factory=time.monotonic)
    damaged: dict[str, int] = field(default_factory=dict)
    """Why samples of an earlier sweep are computed again -> how many; a sample may have several reasons."""
    again: int = 0
    """How many samples these are in all."""
    retried: int = 0
    """How many samples are computed again because the time of an earlier run did not suffice."""
    costs: list[Block] = field(default_factory=list)
    """Of the samples of each block: their numbers, wall times and cost."""

    def timed(self, block: Block) -> None:
        """Notes how long new samples took, and what they cost."""
        self.costs.append({name: block[name] for name in ("sample", "wall_time", *COST)})

    def add(self, warnings: dict[int, str], reasons: dict[int, str]) -> None:
        """Counts new samples: by the warnings of each that is done, and by the reasons of those that failed, by their numbers."""
        self.done += len(warnings)
        self.failed += len(reasons)
        for sample, text in warnings.items():
            self.warned.add(sample, text.splitlines())
        for sample, text in reasons.items():
            self.reasons.add(sample, [text])

    @property
    def rate(self) -> float:
        """Samples per second of this sweep."""
        return (self.done + self.failed) / max(time.monotonic() - self.begin, 1e-9)

    def line(self) -> str:
        """One line of progress."""
        now = self.before + self.done + self.failed
        so_far = f"{now} of {self.samples} samples, {self.failed} failed"
        if not self.done + self.failed:
            return f"{so_far}; computing the first for {rough_time(time.monotonic() - self.begin)}"
        return f"{so_far}, {_per_time(self.rate)}, {rough_time((self.samples - now) / self.rate)} left"

    def summary(self) -> list[str]:
        """Lines at the end: counts, rate, the slowest samples, and failures by reason."""
        seconds = time.monotonic() - self.begin
        noun = "sample" if self.done == 1 else "samples"
        lines = [f"{self.done} {noun} done, {self.failed} failed in {rough_time(seconds)} ({_per_time(self.rate)})"]
        if self.before:
            lines.append(f"{self.before} {'sample was' if self.before == 1 else 'samples were'} there before")
        if self.costs:
            lines += slow_lines({name: np.concatenate([block[name] for block in self.costs]) for name in self.costs[0]})
        if self.retried:
            lines.append(f"{self.retried} samples for which the time did not suffice before were computed again")
        if self.damaged:
            lines.append(f"{self.again} samples were there and damaged; they were marked pending, to be computed again:")
            lines += [f"  {count} x {one_line(reason, 160)}" for reason, count in self.damaged.items()]
        counted = [
            (one, f"failed: {one_line(one.text)}", self.done + self.failed) for one in self.reasons.most_common(MOST_KINDS)
        ]
        counted += [(one, f"warning: {one_line(one.text)}", self.done) for one in self.warned.most_common(MOST_KINDS)]
        return lines + [f"  {one.of(samples)}: {words}" for one, words, samples in counted]


def _per_time(rate: float) -> str:
    return f"{rate:.3g} samples/s" if rate >= 1 else f"{3600 * rate:.3g} samples/h"


@dataclass
class SweepRun:
    """A sweep into an open store, by one process."""

    sweep: Sweep
    layout: Layout
    store: Store
    journal: Journal
    tally: Tally
    code: int
    """Which entry of the attribute codes computes now."""
    blocks: list[Block] = field(default_factory=list)
    folded: float = field(default_factory=time.monotonic)
    losses: Counter[int] = field(default_factory=Counter)
    lost_in_a_row: int = 0

    def compute(self, executor: Executor, progress: Callable[[Tally], None]) -> None:
        """Compute every pending sample; on any exception what is complete is kept.

        Raises
        ------
        CaseError
            If the sweep itself is at fault.
        TactsimError
            If a worker met a defect, or too many tasks in a row were lost.
        StorageError
            If the samples cannot be written.
        """
        todo, alone = deque(tuple(group) for group in self._specimens()), deque[int]()
        under_way, size = 0, 1
        try:
            while todo or alone or under_way:
                while (todo or alone) and under_way < executor.slots:
                    executor.submit((alone.popleft(),) if alone else _next_task(todo, size))
                    under_way += 1
                for outcome in executor.wait(1.0):
                    under_way -= 1
                    if outcome.block is None:
                        alone.extend(self._lost(outcome))
                        continue
                    self.lost_in_a_row = 0
                    block = decoded(outcome.block)
                    self.keep(outcome.block, block)
                    size = int(np.clip(TASK_SECONDS / max(float(block["wall_time"].mean()), 1e-6), 1, MOST_IN_TASK))
                progress(self.tally)
        except CaseError as error:
            raise self.sweep.placed(error) from None
        finally:
            self.fold()

    def keep(self, content: bytes, block: Block) -> None:
        """Puts a block into the journal, and the journal into the arrays when it is time.

        Raises
        ------
        StorageError
            If there is no room for it.
        """
        block["code"] = np.full_like(block["code"], self.code)
        self.journal.append(content)
        self.blocks.append(block)
        self.tally.timed(block)
        self.tally.add(_by_sample(block, "warnings", DONE), _by_sample(block, "reason", FAILED))
        waiting = sum(len(block["sample"]) for block in self.blocks)
        if waiting >= FOLD_SAMPLES or time.monotonic() - self.folded > FOLD_SECONDS:
            self.fold()

    def fold(self) -> None:
        """Writes what the journal holds into the arrays, then forgets it.

        Raises
        ------
        StorageError
            If the arrays cannot be written.
        """
        if self.blocks:
            whole = {name: np.concatenate([block[name] for block in self.blocks]) for name in self.blocks[0]}
            write(self.store, whole, self.layout.variables)
            self.journal.clear()
        self.blocks, self.folded = [], time.monotonic()

    def recover(self) -> None:
        """Brings what a killed run left in its journal into the arrays.

        Raises
        ------
        StorageError
            If the journal is not ours, or the arrays cannot be written.
        """
        for content in self.journal.blocks():
            try:
                block = decoded(content)
                refuse_unfitting(block, self.layout.variables, self.store.samples)
            except StorageError as error:
                self.tally.damaged["block of the journal passed over: " + str(error)] = 1
                continue
            block["code"] = np.full_like(block["code"], len(self.store.attributes["codes"]) - 1)
            self.blocks.append(block)
        self.fold()
        self.journal.clear()

    def _specimens(self) -> Iterator[list[int]]:
        """Pending samples, those of a specimen together."""
        pending = self.store.pending()
        borders = np.flatnonzero(np.diff(pending // self.sweep.per_specimen)) + 1
        for group in np.split(pending, borders) if pending.size else ():
            yield [int(number) for number in group]

    def _lost(self, outcome: TaskOutcome) -> list[int]:
        """The samples of a lost task that are tried again, each alone; the others are marked failed."""
        self.lost_in_a_row += 1
        if self.lost_in_a_row >= LOSSES_IN_A_ROW:
            raise TactsimError(
                f"{self.lost_in_a_row} tasks in a row were lost, the last because {outcome.reason}; nothing is marked"
            )
        again = []
        for number in outcome.samples:
            self.losses[number] += 1
            if self.losses[number] < MOST_LOSSES or len(outcome.samples) > 1:
                again.append(number)
                continue
            reason = f"lost {self.losses[number]} times: {outcome.reason}"
            content = computed(self.sweep.text, [number], lost=reason, folder=self.sweep.folder)
            self.keep(content, decoded(content))
        return again


def _by_sample(block: Block, name: str, status: int) -> dict[int, str]:
    """Number of each sample of a status -> its text of a name."""
    these = block["status"] == status
    return dict(zip(block["sample"][these].tolist(), map(str, block[name][these]), strict=True))


def _next_task(todo: deque[tuple[int, ...]], size: int) -> tuple[int, ...]:
    """Whole specimens of about ``size`` samples, or a part of a large one."""
    task = list(todo.popleft())
    while todo and len(task) + len(todo[0]) <= size:
        task += todo.popleft()
    if len(task) > max(size, 1):
        todo.appendleft(tuple(task[max(size, 1) :]))
    return tuple(task[: max(size, 1)])
