"""pypardiso's binding of MKL Pardiso: where the library is, handles, and calls of one phase."""

from __future__ import annotations

import copy
import ctypes
import functools
import os
from contextlib import suppress
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError, OutOfMemory
from tactsim.fem.threads import SERIAL_UNKNOWNS

GENERAL, SYMMETRIC_INDEFINITE = 11, -2
"""Pardiso's kinds of matrices."""
ANALYSE, ANALYSE_AND_FACTOR, FACTOR, SOLVE, RELEASE = 11, 12, 22, 33, -1
"""Its phases."""
FORWARD, BACKWARD = 331, 333
"""The two substitutions of a solution."""
SINGLE_PRECISION, PIVOTING = 27, 20
"""Which of Pardiso's settings ask for matrices and vectors in single precision, and for blocks of two by two as pivots."""
ORDER = 1
"""Which of them chooses the order of the unknowns: 2, nested dissection, by default, or 0, minimum degree."""
SCALING, MATCHING = 10, 12
"""Which of them ask for scaling and for the matching of large entries to the diagonal."""
ENTRIES, OPERATIONS = 17, 18
"""Which of them hold, if asked by -1, the entries of the factor and the millions of operations for it once it is analysed."""
SCHUR = 35
"""Which of them asks by 2 for the Schur complement of the unknowns that the permutation marks, and for a factor of the others."""
NO_MEMORY = (-2, -9)
"""Pardiso's error codes when memory runs out (oneMKL Developer Reference, pardiso, table of error indicators)."""

LOOPS_THREADS = "libgomp.so.1"
"""GNU's OpenMP, which the element loops use where the system has it.

MKL takes the same threads if it finds them loaded at its first call, and Intel's otherwise, and with these it orders the unknowns
differently: the force of a leaning annulus differed by 5e-4, within the tolerance of its contact, by whether a loop had run
before the first factor, which depended on what the process had computed before. Therefore they are loaded first."""
LIBRARY_VARIABLE = "PYPARDISO_MKL_RT"
"""Environment variable in which pypardiso takes the path of MKL's library."""


@dataclass(frozen=True, slots=True)
class CompressedRows:
    """A matrix as Pardiso takes it: entries (k,) row by row, where each row begins (n + 1,), and the column (k,) of each entry.

    Rows and columns are counted from one.
    """

    entries: Array
    row_starts: Array
    columns: Array


def call_pardiso(solver: Any, phase: int, system: CompressedRows, right: Array, written: Array | None = None) -> Array:
    """One phase of Pardiso for a right-hand side (n,); ``written`` takes the result if that is no solution (n,).

    Raises
    ------
    ConvergenceError, OutOfMemory
        If MKL fails.
    """
    single = bool(solver.iparm[SINGLE_PRECISION])
    right = np.ascontiguousarray(right, dtype=np.float32 if single else np.float64)
    solution = np.zeros_like(right) if written is None else written
    error = ctypes.c_int32(0)
    integer, real = ctypes.POINTER(ctypes.c_int32), ctypes.POINTER(ctypes.c_float if single else ctypes.c_double)

    def number(value: int) -> Any:
        return ctypes.byref(ctypes.c_int32(value))

    threads = solver.libmkl.MKL_Set_Num_Threads_Local
    before = threads(ctypes.c_int(1 if len(system.entries) and len(right) < SERIAL_UNKNOWNS else 0))
    solver._mkl_pardiso(
        solver.pt.ctypes.data_as(ctypes.POINTER(solver._pt_type[0])),
        number(1),
        number(1),
        number(solver.mtype),
        number(phase),
        number(len(right)),
        system.entries.ctypes.data_as(real),
        system.row_starts.ctypes.data_as(integer),
        system.columns.ctypes.data_as(integer),
        solver.perm.ctypes.data_as(integer),
        number(1),
        solver.iparm.ctypes.data_as(integer),
        number(0),
        right.ctypes.data_as(real),
        solution.ctypes.data_as(real),
        ctypes.byref(error),
    )
    threads(ctypes.c_int(before))
    if error.value in NO_MEMORY:
        raise OutOfMemory(f"the memory does not suffice for a factor of {len(right)} unknowns; take larger elements")
    if error.value != 0:
        raise ConvergenceError(f"the sparse direct solver failed (Pardiso error {error.value}); is the body held?")
    return solution.astype(float, copy=False)


def fresh_binding(kind: int) -> Any:
    """pypardiso's binding for a kind of matrix, with handles of its own.

    Raises
    ------
    InputError
        If the library of MKL is not found.
    """
    binding = _pardiso_binding(kind)
    fresh = copy.copy(binding)
    fresh.pt, fresh.iparm, fresh.perm = np.zeros_like(binding.pt), np.zeros_like(binding.iparm), np.zeros_like(binding.perm)
    return fresh


@functools.cache
def _pardiso_binding(kind: int) -> Any:
    """A solver for a kind of matrix that has never been used, to copy.

    Raises
    ------
    InputError
        If pypardiso is there, but not the library that it binds.
    """
    _tell_where_mkl_is()
    with suppress(OSError):
        ctypes.CDLL(LOOPS_THREADS)
    os.environ.setdefault("MKL_CBWR", "AUTO,STRICT")  # else a sum depends on where its numbers lie in memory, anew in each run
    try:
        import pypardiso  # makes a solver of its own, so that it raises too

        return pypardiso.PyPardisoSolver(mtype=kind)
    except ImportError as error:
        raise InputError(
            "the linear solver needs MKL's library mkl_rt, which is not beside this Python: pip install mkl, or set the "
            f"environment variable {LIBRARY_VARIABLE} to the path of the library"
        ) from error


def _tell_where_mkl_is() -> None:
    """Name MKL's library to pypardiso by the list of files of the installed ``mkl``.

    Otherwise pypardiso searches all folders of the environment for it, 0.3 s at each of three times. Where ``mkl`` is not
    installed as a Python package, pypardiso's own search finds it.
    """
    if LIBRARY_VARIABLE in os.environ:
        return
    try:
        files = metadata.files("mkl") or []
    except metadata.PackageNotFoundError:
        return
    libraries = [path for file in files if "mkl_rt" in file.name and (path := Path(str(file.locate()))).exists()]
    if libraries:
        os.environ[LIBRARY_VARIABLE] = str(libraries[0].resolve())
