"""How many threads a computation is worth: barriers between threads cost more than they save on a small body."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache

import numba
from threadpoolctl import ThreadpoolController

import tactsim.fem.compiling  # noqa: F401  follows numba's compiling from the first loop on
from tactsim.errors import InputError

SERIAL_ELEMENTS = 15_000
"""Element loops over fewer elements use one thread: with two, each of the dozen barriers of a loop may wait for the system."""
SERIAL_UNKNOWNS = 15_000
"""The same for factoring a matrix of fewer unknowns and solving with the factor.

Two idle cores solve a grasp of 33 334 unknowns in 4.9 s instead of 6.3 s, and if they are busy it takes no longer. Sections of
10 000 gain a sixth at most, and on busy cores lose half.
"""
SPINNING = "KMP_BLOCKTIME"
"""Environment variable: time in ms for which a thread of MKL spins when its work is done, 200 by default."""
WAITING = "OMP_WAIT_POLICY"
"""The same for the threads of the element loops, which spin unless it says passive: a grasp of 41 500 unknowns then takes 15 s
instead of 19 s of two cores of which other work has one, and on idle ones no longer than before."""

# Threads give up their core at once when their work is done, unless the user says otherwise; both libraries read it as they load.
os.environ.setdefault(SPINNING, "0")
os.environ.setdefault(WAITING, "passive")


def are_serial(elements: int) -> bool:
    """Whether loops over so many elements use one thread."""
    return elements < SERIAL_ELEMENTS


@contextmanager
def loop_threads(elements: int) -> Iterator[None]:
    """The element loops inside use one thread if there are few elements.

    Raises
    ------
    InputError
        In a process that was forked from one whose loops have run with the threads of OpenMP, which end such a process.
    """
    if _cut_off.is_set():
        raise InputError(
            "this process was forked from one that has computed, and its threads did not come along; start processes with "
            "multiprocessing.get_context('spawn')"
        )
    before = numba.get_num_threads()
    numba.set_num_threads(1 if are_serial(elements) else before)
    try:
        yield
    finally:
        numba.set_num_threads(before)


_cut_off = threading.Event()
"""Set in a process that was forked from one whose loops had run with the threads of OpenMP."""


def _after_a_fork() -> None:
    with suppress(ValueError):  # no loop has run yet
        if numba.threading_layer() == "omp":
            _cut_off.set()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_a_fork)


@contextmanager
def one_vector_thread() -> Iterator[None]:
    """OpenBLAS, with which numpy and scipy add up vectors, uses one thread inside.

    Its threads spin between the sums, which slows what else computes on the same core: a grasp of 33 334 unknowns takes 6.4 s
    instead of 7.3 s of two idle cores while its factors use one, and half the processor time.
    """
    with _open_blas().limit(limits=1):
        yield


@cache
def _open_blas() -> ThreadpoolController:
    """Those copies of it that are loaded."""
    return ThreadpoolController().select(internal_api="openblas")
