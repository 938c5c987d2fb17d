"""Every computed sample of a store against its checksum, chunk by chunk; what a resumed sweep must compute again."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from tactsim.dataset.block import checksum
from tactsim.dataset.holes import lost_samples, lost_status
from tactsim.dataset.store import Store
from tactsim.dataset.variable import FAILED, PENDING
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside.text import one_line
from tactsim.storage.files import naming

Array = np.ndarray
CHANGED = "the content is not what was written"
UNKNOWN = "the status is unknown"


@dataclass
class ChunkRead:
    """The samples of one chunk that were computed."""

    number: int
    numbers: Array
    """Of its computed samples."""
    values: dict[str, Array]
    """Variable -> values of these, of those variables that can be read."""
    unreadable: dict[str, str] = field(default_factory=dict)
    """Variable -> why its chunk cannot be read."""
    gone: dict[str, Array] = field(default_factory=dict)
    """Variable -> samples whose values are gone."""
    changed: Array = field(default_factory=lambda: np.arange(0))
    """Samples whose checksum is not that of their content."""


def computed_chunks(store: Store, variables: Sequence[Variable], status: Array) -> Iterator[ChunkRead]:
    """Every chunk with a sample that was computed, read and held against the checksums."""
    per_chunk = store.described["status"].chunks[0]
    for number in np.unique(np.flatnonzero(status != PENDING) // per_chunk).tolist():
        begin, end = number * per_chunk, min((number + 1) * per_chunk, len(status))
        numbers = begin + np.flatnonzero(status[begin:end] != PENDING)
        read = ChunkRead(number, numbers, {})
        for variable in variables:
            lost = lost_samples(store, variable.name, numbers)
            if lost.size:
                read.gone[variable.name] = lost
                continue
            try:
                read.values[variable.name] = store.read(variable.name, slice(begin, end))[numbers - begin]
            except StorageError as error:
                read.unreadable[variable.name] = str(error)
        if len(read.values) == len(variables):
            read.changed = _changed(read, variables)
        yield read


def damaged_samples(store: Store, variables: Sequence[Variable]) -> dict[str, Array]:
    """Why samples must be computed again -> their numbers; chunks that cannot be read are removed, so that others take their
    place."""
    found: dict[str, list[Array]] = {}
    status = _readable_status(store, found)
    for read in computed_chunks(store, variables, status):
        for name, reason in read.unreadable.items():
            found.setdefault(f"{name} cannot be read", []).append(read.numbers)
            _remove_chunk(store, name, read.number, reason)
        for name, lost in read.gone.items():
            found.setdefault(f"{name} is gone", []).append(lost)
        if read.changed.size:
            found.setdefault(CHANGED, []).append(read.changed)
    lost = lost_status(store)
    if lost.size:
        found.setdefault("status is gone", []).append(lost)
    unknown = np.flatnonzero(status > FAILED)
    if unknown.size:
        found.setdefault(UNKNOWN, []).append(unknown)
    return {reason: np.unique(np.concatenate(parts)) for reason, parts in found.items()}


def mark_pending(store: Store, samples: Array) -> None:
    """Says of samples that they are not computed."""
    status = store.array("status")
    per_chunk = int(status.chunks[0])
    with naming(store.path):
        for chunk in np.unique(samples // per_chunk).tolist():
            rows = slice(chunk * per_chunk, min((chunk + 1) * per_chunk, status.shape[0]))
            values = status[rows]
            values[samples[samples // per_chunk == chunk] - rows.start] = PENDING
            status[rows] = values


def _readable_status(store: Store, found: dict[str, list[Array]]) -> Array:
    """The status of all samples; of chunks that cannot be read all are pending."""
    per_chunk, samples = store.described["status"].chunks[0], store.samples
    status = np.full(samples, PENDING, np.uint8)
    for number, begin in enumerate(range(0, samples, per_chunk)):
        rows = slice(begin, min(begin + per_chunk, samples))
        try:
            status[rows] = store.read("status", rows)
        except StorageError as error:
            found.setdefault("status cannot be read", []).append(np.arange(rows.start, rows.stop))
            _remove_chunk(store, "status", number, str(error))
    return status


def _changed(read: ChunkRead, variables: Sequence[Variable]) -> Array:
    rows = ({name: values[row] for name, values in read.values.items()} for row in range(len(read.numbers)))
    same = [(checksum(sample, variables) == sample["checksum"]).all() for sample in rows]
    return read.numbers[~np.array(same, bool)]


def _remove_chunk(store: Store, name: str, number: int, reason: str) -> None:
    """Removes a chunk that cannot be read, if it is a file of this store.

    Raises
    ------
    StorageError
        If it is anything else, for the reason for which it cannot be read.
    """
    place = store.path / store.described[name].chunk_key(number)
    if os.path.realpath(place) != os.path.join(os.path.realpath(store.path), *store.described[name].chunk_key(number).split("/")):
        raise StorageError(reason)
    if not place.is_file():
        raise StorageError(f"{one_line(place)}: {reason}")
    with naming(place):
        place.unlink()
