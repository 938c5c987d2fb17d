"""Whether the samples of a data set are what was written, finite, unlike each other, and their splits apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from tactsim.dataset.sampling.layout import Layout
from tactsim.dataset.store.arrays import DONE, PENDING
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import ChunkRead, computed_chunks
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside.text import one_line

Array = np.ndarray
AGAIN = "go on with --resume, which computes them again, or bring back a copy"
SHOWN = 10
"""Samples named in one finding."""


@dataclass(frozen=True)
class Finding:
    """Its kind, the samples, and in words what it is and what to do."""

    kind: str
    samples: tuple[int, ...]
    words: str

    def __str__(self) -> str:
        more = f" and {len(self.samples) - SHOWN} more" if len(self.samples) > SHOWN else ""
        which = f"; samples {', '.join(map(str, self.samples[:SHOWN]))}{more}" if self.samples else ""
        return f"{self.kind}: {one_line(self.words, 1000)}{which}"


@dataclass
class Faults:
    """The faults that are known so far, by kind; numbers of samples."""

    changed: list[int] = field(default_factory=list)
    unreadable: list[Finding] = field(default_factory=list)
    gone: dict[str, list[int]] = field(default_factory=dict)
    infinite: dict[str, list[int]] = field(default_factory=dict)
    constant: dict[str, list[int]] = field(default_factory=dict)
    equal: list[int] = field(default_factory=list)
    uncoded: list[int] = field(default_factory=list)
    seen: set[bytes] = field(default_factory=set)


def leaks(store: Store, status: Array) -> Iterator[Finding]:
    """Specimens in two splits, and case ids in two splits or twice."""
    try:
        split, specimen, case = store.read("split"), store.read("specimen"), store.read("case_id")
    except StorageError:
        return  # `value_findings` tells which chunk cannot be read
    names = str(store.described["split"].attributes["flag_meanings"]).split()
    computed = np.flatnonzero(status != PENDING)
    unknown = computed[split[computed] >= len(names)]
    if unknown.size:
        yield Finding("damaged", tuple(unknown.tolist()), f"the split is none of {', '.join(names)}; {AGAIN}")
    for what, keys in (("specimen", specimen), ("case", case)):
        own = computed if what == "specimen" else computed[case[computed] != ""]
        _, inverse = np.unique(keys[own], return_inverse=True)
        low, high = np.full(len(own), 10**6), np.full(len(own), -1)
        np.minimum.at(low, inverse, split[own].astype(int))
        np.maximum.at(high, inverse, split[own].astype(int))
        leaking = own[low[inverse] != high[inverse]] if len(own) else own
        if leaking.size:
            yield Finding("leakage", tuple(leaking.tolist()), f"a {what} is in two splits; do not train on this data set")
        if what == "case" and len(own):
            twice = own[np.bincount(inverse)[inverse] > 1]
            if twice.size:
                yield Finding("duplicate", tuple(twice.tolist()), "the same case more than once; leave out all but one")


def value_findings(store: Store, layout: Layout, status: Array) -> list[Finding]:
    """Content that is gone, unreadable or changed, numbers that are not finite, readings that never change, equal samples."""
    found = Faults()
    for read in computed_chunks(store, layout.variables, status):
        for name, reason in read.unreadable.items():
            found.unreadable.append(Finding("damaged", tuple(read.numbers.tolist()), f"{name}: {reason}"))
        for name, lost in read.gone.items():
            found.gone.setdefault(name, []).extend(lost.tolist())
        found.changed += read.changed.tolist()
        if len(read.values) == len(layout.variables):
            _look(read, layout, found, len(store.attributes["codes"]))
    return _as_findings(found)


def _look(read: ChunkRead, layout: Layout, found: Faults, codes: int) -> None:
    """Looks at the samples of a chunk that are done."""
    readings = [variable for variable in layout.variables if variable.role == "reading"]
    found.uncoded += read.numbers[read.values["code"] >= codes].tolist()
    for row in np.flatnonzero(read.values["status"] == DONE).tolist():
        number, sample = int(read.numbers[row]), {name: values[row] for name, values in read.values.items()}
        for variable in readings:
            values = sample[variable.name]
            if not (variable.optional or np.isfinite(values).all()):
                found.infinite.setdefault(variable.name, []).append(number)
            if _may_not_rest(variable) and np.ptp(values) == 0:
                found.constant.setdefault(variable.name, []).append(number)
        key = b"".join(np.ascontiguousarray(sample[variable.name]).tobytes() for variable in readings)
        found.equal += [number] if key in found.seen else []
        found.seen.add(key)


def _may_not_rest(variable: Variable) -> bool:
    return not variable.prescribed and bool(variable.sizes) and int(np.prod(variable.sizes)) > 1


def _as_findings(found: Faults) -> list[Finding]:
    findings = [*found.unreadable]
    findings += [Finding("gone", tuple(numbers), f"{name} is no longer there; {AGAIN}") for name, numbers in found.gone.items()]
    if found.changed:
        findings.append(Finding("checksum", tuple(found.changed), f"the content is not what was written; {AGAIN}"))
    if found.uncoded:
        findings.append(Finding("damaged", tuple(found.uncoded), f"code is no entry of the attribute codes; {AGAIN}"))
    findings += [Finding("not finite", tuple(numbers), f"{name}; leave them out") for name, numbers in found.infinite.items()]
    constant = found.constant.items()
    findings += [
        Finding("constant", tuple(numbers), f"{name} has one value throughout; leave them out") for name, numbers in constant
    ]
    if found.equal:
        findings.append(Finding("duplicate", tuple(found.equal), "the same readings as an earlier sample; leave them out"))
    return findings
