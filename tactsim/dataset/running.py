"""Runs a sweep: hands out samples, keeps what comes back, and goes on where an earlier run stopped."""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tactsim.code_identity import code_identity
from tactsim.dataset.array_description import META
from tactsim.dataset.block import Block, decoded, refuse_unfitting
from tactsim.dataset.checking_arrays import wrong_arrays
from tactsim.dataset.computing import computed
from tactsim.dataset.executor import Executor, Outcome
from tactsim.dataset.holes import JOURNAL
from tactsim.dataset.identity import attributes_of, check_same
from tactsim.dataset.journal import Journal
from tactsim.dataset.layout import Layout, layout_of
from tactsim.dataset.progress import Tally
from tactsim.dataset.store import Store, consolidated_metadata
from tactsim.dataset.store_files import refuse_links, remove_torn
from tactsim.dataset.store_writing import consolidate, create, resize, restore, tell, write
from tactsim.dataset.sweep import Sweep
from tactsim.dataset.variable import DONE, FAILED
from tactsim.dataset.verifying import damaged_samples, mark_pending
from tactsim.errors import StorageError, TactsimError
from tactsim.outside.text import one_line
from tactsim.storage.building import refuse_taken, remove_leftover
from tactsim.storage.files import naming
from tactsim.storage.locking import only_one

TASK_SECONDS = 0.5
"""What a task should take: short samples are handed out many at a time."""
MOST_IN_TASK = 256
FOLD_SECONDS = 10.0
FOLD_SAMPLES = 1024
"""The journal is folded into the arrays after so many seconds or samples, whichever is first."""
LOSSES_IN_A_ROW = 30
"""Lost tasks without any that came back after which the workers themselves must be at fault."""
MOST_LOSSES = 3
"""Lost workers after which a sample is marked failed."""


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
        """Compute every pending sample; on any exception what is complete is kept."""
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
        finally:
            self.fold()

    def keep(self, content: bytes, block: Block) -> None:
        """Puts a block into the journal, and the journal into the arrays when it is time."""
        block["code"] = np.full_like(block["code"], self.code)
        self.journal.append(content)
        self.blocks.append(block)
        failed = block["status"] == FAILED
        self.tally.add(int((block["status"] == DONE).sum()), [str(reason) for reason in block["reason"][failed]])
        waiting = sum(len(block["sample"]) for block in self.blocks)
        if waiting >= FOLD_SAMPLES or time.monotonic() - self.folded > FOLD_SECONDS:
            self.fold()

    def fold(self) -> None:
        """Writes what the journal holds into the arrays, then forgets it."""
        if self.blocks:
            whole = {name: np.concatenate([block[name] for block in self.blocks]) for name in self.blocks[0]}
            write(self.store, whole, self.layout.variables)
            self.journal.clear()
        self.blocks, self.folded = [], time.monotonic()

    def recover(self) -> None:
        """Brings what a killed run left in its journal into the arrays."""
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

    def _lost(self, outcome: Outcome) -> list[int]:
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


def _next_task(todo: deque[tuple[int, ...]], size: int) -> tuple[int, ...]:
    """Whole specimens of about ``size`` samples, or a part of a large one."""
    task = list(todo.popleft())
    while todo and len(task) + len(todo[0]) <= size:
        task += todo.popleft()
    if len(task) > max(size, 1):
        todo.appendleft(tuple(task[max(size, 1) :]))
    return tuple(task[: max(size, 1)])


@contextmanager
def opened_run(sweep: Sweep, path: str | Path, *, resume: bool = False, accept_changes: bool = False) -> Iterator[SweepRun]:
    """A new store for a sweep, or the one that an earlier run left, owned until the block ends.

    Parameters
    ----------
    resume
        Whether to go on in an existing store.
    accept_changes
        Whether to go on although the code has changed since; samples are then marked with the code that computed them.

    Raises
    ------
    StorageError
        If the place is taken, in use, cannot be written, or holds another sweep or one of other code.
    """
    place = Path(path)
    layout = layout_of(sweep)
    with only_one(place, f"the data set {one_line(place)} is in use by another sweep; wait for it or choose another with --out"):
        with naming(place):
            remove_leftover(place)
        if os.path.lexists(place / META):
            run = _continued(sweep, layout, place, resume, accept_changes)
        elif resume:
            raise StorageError(f"there is no data set {one_line(place)} to resume; leave out --resume")
        else:
            run = _run(sweep, layout, _created(sweep, layout, place))
        run.tally.before = run.store.samples - len(run.store.pending())
        yield run


def _run(sweep: Sweep, layout: Layout, store: Store) -> SweepRun:
    last = len(store.attributes["codes"]) - 1
    return SweepRun(sweep, layout, store, Journal(store.path / JOURNAL), Tally(store.samples), last)


def _created(sweep: Sweep, layout: Layout, place: Path) -> Store:
    try:
        refuse_taken(place)
    except StorageError:
        told = f"{one_line(place)} exists and is not a data set of tactsim; choose another with --out"
        raise StorageError(told) from None
    return create(place, layout.variables, sweep.samples, attributes_of(sweep, layout))


def _continued(sweep: Sweep, layout: Layout, place: Path, resume: bool, accept_changes: bool) -> SweepRun:
    """The run in a store that an earlier one left: put right, its journal in the arrays, and every sample verified."""
    store = Store.open(place, writing=True, damaged=resume)
    if not resume:
        raise StorageError(f"the data set {one_line(place)} exists; go on with it by --resume or choose another with --out")
    check_same(sweep, store.attributes, place)
    _check_code(store, accept_changes)
    refuse_links(place)
    Journal(place / JOURNAL).refuse_foreign()
    store = _put_right(sweep, layout, store)
    run = _run(sweep, layout, store)
    run.recover()
    _mark_damaged(run)
    if code_identity() != store.attributes["codes"][-1]:
        tell(store, codes=[*store.attributes["codes"], code_identity()])
        run.code += 1
    return run


def _check_code(store: Store, accept_changes: bool) -> None:
    last = store.attributes["codes"][-1]
    if last != code_identity() and not accept_changes:
        raise StorageError(
            f"the data set {one_line(store.path)} was computed by tactsim {one_line(last, 80)}, this is {code_identity()}; "
            "mark what follows with --accept-changed-code, or begin anew with another --out"
        )


def _put_right(sweep: Sweep, layout: Layout, store: Store) -> Store:
    """The store with all its arrays, of the sweep's length and described as one."""
    _refuse_other_arrays(store, layout)
    present = store.described.get("status") or next(iter(store.described.values()), None)
    if present is None:
        raise StorageError(f"{one_line(store.path)} has no array left; compute it anew with another --out, or bring back a copy")
    if sweep.samples < present.shape[0]:
        told = f"has {present.shape[0]} samples; --samples {sweep.samples} would lose some"
        raise StorageError(f"the data set {one_line(store.path)} {told}")
    remove_torn(store.path, store.described)
    restored = restore(store, layout.variables)
    lengths = {array.shape[0] for array in store.described.values()}
    if restored or lengths != {sweep.samples}:
        store = Store.open(store.path, writing=True)
        resize(store, sweep.samples, layout.variables)
    if store.attributes["sweep"] != sweep.text:
        tell(store, sweep=sweep.text)
    elif restored or lengths != {sweep.samples} or not _is_gathered(store):
        consolidate(store.path)
    return Store.open(store.path, writing=True)


def _refuse_other_arrays(store: Store, layout: Layout) -> None:
    """Refuses to write into arrays that are not those of the sweep."""
    remedy = "or remove it, and --resume makes it anew"
    if store.faults:
        raise StorageError(f"{next(iter(store.faults.values()))}, {remedy}")
    for name, words in wrong_arrays(store.described.values(), layout.variables):
        raise StorageError(f"{one_line(store.path / name / META)}: {words}; bring back a copy of it, {remedy}")


def _is_gathered(store: Store) -> bool:
    gathered = consolidated_metadata(store.path)
    return all(gathered.get(name) == array.told for name, array in store.described.items())


def _mark_damaged(run: SweepRun) -> None:
    """Marks every sample pending that counts as computed but is not what was written."""
    found = damaged_samples(run.store, run.layout.variables)
    if found:
        numbers = np.unique(np.concatenate(list(found.values())))
        mark_pending(run.store, numbers)
        run.tally.again = len(numbers)
        run.tally.damaged |= {reason: len(samples) for reason, samples in found.items()}
