"""Samples between worker and store: arrays by name as bytes without pickle, a checksum of each sample, and their journal."""

from __future__ import annotations

import hashlib
import io
import os
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.dataset.cost import COST
from tactsim.dataset.store.arrays import CHECKSUM_BYTES
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside.arrays import LARGEST_FOREIGN, read_arrays
from tactsim.outside.text import one_line
from tactsim.storage.files import naming, sync

Block = dict[str, Array]
"""Variable -> values (samples in the block, ...); ``sample`` holds the numbers of the samples."""
NOT_SUMMED = ("checksum", "wall_time", "code", *COST)
"""Of the index: what may differ between two runs of the same sample, is the sum itself, or is missing in earlier stores."""
JOURNAL = ".journal"
"""File in a store with blocks that are computed but not yet in its arrays."""
HEAD = struct.Struct("<8sQ32s")
MARK = b"tactsim\n"


def encoded(block: Block) -> bytes:
    """The block as bytes."""
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **block)
    return content.getvalue()


def decoded(content: bytes) -> Block:
    """The block of `encoded`.

    Raises
    ------
    StorageError
        If the bytes are not one.
    """
    return read_arrays(content, "a block of samples", largest=LARGEST_FOREIGN)


def refuse_unfitting(block: Block, variables: Iterable[Variable], samples: int) -> None:
    """Refuses a block that is none of these variables.

    Raises
    ------
    StorageError
        Naming the first that is missing or has another type or shape.
    """
    numbers = block.get("sample", np.arange(0))
    fits = numbers.ndim == 1 and numbers.dtype.kind == "i" and numbers.size and numbers.min() >= 0 and numbers.max() < samples
    if not fits or len(np.unique(numbers)) != len(numbers):
        raise StorageError(f"a block of samples is damaged: its samples are not among the {samples} of the data set")
    for variable in variables:
        values = block.get(variable.name)
        kind = "U" if variable.dtype == "str" else np.dtype(variable.dtype).kind
        if values is None or values.dtype.kind != kind or values.shape != (len(numbers), *variable.sizes):
            raise StorageError(f"a block of samples is damaged: {variable.name} is missing or has another type or shape")


def checksum(sample: dict[str, Array], variables: Iterable[Variable]) -> Array:
    """SHA-256 (32,) over name, type and bytes of every variable of one sample, in the order of the names."""
    summed = hashlib.sha256()
    for variable in sorted(variables, key=lambda variable: variable.name):
        if variable.role == "index" and variable.name in NOT_SUMMED:
            continue
        summed.update(variable.name.encode() + b"\0")
        value = sample[variable.name]
        if variable.dtype == "str":
            summed.update(str(value).encode() + b"\0")
        else:
            kind = np.dtype(variable.dtype).newbyteorder("<")
            summed.update(np.ascontiguousarray(value, dtype=kind).tobytes())
    return np.frombuffer(summed.digest(), dtype=np.uint8, count=CHECKSUM_BYTES)


def stacked(samples: list[dict[str, Array]], variables: Iterable[Variable]) -> Block:
    """The block of single samples: each array gets an axis (samples, ...) in front."""
    block: Block = {"sample": np.array([sample["sample"] for sample in samples], dtype=np.int64)}
    for variable in variables:
        values = [sample[variable.name] for sample in samples]
        block[variable.name] = np.array([str(v) for v in values]) if variable.dtype == "str" else np.stack(values)
    return block


class Journal:
    """Written by one process at a time."""

    def __init__(self, path: Path):
        self.path = path

    def blocks(self) -> Iterator[bytes]:
        """Every complete block; what a kill left incomplete is passed over, and nothing stands behind it.

        Raises
        ------
        StorageError
            If it cannot be read, or is no journal.
        """
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

    def waiting(self, samples: int) -> Array:
        """Numbers (n,) of the samples in its complete blocks, damaged ones left out, of a data set of so many ``samples``.

        Raises
        ------
        StorageError
            If it cannot be read, or is no journal.
        """
        numbers = [np.arange(0)]
        for content in self.blocks():
            try:
                block = decoded(content)
                refuse_unfitting(block, (), samples)
            except StorageError:
                continue  # --resume says so, and computes its samples again
            numbers.append(block["sample"])
        return np.unique(np.concatenate(numbers))

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
        """Forgets all blocks.

        Raises
        ------
        StorageError
            If it cannot be removed.
        """
        with naming(self.path):
            self.path.unlink(missing_ok=True)
