"""Arrays from npz files of others: no objects, and no array larger than the file can hold or the reader expects."""

from __future__ import annotations

import io
import lzma
import math
import struct
import sys
import zipfile
import zlib
from tokenize import TokenError
from typing import IO

import numpy as np
from numpy.lib import format as npy

from tactsim.array import Array
from tactsim.errors import StorageError
from tactsim.outside.processes import machine_memory
from tactsim.outside.text import one_line

LARGEST_FOREIGN = 2**30
"""Bytes that the arrays of a file of others may take together, or of any file where the memory of the machine is not known."""
KINDS = frozenset("biufcUS")
"""numpy's letters for kinds of arrays that are read: truth values, numbers and text."""
MOST_ARRAYS = 100_000
"""Entries of a file, each of which costs time."""

_ARCHIVE = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error)
_HEADER_TEXT = (SyntaxError, TokenError)
_CONTENT = (OSError, ValueError, LookupError, EOFError, TypeError, ArithmeticError, RuntimeError, MemoryError)
DAMAGE = (*_ARCHIVE, *_HEADER_TEXT, *_CONTENT)
"""What the archive, its compression, the header of an array, which is Python text, and its numbers raise."""


def read_arrays(content: bytes, name: str, *, largest: int | None = None) -> dict[str, Array]:
    """The arrays of an npz file by name, of the shapes that the file says.

    Parameters
    ----------
    content : the bytes of the file
    name : how messages call it
    largest : bytes that the arrays may take in memory, by default what the machine has; their headers are checked before anything
        is allocated

    Raises
    ------
    StorageError
        If the file is damaged, or its arrays hold objects or are too large.
    """
    largest = (machine_memory() or LARGEST_FOREIGN) if largest is None else largest
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            if len(entries) > MOST_ARRAYS or sum(entry.file_size for entry in entries) > largest:
                raise StorageError(f"{one_line(name)} unpacks to more than {largest} bytes, which is more than it can need")
            return {entry.filename.removesuffix(".npy"): _array(archive, entry) for entry in entries}
    except StorageError:
        raise
    except DAMAGE as error:
        raise StorageError(f"{one_line(name)} is damaged: {one_line(error)}") from None


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Array:
    with archive.open(entry) as file:
        shape, dtype = _header(file)
        if dtype.hasobject:
            raise ValueError(f"{entry.filename} holds objects, which could run code")
        claimed = math.prod(shape) * dtype.itemsize
        if claimed > entry.file_size:
            raise ValueError(f"{entry.filename} says that it holds {claimed} bytes and has {entry.file_size}")
        if dtype.kind not in KINDS:
            raise ValueError(f"{entry.filename} holds neither numbers nor text")
    with archive.open(entry) as file:
        array = npy.read_array(file, allow_pickle=False)
    if dtype.kind == "U" and not _is_text(array):
        raise ValueError(f"{entry.filename} holds characters that do not exist")
    return array


def _is_text(array: Array) -> bool:
    """Whether all characters exist; Python's strings crash on others."""
    codes = np.ascontiguousarray(array).reshape(-1).view(np.dtype(np.uint32).newbyteorder(array.dtype.byteorder))
    return bool((codes <= sys.maxunicode).all())


def _header(file: IO[bytes]) -> tuple[tuple[int, ...], np.dtype]:
    version = npy.read_magic(file)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = read(file)
    if any(length < 0 for length in shape):
        raise ValueError("an array of negative length")
    return shape, dtype
