"""The files of a store: no links among them, which of them tactsim wrote, and what a killed run left torn."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from tactsim.dataset.store.arrays import META, ArrayDescription
from tactsim.dataset.store.blocks import JOURNAL
from tactsim.errors import StorageError
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
    """Removes what a killed run left half written."""
    names = set(arrays)
    for name in [name for name in walked(folder) if is_torn(name, names)]:
        with naming(folder / name, "remove"):
            (folder / name).unlink()


def foreign_files(folder: Path, described: Mapping[str, ArrayDescription], own: Iterable[str]) -> list[str]:
    """Files that tactsim does not write there, sorted; ``own`` are the names of all arrays of the store."""
    known = {META, OWN_LIST, JOURNAL, CARD, *OwnFiles(folder).sums(), *(f"{name}/{META}" for name in own)}
    chunks = {name: (array, -(-array.shape[0] // array.chunks[0])) for name, array in described.items()}
    names, listed = set(own), os.path.lexists(folder / OWN_LIST)
    return sorted(
        name
        for name in walked(folder)
        if name not in known
        and name.rpartition("/")[2] not in IGNORED
        and not _is_chunk(name, chunks, names)
        and not (EARLIER.fullmatch(name) and not listed)
        and not is_torn(name, names)
    )


def _is_chunk(name: str, chunks: Mapping[str, tuple[ArrayDescription, int]], own: set[str]) -> bool:
    parts = name.split("/")
    if len(parts) < 3 or parts[0] not in own or parts[1] != "c" or not all(part.isdecimal() for part in parts[2:]):
        return False
    if parts[0] not in chunks:
        return True  # of an array whose description is gone
    array, count = chunks[parts[0]]
    return int(parts[2]) < count and name == array.chunk_key(int(parts[2]))
