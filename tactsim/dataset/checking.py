"""Whether a data set is what its sweep wrote: complete, undamaged, finite, without doubles, splits apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactsim.dataset.block import checksum
from tactsim.dataset.layout import Layout, layout_of
from tactsim.dataset.running import JOURNAL
from tactsim.dataset.store import Store
from tactsim.dataset.sweep import sweep_of_text
from tactsim.dataset.variable import DONE, FAILED, PENDING, STATUS, Variable
from tactsim.errors import InputError, StorageError

Array = np.ndarray
SHOWN = 10
"""Samples named in one finding."""


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong: its kind, the samples, and what it is in words."""

    kind: str
    samples: tuple[int, ...]
    words: str

    def __str__(self) -> str:
        more = f" and {len(self.samples) - SHOWN} more" if len(self.samples) > SHOWN else ""
        which = f"; samples {', '.join(map(str, self.samples[:SHOWN]))}{more}" if self.samples else ""
        return f"{self.kind}: {self.words}{which}"


@dataclass(frozen=True)
class Checked:
    """Counts by status, and what was found."""

    counts: dict[str, int]
    findings: tuple[Finding, ...]


def check(path: str | Path) -> Checked:
    """Reads every sample once.

    Raises
    ------
    StorageError
        If the folder is not a data set, or its description is damaged.
    """
    store = Store.open(path)
    try:
        sweep = sweep_of_text(store.attributes["sweep"])
        layout = layout_of(sweep)
    except (KeyError, InputError, ValueError) as error:
        raise StorageError(f"{path}: the case in it cannot be read by this tactsim: {error}") from None
    findings = list(_arrays_missing(store, layout, sweep.samples))
    if findings:
        return Checked({}, tuple(findings))
    status = store.read("status")
    counts = {name: int((status == number).sum()) for number, name in enumerate(STATUS)}
    findings += [*_missing(store, status), *_leaks(store, status)]
    findings += _values(store, layout, status)
    return Checked(counts, tuple(findings))


def _arrays_missing(store: Store, layout: Layout, samples: int) -> Iterator[Finding]:
    for variable in layout.variables:
        if variable.name not in store.group:
            yield Finding("missing", (), f"the variable {variable.name}")
        elif store.group[variable.name].shape != (samples, *variable.sizes):
            yield Finding("missing", (), f"{variable.name} has the shape {store.group[variable.name].shape} of {samples} samples")


def _missing(store: Store, status: Array) -> Iterator[Finding]:
    pending = np.flatnonzero(status == PENDING)
    if pending.size:
        yield Finding("missing", tuple(pending.tolist()), f"{pending.size} samples are not computed; go on with --resume")
    if (store.path / JOURNAL).exists():
        yield Finding("unfinished", (), "samples wait in the journal; a sweep is running, or was killed: --resume")
    unknown = np.flatnonzero(status > FAILED)
    if unknown.size:
        yield Finding("damaged", tuple(unknown.tolist()), "the status is unknown")


def _leaks(store: Store, status: Array) -> Iterator[Finding]:
    """Specimens in two splits, and case ids in two splits or twice."""
    split, specimen, case = store.read("split"), store.read("specimen"), store.read("case_id")
    computed = np.flatnonzero(status != PENDING)
    for what, keys in (("specimen", specimen), ("case", case)):
        own = computed if what == "specimen" else computed[case[computed] != ""]
        _, inverse = np.unique(keys[own], return_inverse=True)
        low, high = np.full(len(own), 10**6), np.full(len(own), -1)
        np.minimum.at(low, inverse, split[own].astype(int))
        np.maximum.at(high, inverse, split[own].astype(int))
        leaking = own[low[inverse] != high[inverse]] if len(own) else own
        if leaking.size:
            yield Finding("leakage", tuple(leaking.tolist()), f"a {what} is in two splits")
        if what == "case" and len(own):
            twice = own[np.bincount(inverse)[inverse] > 1]
            if twice.size:
                yield Finding("duplicate", tuple(twice.tolist()), "the same case more than once")


def _values(store: Store, layout: Layout, status: Array) -> list[Finding]:
    """Checksums, numbers that are not finite, readings that never change, samples with equal readings."""
    damaged: list[int] = []
    equal: list[int] = []
    infinite: dict[str, list[int]] = {}
    constant: dict[str, list[int]] = {}
    seen: dict[bytes, int] = {}
    step = int(store.group["status"].chunks[0])
    for begin in range(0, len(status), step):
        chunk = {v.name: np.asarray(store.group[v.name][begin : begin + step]) for v in layout.variables}
        for row in np.flatnonzero(status[begin : begin + step] != PENDING):
            sample = {name: values[row] for name, values in chunk.items()}
            number = begin + int(row)
            if (checksum(sample, layout.variables) != sample["checksum"]).any():
                damaged.append(number)
            if sample["status"] != DONE:
                continue
            for name in _not_finite(sample, layout):
                infinite.setdefault(name, []).append(number)
            for variable in _readings(layout):
                if (
                    not variable.prescribed
                    and variable.sizes
                    and np.prod(variable.sizes) > 1
                    and np.ptp(sample[variable.name]) == 0
                ):
                    constant.setdefault(variable.name, []).append(number)
            key = b"".join(np.ascontiguousarray(sample[v.name]).tobytes() for v in _readings(layout))
            equal += [number] if key in seen else []
            seen.setdefault(key, number)
    return _told(damaged, infinite, constant, equal)


def _told(
    damaged: list[int],
    infinite: dict[str, list[int]],
    constant: dict[str, list[int]],
    equal: list[int],
) -> list[Finding]:
    found = [Finding("checksum", tuple(damaged), "the content is not what was written")] if damaged else []
    found += [Finding("not finite", tuple(numbers), name) for name, numbers in infinite.items()]
    found += [Finding("constant", tuple(numbers), f"{name} has one value throughout") for name, numbers in constant.items()]
    found += [Finding("duplicate", tuple(equal), "the same readings as an earlier sample")] if equal else []
    return found


def _not_finite(sample: dict[str, Array], layout: Layout) -> Iterator[str]:
    for variable in _readings(layout):
        if not (variable.optional or np.isfinite(sample[variable.name]).all()):
            yield variable.name


def _readings(layout: Layout) -> list[Variable]:
    return [variable for variable in layout.variables if variable.role == "reading"]
