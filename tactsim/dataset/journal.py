"""Blocks that are computed but not yet in the arrays: one file, appended to, so that a kill loses nothing of what it holds."""

from __future__ import annotations

import hashlib
import os
import struct
from collections.abc import Iterator
from pathlib import Path

from tactsim.errors import StorageError
from tactsim.outside.text import one_line
from tactsim.storage.files import naming, sync

HEAD = struct.Struct("<8sQ32s")
MARK = b"tactsim\n"


class Journal:
    """Written by one process at a time."""

    def __init__(self, path: Path):
        self.path = path

    def blocks(self) -> Iterator[bytes]:
        """Every complete block; what a kill left incomplete is passed over, and nothing stands behind it."""
        with naming(self.path, "read"):
            if not os.path.lexists(self.path):
                return
            self.refuse_foreign()
            with open(self.path, "rb") as file:
                size = os.fstat(file.fileno()).st_size
                while len(head := file.read(HEAD.size)) == HEAD.size:
                    mark, length, digest = HEAD.unpack(head)
                    if mark != MARK or length > size - file.tell():
                        return
                    content = file.read(length)
                    if hashlib.sha256(content).digest() != digest:
                        return
                    yield content

    def refuse_foreign(self) -> None:
        """Refuses anything else than a journal in its place.

        Raises
        ------
        StorageError
            If it is a link, no regular file, or does not begin like a journal.
        """
        if not os.path.lexists(self.path):
            return
        plain = self.path.is_file() and not self.path.is_symlink()
        if plain:
            with open(self.path, "rb") as file:
                plain = MARK.startswith(file.read(len(MARK)))
        if not plain:
            raise StorageError(f"{one_line(self.path)} is no journal of tactsim; move it away")

    def append(self, content: bytes) -> None:
        """Adds a block and brings it down to the disk.

        Raises
        ------
        StorageError
            If there is no room; the blocks before stay.
        """
        with naming(self.path), open(self.path, "ab") as file:
            end = file.tell()
            try:
                file.write(HEAD.pack(MARK, len(content), hashlib.sha256(content).digest()) + content)
                file.flush()
                os.fsync(file.fileno())
                if not end:
                    sync(self.path.parent)
            except OSError:
                os.truncate(self.path, end)
                raise

    def clear(self) -> None:
        """Forgets all blocks."""
        with naming(self.path):
            self.path.unlink(missing_ok=True)
