"""Whether a data set is what its sweep wrote: complete, undamaged, finite, no doubles, splits apart, and nothing else in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.code_identity import code_identity
from tactsim.dataset.sampling.layout import Layout
from tactsim.dataset.sampling.stored import attributes_of, stored_layout
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import DONE, FAILED, PENDING, STATUS, WORDS, differences, earlier_words
from tactsim.dataset.store.blocks import JOURNAL, Journal
from tactsim.dataset.store.files import CARD, foreign_files, is_torn, walked
from tactsim.dataset.store.labels import label_faults, labels_of
from tactsim.dataset.store.opening import ARRAYS, Store
from tactsim.dataset.store.verifying import SHOWN, ChunkRead, computed_chunks, lost_status
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside.text import first_names, one_line
from tactsim.storage.own_files import OWN_LIST, OwnFiles

COPY = "bring back a copy of {name}/zarr.json, or remove it and go on with --resume, which makes it anew"
RESUME = "go on with --resume, which computes them again"
AGAIN = f"{RESUME}, or bring back a copy"
FORM = ("dtype", "shape")
"""What must be right before samples can be read."""
MADE_LATER = ("codes", "versions", "schema", ARRAYS)
"""Attributes that do not follow from the sweep."""
MIRRORED = 2
"""Entries of a dimension that may be mirror images of each other."""


@dataclass(frozen=True)
class Finding:
    """A fault of a data set: its kind, the samples that it concerns, and in words what it is and what to do."""

    kind: str
    samples: tuple[int, ...]
    words: str

    def __str__(self) -> str:
        which = f"; samples {first_names(self.samples, SHOWN)}" if self.samples else ""
        return f"{self.kind}: {one_line(self.words, 1000)}{which}"


@dataclass(frozen=True)
class Checked:
    """Counts by status, the findings, and what could not be verified."""

    counts: dict[str, int]
    findings: tuple[Finding, ...]
    notes: tuple[str, ...] = ()


def check(path: str | Path) -> Checked:
    """Reads every sample once.

    Raises
    ------
    StorageError
        If the folder is not a data set, its description is damaged, or a link leads into it.
    """
    store = Store.open(path, damaged=True)
    store.array("status")
    sweep, layout = stored_layout(store)
    same_code = store.attributes["codes"][-1] == code_identity()
    findings = [*_arrays(store, layout.variables, sweep.samples), *_wording(store, layout.variables, sweep, same_code)]
    findings += [*_attributes(store, sweep, layout), *_consolidated(store), *_files(store, layout.variables)]
    findings += [Finding("description", (), words) for words in label_faults(store, layout.variables)]
    notes = tuple(_notes(store, same_code, layout.variables, sweep))
    if any(finding.kind in ("missing", "form") for finding in findings):
        return Checked({}, tuple(findings), notes)
    try:
        status = store.read("status")
    except StorageError as error:
        return Checked({}, (*findings, Finding("damaged", (), f"{error}")), notes)
    counts = {name: int((status == number).sum()) for number, name in enumerate(STATUS)}
    findings += [*_missing(store, status), *leaks(store, status), *value_findings(store, layout, status)]
    return Checked(counts, tuple(findings), notes)


def _arrays(store: Store, variables: Iterable[Variable], samples: int) -> Iterator[Finding]:
    """Arrays that are gone, cannot be read, or have other types, shapes or units than the sweep writes."""
    names = {variable.name for variable in variables}
    never = store.never_stored(variable.name for variable in variables)
    if never:
        yield Finding("form", (), earlier_words(never))
    for name in sorted(store.faults.keys() & names):
        yield Finding("form", (), f"{store.faults[name]}; or remove it and go on with --resume, which makes it anew")
    for variable in variables:
        if variable.name in store.faults or variable.name in never:
            continue
        if variable.name not in store.described:
            yield Finding("missing", (), f"the variable {variable.name}; {AGAIN}")
            continue
        array = store.described[variable.name]
        if array.shape[0] != samples:
            words = f"{variable.name} has {array.shape[0]} of {samples} samples; go on with --resume --samples {samples}"
            yield Finding("missing", (), words)
        for key, words in differences(array, variable):
            if key not in WORDS:
                kind = "form" if key in FORM else "description"
                yield Finding(kind, (), f"{variable.name}: {words}; {COPY.format(name=variable.name)}")


def _wording(store: Store, variables: Iterable[Variable], sweep: Sweep, same_code: bool) -> Iterator[Finding]:
    """Attributes in words that are not what this code says, where the store is of this code; meanings of numbers in any case."""
    for variable in variables:
        if variable.name not in store.described:
            continue
        for key, words in differences(store.described[variable.name], variable):
            if key == "flag_meanings" or (key in WORDS and same_code):
                yield Finding("description", (), f"{variable.name}: {words}; {COPY.format(name=variable.name)}")


def _attributes(store: Store, sweep: Sweep, layout: Layout) -> Iterator[Finding]:
    """Attributes of the store that do not follow from its sweep."""
    expected, written = attributes_of(sweep, layout), store.attributes
    same_code = written["codes"][-1] == code_identity()
    for name in sorted((expected.keys() | written.keys()) - set(MADE_LATER)):
        if name == "description" and not same_code:
            continue
        if written.get(name) != expected.get(name):
            words = f"{name} is {one_line(written.get(name), 120)!r}; expected: {one_line(expected.get(name), 120)!r}"
            yield Finding("attribute", (), f"{words}; bring back a copy of zarr.json")
    names = {variable.name for variable in layout.variables}
    if store.keeps_all_chunks and sorted(written[ARRAYS]) != sorted(names.difference(store.never_stored(names))):
        yield Finding("attribute", (), f"{ARRAYS} does not name the arrays of the sweep; bring back a copy of zarr.json")


def _consolidated(store: Store) -> Iterator[Finding]:
    """Arrays that the zarr.json of the store describes wrongly."""
    if differing := store.ungathered:
        named = ", ".join(differing[:SHOWN])
        words = (
            f"the zarr.json of the store describes {named} otherwise than their own; go on with --resume, which gathers them anew"
        )
        yield Finding("gathered", (), words)


def _files(store: Store, variables: Iterable[Variable]) -> Iterator[Finding]:
    """Files that tactsim did not write, that a killed run left, or that are no longer as tactsim wrote them."""
    variables = list(variables)
    names = [*(variable.name for variable in variables), *labels_of(variables)]
    torn = sum(is_torn(name, names) for name in walked(store.path))
    if torn:
        yield Finding(
            "unfinished", (), f"{torn} files half written, by a sweep that is running or was killed; --resume removes them"
        )
    foreign = foreign_files(store.path, store.described, names)
    if foreign:
        shown = first_names([one_line(name, 80) for name in foreign], SHOWN)
        yield Finding("foreign", (), f"{shown}: not written by tactsim; keep them elsewhere")
    files = OwnFiles(store.path)
    for name in sorted(files.sums()):
        if files.written(name) is None:
            state = "is not what tactsim wrote" if (store.path / name).exists() else "is gone"
            yield Finding("file", (), f"{one_line(name, 80)} {state}; move away what stands there, --resume writes it anew")


def _missing(store: Store, status: Array) -> Iterator[Finding]:
    pending, lost, waiting = np.flatnonzero(status == PENDING), lost_status(store), np.arange(0)
    try:
        numbers = Journal(store.path / JOURNAL).waiting(len(status))
        waiting = numbers[status[numbers] == PENDING]
    except StorageError as error:
        yield Finding("damaged", (), f"{error}")
    if lost.size:
        yield Finding("missing", tuple(lost.tolist()), f"the status of {lost.size} samples that were computed is gone; {RESUME}")
    elif pending.size:
        part = f"{pending.size} samples are not in the arrays, {waiting.size} of them computed and in the journal"
        words = part if waiting.size else f"{pending.size} samples are not computed"
        yield Finding("missing", tuple(pending.tolist()), f"{words}; go on with --resume")
    if (store.path / JOURNAL).exists():
        yield Finding("unfinished", (), "samples wait in the journal; a sweep is running, or was killed: --resume")
    unknown = np.flatnonzero(status > FAILED)
    if unknown.size:
        yield Finding("damaged", tuple(unknown.tolist()), f"the status is unknown; {RESUME}")


def _notes(store: Store, same_code: bool, variables: Iterable[Variable], sweep: Sweep) -> Iterator[str]:
    """What cannot be verified."""
    if not store.keeps_all_chunks:
        yield "the store is of an earlier tactsim, which left out chunks of nothing but fill values; checksums stand for them"
    if not (store.path / OWN_LIST).exists() and (store.path / CARD).exists():
        yield f"{CARD} and figures cannot be verified: an earlier tactsim kept no checksums of them"
    if same_code:
        return
    for variable in variables:
        if variable.name in store.described:
            for key, words in differences(store.described[variable.name], variable):
                if key == "long_name":
                    yield f"{variable.name}: {words}; perhaps because the store is of other code"


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
    seen: dict[str, str] = field(default_factory=dict)
    """Digest of the readings -> case that had them first."""


def leaks(store: Store, status: Array) -> Iterator[Finding]:
    """Specimens in two splits, and case ids in two splits or twice, by the status (samples,)."""
    try:
        split, specimen, case = store.read("split"), store.read("specimen"), store.read("case_id")
    except StorageError:
        return  # `value_findings` names the chunk that cannot be read
    names = str(store.described["split"].attributes["flag_meanings"]).split()
    computed = np.flatnonzero(status != PENDING)
    unknown = computed[split[computed] >= len(names)]
    if unknown.size:
        yield Finding("damaged", tuple(unknown.tolist()), f"the split is none of {', '.join(names)}; {AGAIN}")
    for what, keys in (("specimen", specimen), ("case", case)):
        kept = computed if what == "specimen" else computed[case[computed] != ""]
        _, inverse = np.unique(keys[kept], return_inverse=True)
        low, high = np.full(len(kept), 10**6), np.full(len(kept), -1)
        np.minimum.at(low, inverse, split[kept].astype(int))
        np.maximum.at(high, inverse, split[kept].astype(int))
        leaking = kept[low[inverse] != high[inverse]] if len(kept) else kept
        if leaking.size:
            yield Finding("leakage", tuple(leaking.tolist()), f"a {what} is in two splits; do not train on this data set")
        if what == "case" and len(kept):
            twice = kept[np.bincount(inverse)[inverse] > 1]
            if twice.size:
                yield Finding("duplicate", tuple(twice.tolist()), "the same case more than once; leave out all but one")


def value_findings(store: Store, layout: Layout, status: Array) -> list[Finding]:
    """Content that is gone, unreadable or changed, numbers that are not finite, readings that never change, equal samples; of
    those that the status (samples,) says are computed."""
    faults = Faults()
    for read in computed_chunks(store, layout.variables, status):
        for name, reason in read.unreadable.items():
            faults.unreadable.append(Finding("damaged", tuple(read.numbers.tolist()), f"{name}: {reason}"))
        for name, lost in read.gone.items():
            faults.gone.setdefault(name, []).extend(lost.tolist())
        faults.changed += read.changed.tolist()
        if len(read.values) == len(layout.variables):
            _look(read, layout, faults, len(store.attributes["codes"]))
    return _as_findings(faults)


def _look(read: ChunkRead, layout: Layout, faults: Faults, codes: int) -> None:
    """Looks at the samples of a chunk that are done."""
    readings = [variable for variable in layout.variables if variable.role == "reading"]
    faults.uncoded += read.numbers[read.values["code"] >= codes].tolist()
    for row in np.flatnonzero(read.values["status"] == DONE).tolist():
        number, sample = int(read.numbers[row]), {name: values[row] for name, values in read.values.items()}
        for variable in readings:
            values = sample[variable.name]
            if not (variable.optional or np.isfinite(values).all()):
                faults.infinite.setdefault(variable.name, []).append(number)
            if _may_not_rest(variable) and np.ptp(values) == 0:
                faults.constant.setdefault(variable.name, []).append(number)
        key = sha256(b"".join(np.ascontiguousarray(sample[variable.name]).tobytes() for variable in readings)).hexdigest()
        case = str(sample.get("case_id", number))
        faults.equal += [number] if faults.seen.setdefault(key, case) != case else []  # `leaks` reports those of one case


def _may_not_rest(variable: Variable) -> bool:
    """Whether a sample in which all its entries are equal is at fault: mirror images are equal, of two jaws, rows or columns."""
    dimensions = zip(variable.dimensions, variable.sizes, strict=True)
    return not variable.prescribed and any(size > (1 if name == "time" else MIRRORED) for name, size in dimensions)


def _as_findings(faults: Faults) -> list[Finding]:
    findings = [*faults.unreadable]
    findings += [Finding("gone", tuple(numbers), f"{name} is no longer there; {AGAIN}") for name, numbers in faults.gone.items()]
    if faults.changed:
        findings.append(Finding("checksum", tuple(faults.changed), f"the content is not what was written; {AGAIN}"))
    if faults.uncoded:
        findings.append(Finding("damaged", tuple(faults.uncoded), f"code is no entry of the attribute codes; {AGAIN}"))
    findings += [Finding("not finite", tuple(numbers), f"{name}; leave them out") for name, numbers in faults.infinite.items()]
    constant = faults.constant.items()
    findings += [
        Finding("constant", tuple(numbers), f"{name} has one value throughout; leave them out") for name, numbers in constant
    ]
    if faults.equal:
        findings.append(Finding("duplicate", tuple(faults.equal), "the same readings as an earlier sample; leave them out"))
    return findings
