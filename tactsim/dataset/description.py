"""A data set in words: counts, splits, ranges, variables with their units."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tactsim.dataset.progress import kind_of
from tactsim.dataset.store import Store
from tactsim.dataset.variable import DONE, FAILED, PENDING, STATUS

Array = np.ndarray


def description(path: str | Path) -> str:
    """What ``tactsim data info`` prints."""
    store = Store.open(path)
    told = store.attributes
    lines = [f"{told.get('title') or path}", f"  {told['description']}", f"  licence {told['license']}, sweep {told['sweep_id']}"]
    lines += [f"  {name:<28} {count}" for name, count in [*status_counts(store).items(), *split_counts(store).items()]]
    lines += [f"  {count} x {reason}" for reason, count in failures(store)]
    return "\n".join([*lines, *(f"  {row[0]:<36} {row[1]:<28} {row[2]:<6} {row[3]}" for row in variable_rows(store))])


def status_counts(store: Store) -> dict[str, int]:
    """Samples by status."""
    status = store.read("status")
    return {name: int((status == number).sum()) for number, name in enumerate(STATUS)}


def split_counts(store: Store) -> dict[str, int]:
    """Samples that are done by split."""
    split, status = store.read("split"), store.read("status")
    names = str(store.group["split"].attrs["flag_meanings"]).split()
    return {name: int(((split == number) & (status == DONE)).sum()) for number, name in enumerate(names)}


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
    reasons, counts = np.unique([kind_of(str(reason)) for reason in store.read("reason")[failed]], return_counts=True)
    return sorted(zip(map(str, reasons), map(int, counts), strict=True), key=lambda pair: -pair[1])


def variable_rows(store: Store) -> list[tuple[str, str, str, str]]:
    """Name, dimensions, unit and meaning of every variable."""
    rows = []
    for name, array in store.arrays.items():
        sizes = zip(array.metadata.dimension_names or (), array.shape, strict=False)
        shape = ", ".join(f"{dimension} {size}" for dimension, size in list(sizes)[1:])
        rows.append((name, shape, str(array.attrs["units"]), str(array.attrs["long_name"])))
    return rows


def ranges(store: Store) -> list[tuple[str, str, str, str]]:
    """Name, unit, least and largest value of every varied number and label of the computed samples."""
    computed = store.read("status") != PENDING
    rows = []
    for name, array in store.arrays.items():
        if array.attrs["role"] not in ("varied", "label") or not computed.any():
            continue
        values = np.asarray(array[...], dtype=float)[computed]
        finite = values[np.isfinite(values)]
        low, high = (f"{finite.min():.4g}", f"{finite.max():.4g}") if finite.size else ("-", "-")
        rows.append((name, str(array.attrs["units"]), low, high))
    return rows
