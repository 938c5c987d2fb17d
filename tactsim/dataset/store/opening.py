"""The Zarr store of a data set as it is read: opened, checked against limits, and each array whole or refused by name.

A Zarr group (format 3) with one array per variable; the first dimension is the sample. ``store.writing`` creates and fills it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import EllipsisType
from typing import TYPE_CHECKING, Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.store.arrays import META, PENDING, ArrayDescription, described, index_fault, read_json, refuse_link
from tactsim.errors import OutOfMemory, StorageError
from tactsim.outside.extras import extras_named
from tactsim.outside.files import Unreadable, opened_folder
from tactsim.outside.text import one_line
from tactsim.results.folder import RESULT_FILE
from tactsim.storage.files import refuse_few_descriptors

if TYPE_CHECKING:
    import zarr

    from tactsim.dataset.store.files import GuardedFiles

STORE_SCHEMA = "tactsim/dataset/1"
KINDS = {
    "title": str,
    "description": str,
    "license": str,
    "sweep": str,
    "sweep_id": str,
    "samples_per_specimen": int,
    "seed": int,
    "codes": list,
    "versions": dict,
    "limits": str,
}
"""Attributes without which a store is no data set, and their types."""
ARRAYS = "arrays"
"""Attribute: names of all arrays. A store that has it holds a file for every chunk with a sample that was computed, so that a
missing one is a loss; earlier stores left out chunks of nothing but the fill value."""
NAME = re.compile(r"\w[\w.-]{0,254}")
"""Names of variables, which are names of folders."""
DAMAGE = (OSError, ValueError, LookupError, TypeError, AttributeError, RuntimeError, ArithmeticError)
"""What Zarr and its codecs raise on content that they cannot read."""


@dataclass(frozen=True)
class Store:
    """A store, opened. A reader sees a sample by its ``status``, which is written after everything else of it."""

    path: Path
    files: GuardedFiles
    group: zarr.Group
    described: dict[str, ArrayDescription] = field(default_factory=dict)
    """Arrays that are there and can be read."""
    faults: dict[str, str] = field(default_factory=dict)
    """Arrays that cannot be read, and why."""
    _opened: dict[str, zarr.Array[Any]] = field(default_factory=dict, repr=False, compare=False)
    """Arrays that were asked for: to open one costs as much as to read it."""

    @classmethod
    def open(cls, path: str | Path, *, writing: bool = False, damaged: bool = False) -> Store:
        """A store that a sweep wrote; ``damaged`` allows arrays that cannot be read.

        Raises
        ------
        InputError
            If zarr is not installed.
        StorageError
            If there is none, it is damaged, or it is of another version.
        """
        with extras_named():
            import zarr

            from tactsim.dataset.store.files import SPARE, GuardedFiles

        folder = _folder(path)
        refuse_few_descriptors(folder, SPARE)
        readable, faults = _arrays(folder, read_attributes(folder))
        if not damaged and faults:
            raise StorageError(next(iter(faults.values())))
        if "status" not in readable and not damaged:
            raise StorageError(_without(folder, "status"))
        files = GuardedFiles(folder, readable, read_only=not writing)
        with reading(folder), zarr.config.set({"array.write_empty_chunks": True}):
            group = zarr.open_group(files, mode="r+" if writing else "r", zarr_format=3, use_consolidated=False)
        return cls(folder, files, group, readable, faults)

    @property
    def attributes(self) -> dict[str, Any]:
        """The attributes of the store."""
        return dict(self.group.attrs)

    def array(self, name: str) -> zarr.Array[Any]:
        """The array (samples, ...) of a variable.

        Raises
        ------
        StorageError
            If it is missing or its description is damaged.
        """
        import zarr

        self._refuse_missing(name)
        if name in self._opened:
            return self._opened[name]
        with reading(self.path / name), zarr.config.set({"array.write_empty_chunks": True}):
            array = self.group[name]
            if not isinstance(array, zarr.Array):
                raise TypeError("it is no array")
            self._opened[name] = array
            return array

    def read(self, name: str, rows: slice | Array | EllipsisType = ...) -> Array:
        """Values (samples, ...) of a variable, of all samples or a slice or mask of them.

        Raises
        ------
        StorageError
            Naming the array and the chunk that cannot be read.
        """
        self._refuse_missing(name)
        with reading(self.path / name):
            values = self.files.rows(name, rows)
        return values if values.dtype.kind in "fiub" else np.array([str(value) for value in values])

    def _refuse_missing(self, name: str) -> None:
        if name not in self.described:
            raise StorageError(self.faults.get(name) or _without(self.path, name))

    @property
    def missing(self) -> list[str]:
        """Names of arrays that the store had and that are gone; raises as `consolidated_metadata` does."""
        names = self.attributes.get(ARRAYS, sorted(consolidated_metadata(self.path)))
        return [name for name in names if name not in self.described]

    @property
    def ungathered(self) -> list[str]:
        """Names of arrays that zarr.json, which xarray reads, describes otherwise than their own; raises as `missing` does."""
        gathered = consolidated_metadata(self.path)
        return [name for name, array in self.described.items() if gathered.get(name) != array.metadata]

    def never_stored(self, names: Iterable[str]) -> list[str]:
        """Those of the names of arrays that the store never had, because an earlier version of tactsim began it."""
        known = {*self.described, *self.faults, *self.missing}
        return [name for name in names if name not in known] if self.attributes.get(ARRAYS) else []

    @property
    def samples(self) -> int:
        """Number of samples, computed or not."""
        return self.described["status"].shape[0]

    @property
    def keeps_all_chunks(self) -> bool:
        """Whether a chunk that is no file can only be one whose samples are pending."""
        return ARRAYS in self.attributes

    def pending(self) -> Array:
        """Numbers (n,) of the samples that are not computed.

        Raises
        ------
        StorageError
            If the status cannot be read.
        """
        return np.flatnonzero(self.read("status") == PENDING)


@contextmanager
def reading(place: Path) -> Iterator[None]:
    """Turns whatever Zarr raises on damaged content into an error that names the place.

    Raises
    ------
    StorageError, OutOfMemory
        If the block meets damaged content, or the memory does not suffice for it.
    """
    try:
        yield
    except StorageError:
        raise
    except MemoryError as error:
        raise OutOfMemory(f"the memory does not suffice to read {one_line(place)}; read fewer variables or samples") from error
    except DAMAGE as error:
        raise StorageError(
            f"{one_line(place)} is damaged or cannot be read: {type(error).__name__}: {one_line(error, 200)}; bring back a copy"
        ) from error


def read_attributes(folder: Path) -> dict[str, Any]:
    """What a folder says of itself, if it is a data set that this version reads.

    Raises
    ------
    StorageError
        If it is none, is damaged, or is of another version.
    """
    metadata = _group(folder)
    attributes = metadata.get("attributes", {})
    schema = attributes.get("schema") if isinstance(attributes, dict) else None
    if schema is None or metadata.get("node_type") != "group":
        raise StorageError(
            f"{one_line(folder)} is not a data set of tactsim: it is Zarr of another origin, without the schema {STORE_SCHEMA!r}"
        )
    codes = attributes.get("codes")
    if schema != STORE_SCHEMA:
        wrote = one_line(codes[-1] if isinstance(codes, list) and codes else "unknown", 80)
        raise StorageError(
            f"{one_line(folder)} has the schema {one_line(repr(schema), 80)}; this tactsim reads {STORE_SCHEMA!r}; use the "
            f"version that wrote it: {wrote}"
        )
    if missing := [name for name in KINDS if name not in attributes]:
        raise StorageError(f"{one_line(folder)} is damaged: {META} does not state {', '.join(missing)}; bring back a copy")
    for name, kind in KINDS.items():
        if not isinstance(attributes[name], kind):
            raise StorageError(f"{one_line(folder)} is damaged: {name} in {META} is no {kind.__name__}; bring back a copy")
    names = attributes.get(ARRAYS, [])
    if not codes or not all(isinstance(code, str) for code in codes):
        raise StorageError(f"{one_line(folder)} is damaged: codes in {META} are no texts; bring back a copy")
    if not isinstance(names, list) or not all(isinstance(name, str) and NAME.fullmatch(name) for name in names):
        raise StorageError(f"{one_line(folder)} is damaged: {ARRAYS} in {META} are no names of arrays; bring back a copy")
    return attributes


def _without(folder: Path, name: str) -> str:
    remedy = "bring back a copy, or make it anew with: tactsim sweep CASE --out STORE --resume"
    return f"{one_line(folder)} is damaged: it has no variable {one_line(name)}; {remedy}"


def _folder(path: str | Path) -> Path:
    try:
        return opened_folder(path, "data set")[0]
    except Unreadable as error:
        if not os.path.lexists(path):
            raise StorageError(f"no such folder: {one_line(path)}; name one that tactsim sweep wrote") from error
        raise StorageError(f"{one_line(path)} is not a data set of tactsim: {error.reason}") from error


def _group(folder: Path) -> dict[str, Any]:
    if not os.path.lexists(folder / META):
        older = "; it is of Zarr format 2, tactsim writes format 3" if (folder / ".zgroup").exists() else ""
        result = "; it is the result of a run, which tactsim show shows" if (folder / RESULT_FILE).is_file() else ""
        raise StorageError(f"{one_line(folder)} is not a data set of tactsim: it holds no {META}{older}{result}")
    try:
        metadata = read_json(folder / META)
    except StorageError as error:
        raise StorageError(f"{one_line(folder)} cannot be opened: {META} is damaged: {error}") from None
    if not isinstance(metadata, dict):
        raise StorageError(f"{one_line(folder)} cannot be opened: {META} is damaged: it is no mapping; bring back a copy")
    return metadata


def _arrays(folder: Path, attributes: dict[str, Any]) -> tuple[dict[str, ArrayDescription], dict[str, str]]:
    """Arrays that can be read, in the order of their names, and why others cannot; what else is in the folder is passed over."""
    declared = attributes[ARRAYS] if ARRAYS in attributes else consolidated_metadata(folder)
    readable: dict[str, ArrayDescription] = {}
    faults: dict[str, str] = {}
    for name in sorted(set(declared) or _with_description(folder)):
        if not os.path.lexists(folder / name / META):
            continue
        try:
            readable[name] = described(folder, name)
        except StorageError as error:
            faults[name] = str(error)
    if (status := readable.get("status")) is not None:  # which may be found to be at fault itself
        for name in sorted(readable):
            if fault := index_fault(readable[name], status.shape[0], status.chunks[0]):
                faults[name] = f"{one_line(folder / name / META)} is damaged: {fault}; bring back a copy of it"
                del readable[name]
    return readable, faults


def consolidated_metadata(folder: Path) -> dict[str, Any]:
    """Name -> description of the arrays as the ``zarr.json`` of the store gathers them.

    Raises
    ------
    StorageError
        If the file is missing or damaged.
    """
    gathered = _group(folder).get("consolidated_metadata")
    metadata = gathered.get("metadata") if isinstance(gathered, dict) else None
    return {name: one for name, one in metadata.items() if NAME.fullmatch(name)} if isinstance(metadata, dict) else {}


def _with_description(folder: Path) -> set[str]:
    """Names of the folders that describe an array, for a store without any word on them."""
    refuse_link(folder / META)
    with os.scandir(folder) as entries:
        names = [entry.name for entry in entries if NAME.fullmatch(entry.name) and entry.is_dir()]
    return {name for name in names if os.path.lexists(folder / name / META)}
