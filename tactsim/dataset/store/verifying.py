"""Samples whose content is gone or not what was written: detected by files and checksums, marked to be computed again."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.store.arrays import DONE, FAILED, META, PENDING
from tactsim.dataset.store.blocks import JOURNAL, NOT_SUMMED, checksum
from tactsim.dataset.store.opening import Store, consolidated_metadata
from tactsim.errors import StorageError, shown
from tactsim.interfaces.variable import Variable
from tactsim.outside.text import first_names, one_line
from tactsim.storage.files import naming

CHANGED = "the content is not what was written"
UNKNOWN = "the status is unknown"
REMEDY = "bring back a copy, or compute them again with: tactsim sweep CASE --out STORE --resume"
SHOWN = 10
"""Samples and variables named in one message."""
MARKED = "code"
"""Variable that is 0 for every sample of the code that began the store; earlier stores kept no file for it."""


@dataclass
class ChunkRead:
    """The samples of one chunk that were computed."""

    number: int
    numbers: Array
    """Of its computed samples, (n,)."""
    values: dict[str, Array]
    """Variable -> values (n, ...) of these, of those variables that can be read."""
    unreadable: dict[str, str] = field(default_factory=dict)
    """Variable -> why its chunk cannot be read."""
    gone: dict[str, Array] = field(default_factory=dict)
    """Variable -> samples (m,) whose values are gone."""
    changed: Array = field(default_factory=lambda: np.arange(0))
    """Samples (m,) whose checksum is not that of their content."""


def computed_chunks(store: Store, variables: Sequence[Variable], status: Array) -> Iterator[ChunkRead]:
    """Every chunk with a sample that was computed, by its status (samples,), read and held against the checksums."""
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
    """Why samples must be computed again -> their numbers (n,); chunks that cannot be read are removed, so that others take their
    place.

    Raises
    ------
    StorageError
        If a chunk cannot be removed.
    """
    damage: dict[str, list[Array]] = {}
    status = _readable_status(store, damage)
    _remove_unreadable(store, variables, status)
    for read in computed_chunks(store, variables, status):
        for name, reason in read.unreadable.items():
            damage.setdefault(f"{name} cannot be read", []).append(read.numbers)
            _remove_chunk(store, name, read.number, reason)
        for name, lost in read.gone.items():
            damage.setdefault(f"{name} is gone", []).append(lost)
        if read.changed.size:
            damage.setdefault(CHANGED, []).append(read.changed)
    unknown = np.flatnonzero(status > FAILED)
    if unknown.size:
        damage.setdefault(UNKNOWN, []).append(unknown)
    return {reason: np.unique(np.concatenate(parts)) for reason, parts in damage.items()}


def mark_pending(store: Store, samples: Array) -> None:
    """Says of samples (m,) that they are not computed.

    Raises
    ------
    StorageError
        If the status cannot be read or written.
    """
    status = store.array("status")
    per_chunk = int(status.chunks[0])
    with naming(store.path):
        for chunk in np.unique(samples // per_chunk).tolist():
            rows = slice(chunk * per_chunk, min((chunk + 1) * per_chunk, status.shape[0]))
            values = np.asarray(status[rows])
            values[samples[samples // per_chunk == chunk] - rows.start] = PENDING
            status[rows] = values


def _readable_status(store: Store, damage: dict[str, list[Array]]) -> Array:
    """The status of all samples; of chunks that cannot be read all are pending."""
    per_chunk, samples = store.described["status"].chunks[0], store.samples
    status = np.full(samples, PENDING, np.uint8)
    for number, begin in enumerate(range(0, samples, per_chunk)):
        rows = slice(begin, min(begin + per_chunk, samples))
        try:
            status[rows] = store.read("status", rows)
        except StorageError as error:
            damage.setdefault("status cannot be read", []).append(np.arange(rows.start, rows.stop))
            _remove_chunk(store, "status", number, str(error))
    return status


def _remove_unreadable(store: Store, variables: Sequence[Variable], status: Array) -> None:
    """Removes chunks that cannot be read and hold no computed sample by the status (samples,): a machine that lost its power
    left them half written, and the journal still has what they should hold."""
    per_chunk = store.described["status"].chunks[0]
    chunk = np.arange(len(status)) // per_chunk
    for number in np.setdiff1d(chunk, chunk[status != PENDING]).tolist():
        for variable in variables:
            try:
                store.read(variable.name, slice(number * per_chunk, (number + 1) * per_chunk))
            except StorageError as error:
                _remove_chunk(store, variable.name, number, str(error))


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


def refuse_holes(store: Store, names: Iterable[str], samples: Array) -> None:
    """Refuses to read variables of samples (m,) whose content is gone; looks for the files only.

    Raises
    ------
    StorageError
        Naming the variables and the samples.
    """
    holed: dict[str, Array] = {}
    for name in sorted({*names, "status"}):  # folders are listed in any order; a message is the same on every machine
        lost = lost_samples(store, name, samples) if name != "status" else lost_status(store)
        if lost.size or name not in store.described:
            holed[name] = lost
    if holed:
        numbers = np.unique(np.concatenate(list(holed.values())))
        raise StorageError(
            f"{one_line(store.path)} has holes: {first_names(list(holed), SHOWN)} of {samples_in_words(numbers)} "
            f"are gone; {REMEDY}"
        )


def refuse_redescribed(store: Store) -> None:
    """Refuses arrays whose units, type or anything else but the number of samples are no longer those that the store gathered
    when it was made.

    Raises
    ------
    StorageError
        Naming the array and what differs.
    """
    gathered = consolidated_metadata(store.path)
    for name, array in store.described.items():
        now, made = _lasting(array.metadata), _lasting(gathered.get(name, array.metadata))
        if now != made:
            key = next(key for key in (*now, *made) if key not in now or key not in made or now[key] != made[key])
            here, there = (shown(one[key]) if key in one else "missing" for one in (now, made))
            words = f"{one_line(key, 80)} is {here}, but {there} in the {META} of the store"
            raise StorageError(
                f"{one_line(store.path / name / META)}: {words}; tactsim data check says which is right; bring back a copy, or "
                "remove the wrong file of an array and go on with --resume"
            )


def _lasting(metadata: Any) -> dict[str, Any]:
    """The attributes of an array and the rest of its description, without its shape, which grows with the samples."""
    if not isinstance(metadata, dict):
        return {}
    attributes = metadata.get("attributes")
    rest = {key: value for key, value in metadata.items() if key not in ("attributes", "shape")}
    return (attributes if isinstance(attributes, dict) else {}) | rest


def refuse_changed(store: Store, samples: Array) -> None:
    """Refuses samples (m,) whose content is not what was written, by their checksums; reads all of their variables.

    Raises
    ------
    StorageError
        Naming the samples, or the chunk that cannot be read.
    """
    wanted = np.full(store.samples, PENDING, np.uint8)
    wanted[samples] = DONE
    changed = []
    for read in computed_chunks(store, list(stored_variables(store)), wanted):
        if read.unreadable:
            raise StorageError(next(iter(read.unreadable.values())))
        changed += read.changed.tolist()
    if changed:
        raise StorageError(
            f"{one_line(store.path)} is damaged: the content of {samples_in_words(np.array(changed))} is not what was "
            f"written; {REMEDY}"
        )


def samples_in_words(numbers: Array) -> str:
    """Samples (m,) in words: how many, and the first of them."""
    return f"{len(numbers)} samples ({first_names(numbers.tolist(), SHOWN)})"


def lost_samples(store: Store, name: str, samples: Array) -> Array:
    """Those of the computed ``samples`` (n,) whose value of a variable is gone."""
    if name not in store.described:
        return samples
    array = store.described[name]
    if 0 in array.shape[1:]:
        return samples[:0]
    chunks = samples // array.chunks[0]
    gone = [chunk for chunk in np.unique(chunks).tolist() if not os.path.lexists(store.path / array.chunk_key(chunk))]
    if not store.keeps_all_chunks:
        gone = [chunk for chunk in gone if not _was_left_out(store, name, int(samples[chunks == chunk][0]))]
    return samples[np.isin(chunks, gone)]


def lost_status(store: Store) -> Array:
    """Samples (m,) whose checksums are there while their status is gone, unless a run is about to write it."""
    if "checksum" not in store.described or os.path.lexists(store.path / JOURNAL):
        return np.arange(0)
    status, sums = store.described["status"], store.described["checksum"]
    per_chunk = status.chunks[0]
    gone = [
        chunk
        for chunk in range(-(-status.shape[0] // per_chunk))
        if os.path.lexists(store.path / sums.chunk_key(chunk)) and not os.path.lexists(store.path / status.chunk_key(chunk))
    ]
    numbers = np.arange(status.shape[0])
    return numbers[np.isin(numbers // per_chunk, gone)]


def stored_variables(store: Store) -> Iterator[Variable]:
    """The variables of a store as far as checksums need them."""
    for name, array in store.described.items():
        about = array.attributes
        yield Variable(name, about["units"], "", about["role"], sizes=array.shape[1:], dtype=array.dtype)


def _was_left_out(store: Store, name: str, sample: int) -> bool:
    """Whether a chunk of an earlier store is no file because all of it is the fill value: the checksum of one sample decides."""
    if name == MARKED:
        return True
    if name in NOT_SUMMED:
        return False
    variables, rows = list(stored_variables(store)), slice(sample, sample + 1)
    try:
        values = {variable.name: store.read(variable.name, rows)[0] for variable in variables}
    except StorageError:
        return True  # the chunk that cannot be read is named by whoever reads it
    return bool(store.missing) or bool((checksum(values, variables) == values["checksum"]).all())
