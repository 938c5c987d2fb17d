"""What is counted of a data set: samples by status and by split, redraws, failures and warnings."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tactsim.array import Array
from tactsim.dataset.cost import COST
from tactsim.dataset.sampling.settings import Splits
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import DONE, FAILED, PENDING, STATUS
from tactsim.dataset.store.blocks import JOURNAL, Journal
from tactsim.dataset.store.opening import Store
from tactsim.dataset.text_counts import LONGEST_WARNING, CountedText, TextCounts
from tactsim.errors import StorageError, shown
from tactsim.outside.text import one_line

MOST_REASONS = 50
"""Reasons of failures, and warnings, that are listed; the rest are counted."""
UNLIKELY = 0.01
"""Probability of drawing an option not once, below which it is said to be impossible."""


def status_lines(store: Store) -> list[str]:
    """Samples by status, and those that are computed and not yet in the arrays, which count as neither pending nor done."""
    numbers, note = np.arange(0), ""
    try:
        numbers = Journal(store.path / JOURNAL).waiting(store.samples)
    except StorageError as error:
        note = f"  {error}"
    status = store.read("status")  # after the journal, and once: what a sweep that is running brings in meanwhile counts once
    waiting, counts = int((status[numbers] == PENDING).sum()), _by_status(status)
    counts["pending"] -= waiting
    lines = [f"  {name:<28} {count}" for name, count in counts.items()]
    if waiting:
        words = "computed, in the journal, not yet in the arrays: a sweep is running, or was killed, and --resume brings them in"
        lines.append(f"  {'waiting':<28} {waiting}  {words}")
    return [*lines, note] if note else lines


def status_counts(store: Store) -> dict[str, int]:
    """Samples by status."""
    return _by_status(store.read("status"))


def _by_status(status: Array) -> dict[str, int]:
    return {name: int((status == number).sum()) for number, name in enumerate(STATUS)}


def split_counts(store: Store) -> dict[str, int]:
    """Samples that are done by split."""
    split, status = store.read("split"), store.read("status")
    names = one_line(store.described["split"].attributes.get("flag_meanings", "")).split()
    return {name: int(((split == number) & (status == DONE)).sum()) for number, name in enumerate(names)}


def costs_of(store: Store) -> dict[str, Array]:
    """Numbers (n,) of the computed samples, their wall times in s and what is known of their cost."""
    computed = np.flatnonzero(store.read("status") != PENDING)
    known = [name for name in ("wall_time", *COST) if name in store.described]
    return {"sample": computed} | {name: store.read(name, computed) for name in known}


def empty_splits(counts: Mapping[str, int], splits: Splits) -> list[str]:
    """Parts of a data set that have a share, or conditions, and no sample that is done."""
    wanted = [*split_shares(splits), *splits.out_of_distribution]
    return [name for name in wanted if not counts.get(name)]


def split_shares(splits: Splits) -> dict[str, float]:
    """Share of the specimens of every part that has one."""
    shares = {"train": splits.train, "validation": splits.validation, "test": 1 - splits.train - splits.validation}
    return {name: share for name, share in shares.items() if share > 1e-9}  # the rest may be round-off


def redrawn(store: Store) -> tuple[int, int]:
    """How many specimens were drawn again because a draw was refused, and the refused draws of all specimens."""
    computed = store.read("status") != PENDING
    _, first = np.unique(store.read("specimen")[computed], return_index=True)
    draws = store.read("redraws")[computed][first].astype(int)
    refused = draws + (store.read("case_id")[computed][first] == "")  # without a case the last draw, too
    return int((refused > 0).sum()), int(refused.sum())


def never_drawn(store: Store, sweep: Sweep) -> list[tuple[str, str, float]]:
    """Key path, option and its share of the draws, of every option that no sample has although draws were refused and so many
    specimens are there that chance does not explain it.
    """
    if not redrawn(store)[1]:
        return []
    computed = np.flatnonzero(store.read("status") != PENDING)
    specimens = store.read("specimen", computed)
    absent = []
    for place in sweep.places:
        drawn = store.read(place.variable, computed)
        chosen = np.isfinite(drawn)
        independent = len(np.unique(specimens[chosen]))
        for option, number, share in place.distribution.shares():
            if share > 0 and (1 - share) ** independent < UNLIKELY and not (drawn[chosen] == number).any():
                absent.append((place.key, shown(option), share))
    return absent


def failures(store: Store) -> list[CountedText]:
    """Reasons of failed samples, those that differ in their numbers only as one, with their samples, the most frequent first."""
    failed = np.flatnonzero(store.read("status") == FAILED)
    reasons = TextCounts()
    for sample, reason in zip(failed.tolist(), store.read("reason", failed), strict=True):
        reasons.add(sample, [one_line(reason)])
    return _first(reasons, "other reasons")


def warnings_of(store: Store) -> list[CountedText]:
    """Warnings of samples that are done, with their samples, the most frequent first."""
    counts = TextCounts(LONGEST_WARNING)
    done = np.flatnonzero(store.read("status") == DONE)
    for sample, text in zip(done.tolist(), store.read("warnings", done), strict=True):
        counts.add(sample, map(one_line, str(text).splitlines()))
    return _first(counts, "other warnings")


def _first(counts: TextCounts, others: str) -> list[CountedText]:
    texts = counts.most_common()
    rest = sum(one.count for one in texts[MOST_REASONS:])
    return texts[:MOST_REASONS] + ([CountedText(others, rest)] if rest else [])
