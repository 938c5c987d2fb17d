"""The store of a data set as a sweep fills it: created whole, then block by block, so that a kill leaves whole samples."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tactsim.dataset.store.arrays import CHUNK_SAMPLES, LARGEST_CHUNK, META
from tactsim.dataset.store.blocks import Block
from tactsim.dataset.store.labels import add_label, labels_of, missing_labels
from tactsim.dataset.store.opening import ARRAYS, STORE_SCHEMA, Store, reading
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside.uninterrupted import uninterrupted
from tactsim.storage.building import built_beside
from tactsim.storage.files import naming, room, sync

if TYPE_CHECKING:
    import zarr

CHUNK_BYTES = 2 * 2**20
"""Largest chunk of a variable, about."""
TEXT_BYTES = 64
"""Bytes of a text, about, from which the size of chunks is chosen."""


def create(path: Path, variables: Sequence[Variable], samples: int, attributes: Mapping[str, Any]) -> Store:
    """A new store in which every sample is pending; it is there as a whole or not at all.

    Raises
    ------
    StorageError
        If the place is taken or cannot be written, or a sample is larger than a chunk may be.
    KeyboardInterrupt
        If it is interrupted; nothing is then there.
    """
    import zarr

    per_chunk = chunk_samples(variables, samples)
    described = {**attributes, "schema": STORE_SCHEMA, ARRAYS: [variable.name for variable in variables]}

    def fill(place: Path) -> None:
        group = zarr.open_group(place, mode="w-", zarr_format=3, attributes=described)
        for variable in variables:
            _add(group, variable, samples, per_chunk)
        for name, labels in labels_of(variables).items():
            add_label(group, name, labels)
        consolidate(place)

    with built_beside(path) as place, naming(path):
        uninterrupted(lambda: fill(place))  # zarr goes on writing in a folder that is being removed
    return uninterrupted(lambda: Store.open(path, writing=True))


def set_attributes(store: Store, **attributes: Any) -> None:
    """Changes attributes of a store, in its group and in the gathered metadata.

    Raises
    ------
    StorageError
        If they cannot be written.
    """
    with naming(store.path):
        store.group.attrs.update(attributes)
    consolidate(store.path)


def consolidate(path: Path) -> None:
    """Gathers the metadata in one file, which opens fast and without a word about other files beside the arrays.

    Raises
    ------
    StorageError
        If a description is damaged, or the file cannot be written.
    """
    import zarr

    with naming(path), reading(path), room(path), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata", category=UserWarning)
        warnings.filterwarnings("ignore", message="Object at", category=UserWarning)
        zarr.consolidate_metadata(path, zarr_format=3)
        sync(path / META)
        sync(path)


def resize(store: Store, samples: int, variables: Iterable[Variable]) -> None:
    """Makes room for this many samples in every array, in that of the status last.

    Raises
    ------
    StorageError
        If an array is missing or cannot be written.
    """
    with naming(store.path):
        for variable in sorted(variables, key=lambda variable: variable.name == "status"):
            array = store.array(variable.name)
            if array.shape[0] != samples:
                array.resize((samples, *array.shape[1:]))
                sync(store.path / variable.name / META)


def restore(store: Store, variables: Sequence[Variable], samples: int) -> list[str]:
    """Makes arrays anew that are gone, filled with nothing; returns their names. ``samples`` is their number if all are gone.

    Raises
    ------
    StorageError
        If one cannot be written.
    """
    gone = [variable for variable in variables if variable.name not in store.described]
    present = store.described.get("status") or next(iter(store.described.values()), None)
    length, per_chunk = (samples, chunk_samples(variables, samples)) if present is None else (present.shape[0], present.chunks[0])
    with naming(store.path):
        for variable in gone:
            _add(store.group, variable, length, per_chunk)
            sync(store.path / variable.name / META)
    return [variable.name for variable in gone]


def restore_labels(store: Store, variables: Sequence[Variable]) -> list[str]:
    """Writes the labels along dimensions that a store does not have; returns the names of the dimensions.

    Raises
    ------
    StorageError
        If one cannot be written.
    """
    missing = missing_labels(store, variables)
    with naming(store.path):
        for name, labels in missing.items():
            add_label(store.group, name, labels)
            sync(store.path / name / META)
    return list(missing)


def write(store: Store, block: Block, variables: Sequence[Variable]) -> None:
    """Puts samples into the arrays and down to the disk: all variables, and only then their status.

    Each chunk is replaced as a whole, so that a kill leaves the earlier or the later one.

    Raises
    ------
    StorageError
        If an array is missing or cannot be written.
    """
    others = [variable for variable in variables if variable.name != "status"]
    status = [variable for variable in variables if variable.name == "status"]
    with naming(store.path):
        for part in (others, status):
            places = [place for variable in part for place in _put(store, block, variable)]
            for place in dict.fromkeys(places):
                if place.exists():  # an array without elements, of no inclusions, has no chunks
                    sync(place)


def chunk_samples(variables: Iterable[Variable], samples: int) -> int:
    """Samples in a chunk, the same for every variable: a power of two.

    Raises
    ------
    StorageError
        If one sample is larger than a chunk may be.
    """
    sizes = {v.name: int(np.prod(v.sizes)) * (TEXT_BYTES if v.dtype == "str" else np.dtype(v.dtype).itemsize) for v in variables}
    name, largest = max(sizes.items(), key=lambda item: item[1])
    if largest > LARGEST_CHUNK:
        raise StorageError(
            f"{name} takes {largest} bytes in each sample; allowed: {LARGEST_CHUNK}; store fewer times with sweep.times"
        )
    fitting = max(1, min(CHUNK_SAMPLES, CHUNK_BYTES // max(largest, 1), samples))
    return 1 << (fitting.bit_length() - 1)


def _add(group: zarr.Group, variable: Variable, samples: int, per_chunk: int) -> None:
    group.create_array(
        variable.name,
        shape=(samples, *variable.sizes),
        chunks=(per_chunk, *(max(1, size) for size in variable.sizes)),
        dtype=str if variable.dtype == "str" else variable.dtype,
        fill_value=variable.fill,
        dimension_names=("sample", *variable.dimensions),
        attributes=variable.attributes(),
    )


def _put(store: Store, block: Block, variable: Variable) -> list[Path]:
    """Puts a variable of some samples into its array; the files and folders that this changed."""
    array, folder, changed = store.array(variable.name), store.path / variable.name, []
    numbers, per_chunk = block["sample"], int(array.chunks[0])
    for chunk in np.unique(numbers // per_chunk).tolist():
        inside = numbers // per_chunk == chunk
        begin, end = chunk * per_chunk, min((chunk + 1) * per_chunk, array.shape[0])
        content = store.path / store.described[variable.name].chunk_key(chunk)
        new = [place for place in content.parents[: len(variable.dimensions) + 1] if not place.exists()]
        values = store.files.rows(variable.name, slice(begin, end))
        values[numbers[inside] - begin] = block[variable.name][inside]
        array[begin:end] = values
        changed += [content, *new, content.parents[len(new)], *([folder / META] if content.parents[len(new)] == folder else ())]
    return changed
