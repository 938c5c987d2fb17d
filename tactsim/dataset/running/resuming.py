"""A store opened for a sweep: made new, or put right and verified so that a run goes on where an earlier one stopped."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.code_identity import code_identity
from tactsim.dataset.running.run import SweepRun, Tally
from tactsim.dataset.sampling.layout import Layout, layout_of
from tactsim.dataset.sampling.stored import attributes_of, attributes_of_sweep, check_same, layout_within, stored_sweep
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import FAILED, META, earlier_words, wrong_arrays
from tactsim.dataset.store.blocks import JOURNAL, Journal
from tactsim.dataset.store.files import refuse_links, remove_torn
from tactsim.dataset.store.labels import labels_of
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import damaged_samples, lost_status, mark_pending
from tactsim.dataset.store.writing import consolidate, create, resize, restore, restore_labels, set_attributes
from tactsim.deadline import TOO_LONG
from tactsim.errors import CaseError, StorageError
from tactsim.outside.text import one_line
from tactsim.storage.building import refuse_taken, refuse_within_data_set, remove, remove_leftover
from tactsim.storage.files import naming
from tactsim.storage.locking import only_one


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
    with only_one(place, f"the data set {one_line(place)} is in use by another sweep; wait for it or choose another folder"):
        with naming(place):
            remove_leftover(place)
        new = not os.path.lexists(place / META)
        if not new:
            run = _continued(sweep, layout, place, resume, accept_changes)
        elif resume:
            raise StorageError(f"there is no data set {one_line(place)} to resume; leave out --resume (in Python: resume=True)")
        else:
            run = _run(sweep, layout, _created(sweep, layout, place))
        run.tally.before = run.store.samples - len(run.store.pending())
        try:
            yield run
        except CaseError:  # what the sweep stores is wrong for every sample
            if new and len(run.store.pending()) == run.store.samples:
                with naming(place, "remove"):
                    remove(place)
            raise


def _run(sweep: Sweep, layout: Layout, store: Store) -> SweepRun:
    last = len(store.attributes["codes"]) - 1
    return SweepRun(sweep, layout, store, Journal(store.path / JOURNAL), Tally(store.samples), last)


def _created(sweep: Sweep, layout: Layout, place: Path) -> Store:
    refuse_within_data_set(place)
    try:
        refuse_taken(place)
    except StorageError:
        taken = f"{one_line(place)} exists and is not a data set of tactsim; choose another folder"
        raise StorageError(taken) from None
    return create(place, layout.variables, sweep.samples, attributes_of(sweep, layout))


def _continued(sweep: Sweep, layout: Layout, place: Path, resume: bool, accept_changes: bool) -> SweepRun:
    """The run in a store that an earlier one left: put right, its journal in the arrays, and every sample verified."""
    store = Store.open(place, writing=True, damaged=resume)
    if not resume:
        how = "go on with it by --resume (in Python: resume=True), or choose another folder"
        raise StorageError(f"the data set {one_line(place)} exists; {how}")
    check_same(sweep, store.attributes, place)
    earlier = stored_sweep(store).settings.time_limit
    _check_code(store, accept_changes)
    refuse_links(place)
    Journal(place / JOURNAL).refuse_foreign()
    layout = layout_within(store, layout)
    store = _put_right(sweep, layout, store)
    run = _run(sweep, layout, store)
    _recover(run)
    if earlier is not None and (sweep.settings.time_limit or math.inf) > earlier:
        _mark_too_slow(run)
    if code_identity() != store.attributes["codes"][-1]:
        set_attributes(store, codes=[*store.attributes["codes"], code_identity()])
        run.code += 1
    return run


def _check_code(store: Store, accept_changes: bool) -> None:
    last = store.attributes["codes"][-1]
    if last != code_identity() and not accept_changes:
        raise StorageError(
            f"the data set {one_line(store.path)} was computed by tactsim {one_line(last, 80)}, this is {code_identity()}; "
            "mark what follows with --accept-changed-code (in Python: accept_changed_code=True), or begin anew in another folder"
        )


def _put_right(sweep: Sweep, layout: Layout, store: Store) -> Store:
    """The store with all its arrays, of the sweep's length and described as one."""
    _refuse_other_arrays(store, layout)
    present = store.described.get("status") or next(iter(store.described.values()), None)
    if present is not None and sweep.samples < present.shape[0]:
        fewer = (
            f"has {present.shape[0]} samples, {sweep.samples} would lose some; ask for at least as many, or choose another folder"
        )
        raise StorageError(f"the data set {one_line(store.path)} {fewer}")
    names = {*store.described, *(variable.name for variable in layout.variables), *labels_of(layout.variables)}
    remove_torn(store.path, names)
    restored = restore(store, layout.variables, sweep.samples)
    labelled = restore_labels(store, layout.variables)
    lengths = {array.shape[0] for array in store.described.values()}
    if restored or lengths != {sweep.samples}:
        store = Store.open(store.path, writing=True)
        resize(store, sweep.samples, layout.variables)
    if store.attributes["sweep"] != sweep.text:
        set_attributes(store, **attributes_of_sweep(sweep))
    elif restored or labelled or lengths != {sweep.samples} or store.ungathered:
        consolidate(store.path)
    return Store.open(store.path, writing=True)


def _refuse_other_arrays(store: Store, layout: Layout) -> None:
    """Refuses to write into arrays that are not those of the sweep."""
    remedy = "or remove it, and --resume makes it anew"
    if never := store.never_stored(variable.name for variable in layout.variables):
        raise StorageError(f"{one_line(store.path)}: {earlier_words(never)}; begin anew in another folder")
    if store.faults:
        raise StorageError(f"{next(iter(store.faults.values()))}, {remedy}")
    for name, words in wrong_arrays(store.described.values(), layout.variables):
        raise StorageError(f"{one_line(store.path / name / META)}: {words}; bring back a copy of it, {remedy}")


def _mark_too_slow(run: SweepRun) -> None:
    """Marks the samples pending for which the time of an earlier run did not suffice."""
    failed = np.flatnonzero(run.store.read("status") == FAILED)
    slow = [sample for sample, reason in zip(failed, run.store.read("reason", failed), strict=True) if TOO_LONG in str(reason)]
    mark_pending(run.store, np.array(slow, int))
    run.tally.retried = len(slow)


def _recover(run: SweepRun) -> None:
    """Marks every sample pending that counts as computed but is not what was written, and brings in what the journal holds."""
    damaged = damaged_samples(run.store, run.layout.variables)
    mark_pending(run.store, _of_all(damaged))
    run.recover()  # into chunks that can be read: others were removed
    if (lost := lost_status(run.store)).size:  # what was in the journal is not
        damaged["status is gone"] = lost
        mark_pending(run.store, lost)
    run.tally.again = len(np.intersect1d(_of_all(damaged), run.store.pending()))
    run.tally.damaged |= {reason: len(samples) for reason, samples in damaged.items()}


def _of_all(damaged: Mapping[str, Array]) -> Array:
    """Every sample (n,) that is damaged for one reason or another."""
    return np.unique(np.concatenate([np.arange(0), *damaged.values()]))
