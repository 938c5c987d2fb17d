"""How many threads a computation is worth: barriers between threads cost more than they save on a small body."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numba

import tactsim.fem.compiling  # noqa: F401  follows numba's compiling from the first loop on

SERIAL_ELEMENTS = 15_000
"""Element loops over fewer elements use one thread: with two, each of the dozen barriers of a loop may wait for the system."""
SERIAL_UNKNOWNS = 40_000
"""The same for factoring a matrix of fewer unknowns."""


def are_serial(elements: int) -> bool:
    """Whether loops over so many elements use one thread."""
    return elements < SERIAL_ELEMENTS


@contextmanager
def loop_threads(elements: int) -> Iterator[None]:
    """The element loops inside use one thread if there are few elements."""
    before = numba.get_num_threads()
    numba.set_num_threads(1 if are_serial(elements) else before)
    try:
        yield
    finally:
        numba.set_num_threads(before)
