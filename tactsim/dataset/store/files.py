"""The files of a store: read whole and bounded, no links, which of them tactsim wrote, and what a killed run left torn.

Zarr reads through ``GuardedFiles``: whoever does, xarray and PyTorch's loaders included, gets an error that names the array and
the chunk.
"""

from __future__ import annotations

import asyncio
import os
import re
import stat
from collections.abc import AsyncIterator, Iterable, Iterator, Mapping
from pathlib import Path
from types import EllipsisType
from typing import Any, Self

import numpy as np
from zarr.core.buffer.core import default_buffer_prototype
from zarr.storage import LocalStore

from tactsim.array import Array
from tactsim.dataset.store.arrays import META, ArrayDescription
from tactsim.dataset.store.blocks import JOURNAL
from tactsim.dataset.store.chunks import decoded, unpacked
from tactsim.errors import StorageError
from tactsim.outside.files import LIMITS, opened
from tactsim.outside.text import one_line
from tactsim.storage.files import naming
from tactsim.storage.own_files import IGNORED, OWN_LIST, OwnFiles

CARD, FIGURES = "README.md", "figures"
SPARE = 20
"""Files that Zarr may open at once: ten chunks and the ends of its event loop, with as many again for what draws and writes."""
DEEPEST = 16
"""Levels of folders; an array has one for each of its dimensions and two more."""
EARLIER = re.compile(rf"{FIGURES}/[a-z]+\.png")
"""Figures in a store that is older than the list of tactsim's files."""
TORN_CHUNK = re.compile(r"(zarr|\d+)\.[0-9a-f]{32}\.partial")
"""A file that Zarr had not renamed yet."""
TORN_FILE = re.compile(r"\.(README\.md|\.tactsim\.json|[a-z_]+\.png)\.\d+\.partial")
"""A card, a list or a figure that had not been renamed yet."""
PACKING_COSTS = 1024
"""Bytes by which a packed chunk may be larger than its content, beside a hundredth of it."""


def walked(folder: Path) -> Iterator[str]:
    """Path in the store of every file, in no order.

    Raises
    ------
    StorageError
        If there is a link, or anything else that is neither a folder nor a regular file.
    """
    waiting = [("", 0)]
    while waiting:
        inside, depth = waiting.pop()
        if depth > DEEPEST:
            raise StorageError(f"{one_line(folder / inside)} is deeper than any folder of a data set; move it away")
        with naming(folder / inside, "read"), os.scandir(folder / inside) as entries:
            for entry in entries:
                name = f"{inside}/{entry.name}" if inside else entry.name
                mode = entry.stat(follow_symlinks=False).st_mode
                if stat.S_ISDIR(mode):
                    waiting.append((name, depth + 1))
                elif stat.S_ISREG(mode):
                    yield name
                else:
                    raise StorageError(
                        f"{one_line(folder / name)} is a link or no regular file; a data set holds none; move it away"
                    )


def refuse_links(folder: Path) -> None:
    """Refuses a store into which a link leads, before anything is written there.

    Raises
    ------
    StorageError
        Naming the first.
    """
    for _ in walked(folder):
        pass


def is_torn(name: str, arrays: Iterable[str]) -> bool:
    """Whether a killed run left this file half written."""
    place, _, last = name.rpartition("/")
    if place in ("", FIGURES) and TORN_FILE.fullmatch(last):
        return True
    return bool(TORN_CHUNK.fullmatch(last)) and (not place or place.partition("/")[0] in set(arrays))


def remove_torn(folder: Path, arrays: Iterable[str]) -> None:
    """Removes what a killed run left half written.

    Raises
    ------
    StorageError
        If one cannot be removed, or a link stands in the folder.
    """
    names = set(arrays)
    for name in [name for name in walked(folder) if is_torn(name, names)]:
        with naming(folder / name, "remove"):
            (folder / name).unlink()


def foreign_files(folder: Path, described: Mapping[str, ArrayDescription], arrays: Iterable[str]) -> list[str]:
    """Files that tactsim does not write there, sorted; ``arrays`` names all those of the store.

    Raises
    ------
    StorageError
        If a link stands in the folder.
    """
    known = {META, OWN_LIST, JOURNAL, CARD, *OwnFiles(folder).sums(), *(f"{name}/{META}" for name in arrays)}
    names, listed = set(arrays), os.path.lexists(folder / OWN_LIST)
    return sorted(
        name
        for name in walked(folder)
        if name not in known
        and name.rpartition("/")[2] not in IGNORED
        and not _is_chunk(name, described, names)
        and not (EARLIER.fullmatch(name) and not listed)
        and not is_torn(name, names)
    )


def _is_chunk(name: str, described: Mapping[str, ArrayDescription], arrays: set[str]) -> bool:
    parts = name.split("/")
    if len(parts) < 3 or parts[0] not in arrays or parts[1] != "c" or not all(part.isdecimal() for part in parts[2:]):
        return False
    if parts[0] not in described:
        return True  # of an array whose description is gone
    array = described[parts[0]]
    return int(parts[2]) * array.chunks[0] < array.shape[0] and name == array.chunk_key(int(parts[2]))


class GuardedFiles(LocalStore):
    """The arrays of ``described`` in a folder and nothing else of what stands there."""

    def __init__(self, root: Path | str, described: Mapping[str, ArrayDescription], *, read_only: bool = True):
        super().__init__(root, read_only=read_only)
        self.described = dict(described)
        self._real = os.path.realpath(root)

    def with_read_only(self, read_only: bool = False) -> Self:
        """The same with other permissions."""
        return type(self)(self.root, self.described, read_only=read_only)

    async def get(self, key: str, prototype: Any = None, byte_range: Any = None) -> Any:
        """The content of a file, None if there is none.

        Raises
        ------
        StorageError
            As ``content``, or if a part of a chunk is asked for.
        """
        return self._buffer(await asyncio.to_thread(self.content, key), prototype, byte_range)

    def get_sync(self, key: str, *, prototype: Any = None, byte_range: Any = None) -> Any:
        """The same for callers that wait.

        Raises
        ------
        StorageError
            As ``get``.
        """
        return self._buffer(self.content(key), prototype, byte_range)

    async def list_dir(self, prefix: str) -> AsyncIterator[str]:
        """Names in a folder; in the uppermost one only those of the arrays."""
        if prefix:
            async for name in super().list_dir(prefix):
                yield name
            return
        for name in (META, *self.described):
            yield name

    def content(self, key: str) -> bytes | None:
        """The bytes of a file of the store, None if there is none.

        Raises
        ------
        StorageError
            If it is reached through a link, is no regular file, is too large, or is no whole chunk.
        """
        array = self.described.get(key.partition("/")[0]) if "/c/" in key else None
        content = self._bytes(key, array)
        if content is not None and array is not None:
            self._unpacked(content, key, array)
        return content

    def rows(self, name: str, rows: slice | Array | EllipsisType) -> Array:
        """Values (n, ...) of a variable of all samples or a slice or mask of them; where a chunk is no file, the fill value.

        Straight from the files: to have Zarr read a small chunk takes ten times as long, most of it in threads that wait.

        Raises
        ------
        StorageError
            If a chunk is reached through a link, is no regular file, is too large, or is no whole chunk.
        """
        array = self.described[name]
        numbers = _numbers(rows, array.shape[0])
        values = np.full((len(numbers), *array.shape[1:]), array.metadata["fill_value"], array.stored_type)
        if not values.size:
            return values
        chunks = numbers // array.chunks[0]
        for part in np.split(np.arange(len(numbers)), np.flatnonzero(np.diff(chunks)) + 1):
            key = array.chunk_key(int(chunks[part[0]]))
            content = self._bytes(key, array)
            if content is not None:
                values[part] = decoded(self._unpacked(content, key, array), array)[numbers[part] % array.chunks[0]]
        return values

    def _bytes(self, key: str, array: ArrayDescription | None) -> bytes | None:
        """The bytes of a chunk, or of a description if there is no array."""
        place = self.root / key
        if not os.path.lexists(place):
            return None
        if os.path.realpath(place) != os.path.join(self._real, *key.split("/")):
            raise StorageError(f"{one_line(place)} is reached through a link; a data set holds none; put a copy in its place")
        if array is None:
            return opened(place, "description", LIMITS["description"]).read()
        return opened(place, "chunk", array.chunk_bytes + array.chunk_bytes // 100 + PACKING_COSTS).read()

    def _unpacked(self, content: bytes, key: str, array: ArrayDescription) -> bytes:
        try:
            return unpacked(content, array)
        except ValueError as fault:
            raise StorageError(
                f"the chunk {one_line(key)} of {one_line(self.root)} is damaged: {fault}; bring back a copy of it, or compute "
                "its samples again with: tactsim sweep CASE --out STORE --resume"
            ) from None

    @staticmethod
    def _buffer(content: bytes | None, prototype: Any, byte_range: Any) -> Any:
        if byte_range is not None:
            raise StorageError("a part of a chunk was asked for, which no array of a data set has")
        return None if content is None else (prototype or default_buffer_prototype()).buffer.from_bytes(content)


def _numbers(rows: slice | Array | EllipsisType, count: int) -> Array:
    """Numbers (n,) of the samples that are asked for."""
    if isinstance(rows, np.ndarray):
        return np.flatnonzero(rows) if rows.dtype == bool else rows
    return np.arange(*(rows if isinstance(rows, slice) else slice(None)).indices(count))
