"""A data set in words: counts, splits, ranges, variables with their units."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tactsim.dataset.progress import kind_of
from tactsim.dataset.settings import Splits
from tactsim.dataset.store import Store
from tactsim.dataset.variable import DONE, FAILED, PENDING, STATUS
from tactsim.outside.text import one_line

Array = np.ndarray
MOST_REASONS = 50
"""Reasons of failures that are told; the rest are counted."""


def description(path: str | Path) -> str:
    """What ``tactsim data info`` prints."""
    store = Store.open(path)
    told = store.attributes
    lines = [one_line(told["title"] or path), f"  {one_line(told['description'])}"]
    lines += [f"  licence {one_line(told['license'], 80)}, sweep {one_line(told['sweep_id'], 80)}"]
    lines += [f"  {name:<28} {count}" for name, count in [*status_counts(store).items(), *split_counts(store).items()]]
    lines += [f"  {count} x {reason}" for reason, count in failures(store)]
    lines += [f"  {row[0]:<36} {row[1]:<28} {row[2]:<6} {row[3]}" for row in variable_rows(store)]
    return "\n".join([*lines, *(f"  {one_line(name):<36} is gone; tactsim data check tells more" for name in store.missing)])


def status_counts(store: Store) -> dict[str, int]:
    """Samples by status."""
    status = store.read("status")
    return {name: int((status == number).sum()) for number, name in enumerate(STATUS)}


def split_counts(store: Store) -> dict[str, int]:
    """Samples that are done by split."""
    split, status = store.read("split"), store.read("status")
    names = one_line(store.described["split"].attributes.get("flag_meanings", "")).split()
    return {name: int(((split == number) & (status == DONE)).sum()) for number, name in enumerate(names)}


def empty_splits(counts: Mapping[str, int], splits: Splits) -> list[str]:
    """Parts of a data set that have a share, or conditions, and no sample that is done."""
    shares = {"train": splits.train, "validation": splits.validation, "test": 1 - splits.train - splits.validation}
    wanted = [name for name, share in shares.items() if share > 1e-9] + list(splits.out_of_distribution)  # round-off of the rest
    return [name for name in wanted if not counts.get(name)]


def redrawn(store: Store) -> tuple[int, int]:
    """How many specimens were drawn again because a draw was refused, and the refused draws of all specimens."""
    computed = store.read("status") != PENDING
    _, first = np.unique(store.read("specimen")[computed], return_index=True)
    draws = store.read("redraws")[computed][first].astype(int)
    refused = draws + (store.read("case_id")[computed][first] == "")  # of a specimen without a case the last one too
    return int((refused > 0).sum()), int(refused.sum())


def failures(store: Store) -> list[tuple[str, int]]:
    """Reasons of failed samples without their numbers, with counts, the most frequent first."""
    failed = np.flatnonzero(store.read("status") == FAILED)
    if not failed.size:
        return []
    kinds = [one_line(kind_of(str(reason))) for reason in store.read("reason", failed)]
    reasons, counts = np.unique(kinds, return_counts=True)
    pairs = sorted(zip(map(str, reasons), map(int, counts), strict=True), key=lambda pair: -pair[1])
    rest = sum(count for _, count in pairs[MOST_REASONS:])
    return pairs[:MOST_REASONS] + ([("other reasons", rest)] if rest else [])


def variable_rows(store: Store) -> list[tuple[str, str, str, str]]:
    """Name, dimensions, unit and meaning of every variable."""
    rows = []
    for name, array in store.described.items():
        sizes = zip(array.dimensions[1:], array.shape[1:], strict=True)
        shape = ", ".join(f"{one_line(dimension)} {size}" for dimension, size in sizes)
        units, meaning = (one_line(array.attributes[key]) for key in ("units", "long_name"))
        rows.append((name, shape, units, meaning))
    return rows


def ranges(store: Store) -> list[tuple[str, str, str, str]]:
    """Name, unit, least and largest value of every varied number and label of the computed samples."""
    computed = np.flatnonzero(store.read("status") != PENDING)
    rows = []
    for name, array in store.described.items():
        if array.attributes["role"] not in ("varied", "label") or array.dtype == "str" or not computed.size:
            continue
        values = np.asarray(store.read(name, computed), dtype=float)
        finite = values[np.isfinite(values)]
        low, high = (f"{finite.min():.4g}", f"{finite.max():.4g}") if finite.size else ("-", "-")
        rows.append((name, one_line(array.attributes["units"]), low, high))
    return rows
