"""Samples whose content is gone: arrays and chunks that are no file although the status says that they were written."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator

import numpy as np

from tactsim.dataset.block import NOT_SUMMED, checksum
from tactsim.dataset.store import Store
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside.text import one_line

Array = np.ndarray
SHOWN = 10
"""Samples and variables named in one message."""
MARKED = "code"
"""Variable that is 0 for every sample of the code that began the store; earlier stores kept no file for it."""
JOURNAL = ".journal"
"""File in a store with blocks that are computed but not yet in its arrays."""


def refuse_holes(store: Store, names: Iterable[str], samples: Array) -> None:
    """Refuses to read variables of samples whose content is gone; looks for the files only.

    Raises
    ------
    StorageError
        Naming the variables and the samples.
    """
    holed: dict[str, Array] = {}
    for name in (*names, "status"):
        lost = lost_samples(store, name, samples) if name != "status" else lost_status(store)
        if lost.size or name not in store.described:
            holed[name] = lost
    if holed:
        numbers = np.unique(np.concatenate(list(holed.values())))
        more = f" and {len(holed) - SHOWN} more" if len(holed) > SHOWN else ""
        raise StorageError(
            f"{one_line(store.path)} has holes: {', '.join(list(holed)[:SHOWN])}{more} of {told(numbers)} are gone; bring back a "
            "copy, or compute them again with: tactsim sweep CASE --out STORE --resume"
        )


def told(numbers: Array) -> str:
    """Samples in words: how many, and the first of them."""
    more = f" and {len(numbers) - SHOWN} more" if len(numbers) > SHOWN else ""
    return f"{len(numbers)} samples ({', '.join(map(str, numbers[:SHOWN].tolist()))}{more})"


def lost_samples(store: Store, name: str, samples: Array) -> Array:
    """Those of these computed samples whose value of a variable is gone."""
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
    """Samples whose checksums are there while their status is gone, unless a run is about to write it."""
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
        yield Variable(name, array.attributes["units"], "", "index", sizes=array.shape[1:], dtype=array.dtype)


def _was_left_out(store: Store, name: str, sample: int) -> bool:
    """Whether a chunk of an earlier store is no file because all of it is the fill value: the checksum of one sample tells."""
    if name == MARKED:
        return True
    if name in NOT_SUMMED:
        return False
    variables, rows = list(stored_variables(store)), slice(sample, sample + 1)
    try:
        values = {variable.name: store.read(variable.name, rows)[0] for variable in variables}
    except StorageError:
        return True  # the chunk that cannot be read is told by whoever reads it
    return bool(store.missing) or bool((checksum(values, variables) == values["checksum"]).all())
