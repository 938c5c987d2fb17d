"""Random numbers of a compiled library that has no seed: they are made the same in every process.

C++ libraries seed their generators from ``std::random_device``, which asks the processor or the system. The loader has written
the address of that function into a table of the library; here it is replaced by that of a function that always returns the same
number, so that the library's own generators begin alike. This is for processes that do nothing else: it changes the library
for all who use it.

Source: System V ABI, AMD64 Architecture Processor Supplement, chapters 4 and 5 (ELF objects and their relocations).
"""

from __future__ import annotations

import ctypes
import mmap
import platform
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

DRAW = b"_ZNSt13random_device9_M_getvalEv"
"""``std::random_device::operator()`` of the GNU library, as linkers spell it."""
RELOCATIONS_WITH_ADDENDS, RELOCATION_SIZE, SYMBOL_SIZE = 4, 24, 24
"""Type of the sections that say what the loader fills in, and bytes of an entry of theirs and of the symbols'."""
SECTION = struct.Struct("<IIQQQQIIQQ")
"""Of a table of sections: name, type, flags, address, offset, size, link, info, alignment, size of entries."""
READ_AND_WRITE = 3


def fix_random_device(library: Path) -> bool:
    """Makes a library that this process has loaded draw the same numbers in every process; whether that was possible.

    It is on Linux with x86-64 processors, if the library takes ``std::random_device`` from another one.

    Raises
    ------
    OSError
        If the library cannot be read, or its table of functions not be written.
    """
    if sys.platform != "linux" or platform.machine() != "x86_64":
        return False
    content, base = library.read_bytes(), _loaded_at(library)
    if base is None or not content.startswith(b"\x7fELF\x02\x01"):
        return False
    places = [base + offset for offset in _filled_in(content, DRAW)]
    always_alike = ctypes.cast(ctypes.CDLL(None).getpagesize, ctypes.c_void_p).value
    assert always_alike is not None
    for place in places:
        _unprotect(place)
        ctypes.c_uint64.from_address(place).value = always_alike
    return bool(places)


def _loaded_at(library: Path) -> int | None:
    """Lowest address of a library in this process, None if it is not loaded."""
    maps = [line.split(maxsplit=5) for line in Path("/proc/self/maps").read_text().splitlines()]
    starts = [int(fields[0].split("-")[0], 16) for fields in maps if len(fields) == 6 and fields[5] == str(library.resolve())]
    return min(starts, default=None)


def _filled_in(content: bytes, symbol: bytes) -> Iterator[int]:
    """Offsets from the beginning of a loaded library at which the loader has written the address of a symbol."""
    (first,) = struct.unpack_from("<Q", content, 0x28)
    size, count = struct.unpack_from("<HH", content, 0x3A)
    sections = [SECTION.unpack_from(content, first + number * size) for number in range(count)]
    for section in sections:
        if section[1] != RELOCATIONS_WITH_ADDENDS:
            continue
        symbols = sections[section[6]]
        names = sections[symbols[6]][4]
        for entry in range(section[4], section[4] + section[5], RELOCATION_SIZE):
            offset, which = struct.unpack_from("<QQ", content, entry)
            (name,) = struct.unpack_from("<I", content, symbols[4] + SYMBOL_SIZE * (which >> 32))
            if which >> 32 and content.startswith(symbol + b"\0", names + name):
                yield offset


def _unprotect(place: int) -> None:
    """Lets this process write at an address, which the loader has protected since it filled the table in."""
    begin = place - place % mmap.PAGESIZE
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mprotect(ctypes.c_void_p(begin), ctypes.c_size_t(mmap.PAGESIZE), READ_AND_WRITE):
        raise OSError(ctypes.get_errno(), "the library's table of functions cannot be written")
