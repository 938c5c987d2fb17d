"""The files of a store: read whole and bounded, no links, which of them tactsim wrote, and what a killed run left torn.

Zarr reads through ``GuardedFiles``: whoever does, xarray and PyTorch's loaders included, gets an error that names the array and
the chunk.
"""

from __future__ import annotations

import asyncio
import os
import re
import stat
import struct
from collections.abc import AsyncIterator, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Self

import numpy as np
from zarr.core.buffer.core import default_buffer_prototype
from zarr.storage import LocalStore

from tactsim.dataset.store.arrays import META, ArrayDescription
from tactsim.dataset.store.blocks import JOURNAL
from tactsim.errors import StorageError
from tactsim.outside.files import LIMITS, opened
from tactsim.outside.text import one_line
from tactsim.storage.files import naming
from tactsim.storage.own_files import IGNORED, OWN_LIST, OwnFiles

CARD, FIGURES = "README.md", "figures"
DEEPEST = 16
"""Levels of folders; an array has one for each of its dimensions and two more."""
EARLIER = re.compile(rf"{FIGURES}/[a-z]+\.png")
"""Figures in a store that is older than the list of tactsim's files."""
TORN_CHUNK = re.compile(r"(zarr|\d+)\.[0-9a-f]{32}\.partial")
"""A file that Zarr had not renamed yet."""
TORN_FILE = re.compile(r"\.(README\.md|\.tactsim\.json|[a-z_]+\.png)\.\d+\.partial")
"""A card, a list or a figure that had not been renamed yet."""
FRAME = 0xFD2FB528
"""First four bytes of what Zstandard packs, RFC 8878, section 3.1.1."""
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
    chunks = {name: (array, -(-array.shape[0] // array.chunks[0])) for name, array in described.items()}
    names, listed = set(arrays), os.path.lexists(folder / OWN_LIST)
    return sorted(
        name
        for name in walked(folder)
        if name not in known
        and name.rpartition("/")[2] not in IGNORED
        and not _is_chunk(name, chunks, names)
        and not (EARLIER.fullmatch(name) and not listed)
        and not is_torn(name, names)
    )


def _is_chunk(name: str, chunks: Mapping[str, tuple[ArrayDescription, int]], arrays: set[str]) -> bool:
    parts = name.split("/")
    if len(parts) < 3 or parts[0] not in arrays or parts[1] != "c" or not all(part.isdecimal() for part in parts[2:]):
        return False
    if parts[0] not in chunks:
        return True  # of an array whose description is gone
    array, count = chunks[parts[0]]
    return int(parts[2]) < count and name == array.chunk_key(int(parts[2]))


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
        """The content of a file, None if there is none."""
        return self._buffer(await asyncio.to_thread(self.content, key), prototype, byte_range)

    def get_sync(self, key: str, *, prototype: Any = None, byte_range: Any = None) -> Any:
        """The same for callers that wait."""
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
        place = self.root / key
        if not os.path.lexists(place):
            return None
        if os.path.realpath(place) != os.path.join(self._real, *key.split("/")):
            raise StorageError(f"{one_line(place)} is reached through a link; a data set holds none; put a copy in its place")
        array = self.described.get(key.partition("/")[0]) if "/c/" in key else None
        if array is None:
            return opened(place, "description", LIMITS["description"]).read()
        most = array.chunk_bytes + array.chunk_bytes // 100 + PACKING_COSTS
        content = opened(place, "chunk", most).read()
        fault = chunk_fault(content, array)
        if fault:
            raise StorageError(
                f"the chunk {one_line(key)} of {one_line(self.root)} is damaged: {fault}; bring back a copy of it, or compute "
                "its samples again with: tactsim sweep CASE --out STORE --resume"
            )
        return content

    @staticmethod
    def _buffer(content: bytes | None, prototype: Any, byte_range: Any) -> Any:
        if byte_range is not None:
            raise StorageError("a part of a chunk was asked for, which no array of a data set has")
        return None if content is None else (prototype or default_buffer_prototype()).buffer.from_bytes(content)


def chunk_fault(content: bytes, array: ArrayDescription) -> str:
    """Why these bytes are no chunk of the array, empty if they are one."""
    from numcodecs import zstd

    size = unpacked_size(content)
    if size is None:
        return "it is not packed by Zstandard"
    if size > array.chunk_bytes or (array.dtype != "str" and size != array.chunk_bytes):
        return f"it unpacks to {size} bytes; expected: {array.chunk_bytes}"
    try:
        unpacked = zstd.decompress(content, np.empty(size, np.uint8))
    except (RuntimeError, ValueError) as error:
        return one_line(error, 200)
    return _text_fault(bytes(unpacked), array.chunks[0]) if array.dtype == "str" else ""


def unpacked_size(content: bytes) -> int | None:
    """Bytes to which a frame of Zstandard unpacks, None if it is none or does not say so (RFC 8878, section 3.1.1.1)."""
    if len(content) < 6 or struct.unpack_from("<I", content)[0] != FRAME:
        return None
    flags = content[4]
    single, length = bool(flags & 0x20), (0, 2, 4, 8)[flags >> 6]
    length = length or int(single)
    begin = 5 + (not single) + (0, 1, 2, 4)[flags & 3]
    if not length or len(content) < begin + length:
        return None
    return int.from_bytes(content[begin : begin + length], "little") + (256 if length == 2 else 0)


def _text_fault(content: bytes, samples: int) -> str:
    """Whether the texts in a chunk are as many as its samples and lie within it."""
    if len(content) < 4 or struct.unpack_from("<I", content)[0] != samples:
        return f"it holds another number of texts than {samples}"
    place = 4
    for _ in range(samples):
        if place + 4 > len(content):
            return "a text ends behind its end"
        begin, place = place + 4, place + 4 + struct.unpack_from("<I", content, place)[0]
        try:
            content[begin:place].decode("utf-8")
        except UnicodeDecodeError:
            return "a text is not UTF-8"
    return "" if place == len(content) else "a text ends behind its end"
