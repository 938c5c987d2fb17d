"""What a chunk of a store holds: its frame of Zstandard checked before it is unpacked, and the values in it."""

from __future__ import annotations

import struct

import numpy as np

from tactsim.array import Array
from tactsim.dataset.store.arrays import ArrayDescription
from tactsim.outside.text import one_line

FRAME = 0xFD2FB528
"""First four bytes of what Zstandard packs, RFC 8878, section 3.1.1."""


def unpacked(content: bytes, array: ArrayDescription) -> bytes:
    """What the bytes of a chunk unpack to.

    Raises
    ------
    ValueError
        Saying why these bytes are no chunk of the array.
    """
    from numcodecs import zstd

    size = unpacked_size(content)
    if size is None:
        raise ValueError("it is not packed by Zstandard")
    if size > array.chunk_bytes or (array.dtype != "str" and size != array.chunk_bytes):
        raise ValueError(f"it unpacks to {size} bytes; expected: {array.chunk_bytes}")
    try:
        result = bytes(zstd.decompress(content, np.empty(size, np.uint8)))
    except (RuntimeError, ValueError) as error:
        raise ValueError(one_line(error, 200)) from None
    if array.dtype == "str":
        _check_texts(result, array.chunks[0])
    return result


def decoded(content: bytes, array: ArrayDescription) -> Array:
    """Values of the samples of a chunk, of the chunk's shape, from what it unpacks to; texts as objects."""
    from numcodecs import VLenUTF8

    if array.dtype == "str":
        texts: Array = VLenUTF8().decode(content)
        return texts.reshape(array.chunks)
    return np.frombuffer(content, array.stored_type).reshape(array.chunks)


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


def _check_texts(content: bytes, samples: int) -> None:
    """Refuses texts that are not as many as the samples of the chunk or do not lie within it."""
    if len(content) < 4 or struct.unpack_from("<I", content)[0] != samples:
        raise ValueError(f"it holds another number of texts than {samples}")
    place = 4
    for _ in range(samples):
        if place + 4 > len(content):
            raise ValueError("a text begins beyond its end")
        begin, place = place + 4, place + 4 + struct.unpack_from("<I", content, place)[0]
        try:
            content[begin:place].decode("utf-8")
        except UnicodeDecodeError:
            raise ValueError("a text is not UTF-8") from None
    if place != len(content):
        raise ValueError("its texts do not end where it ends")
