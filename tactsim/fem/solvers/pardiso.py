"""Sparse direct solution by MKL Pardiso, through pypardiso's binding."""

from __future__ import annotations

import copy
import ctypes
import functools
import os
import weakref
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError, OutOfMemory
from tactsim.fem.threads import SERIAL_UNKNOWNS

GENERAL, SYMMETRIC_INDEFINITE = 11, -2
"""Pardiso's kinds of matrices."""
ANALYSE, ANALYSE_AND_FACTOR, FACTOR, SOLVE, RELEASE = 11, 12, 22, 33, -1
"""Its phases."""
GENERAL_SETTINGS = {0: 1, 1: 2, 7: 0, 9: 13, 10: 1, 12: 1}
"""User settings, nested dissection, refinement only after perturbed pivots, perturbation 1e-13, scaling and matching: MKL's
defaults for nonsymmetric matrices but for the refinement. Two rounds of it for every solution
take a third of a factor in a section, and without them the residual is 4e-15 of the right-hand side already."""
SINGLE_PRECISION, PIVOTING = 27, 20
"""Which of Pardiso's settings ask for matrices and vectors in single precision, and for blocks of two by two as pivots."""
ORDER = 1
"""Which of them chooses the order of the unknowns: 2, nested dissection, by default, or 0, minimum degree."""
SCALING, MATCHING = 10, 12
"""Which of them ask for scaling and for the matching of large entries to the diagonal."""
ENTRIES, OPERATIONS = 17, 18
"""Which of them hold, if asked by -1, the entries of the factor and the millions of operations for it once it is analysed."""
NO_MEMORY = (-2, -9)
"""Pardiso's error codes when memory runs out (oneMKL Developer Reference, pardiso, table of error indicators)."""

LIBRARY_VARIABLE = "PYPARDISO_MKL_RT"
"""Environment variable in which pypardiso takes the path of MKL's library."""


@dataclass(frozen=True)
class FactorSize:
    """How large a factor will be: its ``entries`` and the floating-point ``operations`` that make it."""

    entries: float
    operations: float


class Pardiso:
    """MKL Pardiso for nonsymmetric matrices, through pypardiso's binding; its memory goes when the object goes.

    Parameters
    ----------
    single : in single precision, for solutions that guide an iteration, right to some six digits times the condition of the
        matrix: half the memory to read, so half the time. What is not a number, or too large for it, must never reach MKL.
    minimum_degree : the order of few entries in sections: of 8 000 unknowns a factor takes a tenth less, a solution up to a fifth
    """

    name = "pardiso"
    kind = GENERAL

    def __init__(self, *, single: bool = False, minimum_degree: bool = False) -> None:
        self._solver = _fresh_binding(self.kind)
        self._single = single
        for index, value in (GENERAL_SETTINGS | {SINGLE_PRECISION: int(single)}).items():
            self._solver.iparm[index] = value
        if minimum_degree:
            self._solver.iparm[ORDER] = 0
        self._system: tuple[Array, Array, Array] | None = None

    def factor(self, matrix: csr_matrix) -> None:
        """Factor the matrix; analyses the pattern on the first call.

        Raises
        ------
        ConvergenceError, OutOfMemory
            If it holds numbers that are not finite, or too large for single precision where that is asked, or MKL fails.
        """
        self._take(matrix, ANALYSE_AND_FACTOR if self._system is None else FACTOR)

    def analyse(self, matrix: csr_matrix) -> FactorSize:
        """Size of the factors of matrices of this pattern, whose values do not matter if nothing is matched; factor them next."""
        self._solver.iparm[ENTRIES] = self._solver.iparm[OPERATIONS] = -1
        self._take(matrix, ANALYSE)
        return FactorSize(float(self._solver.iparm[ENTRIES]), 1e6 * float(self._solver.iparm[OPERATIONS]))

    def _take(self, matrix: csr_matrix, phase: int) -> None:
        if self._system is None:
            indptr, indices = self._structure(matrix)
            self._release = weakref.finalize(self, _call_pardiso, self._solver, RELEASE, (np.zeros(0),) * 3, np.zeros(0))
        else:
            _, indptr, indices = self._system
        entries = self._entries(matrix)
        if self._single and not np.abs(entries).max() < np.finfo(np.float32).max:
            raise ConvergenceError("the matrix holds numbers that are not finite, or too large for single precision")
        self._system = (entries.astype(np.float32 if self._single else np.float64, copy=False), indptr, indices)
        _call_pardiso(self._solver, phase, self._system, np.zeros(matrix.shape[0]))

    def _structure(self, matrix: csr_matrix) -> tuple[Array, Array]:
        """Row starts and columns, counted from one."""
        return matrix.indptr.astype(np.int32) + 1, matrix.indices.astype(np.int32) + 1

    def _entries(self, matrix: csr_matrix) -> Array:
        """Values of the entries of the structure."""
        return matrix.data

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,).

        Raises
        ------
        InputError
            If no matrix was factored.
        """
        if self._system is None:
            raise InputError("factor a matrix before solving")
        if not self._single:
            return _call_pardiso(self._solver, SOLVE, self._system, right)
        size = float(np.abs(right).max())
        return size * _call_pardiso(self._solver, SOLVE, self._system, right / size) if size else np.zeros_like(right)

    def close(self) -> None:
        """Release MKL's memory; the next matrix may have another pattern."""
        if self._system is not None:
            self._release()
            self._system = None


class SymmetricPardiso(Pardiso):
    """MKL Pardiso for the symmetric part of indefinite matrices of a symmetric pattern: half the work of the general one.

    Parameters
    ----------
    blocks : whether blocks of two by two may be pivots (Bunch-Kaufman), or single numbers only, which take less time; with MKL's
        default pivots the pressure of nearly incompressible tissue is wrong by percents, so that their user looks at the residual
    single, minimum_degree : as for `Pardiso`
    """

    name = "pardiso_symmetric"
    kind = SYMMETRIC_INDEFINITE

    def __init__(self, *, blocks: bool = True, single: bool = False, minimum_degree: bool = False) -> None:
        super().__init__(single=single, minimum_degree=minimum_degree)
        self._solver.iparm[PIVOTING] = int(blocks)

    def _structure(self, matrix: csr_matrix) -> tuple[Array, Array]:
        rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        numbered = csr_matrix((np.arange(matrix.nnz), matrix.indices, matrix.indptr), matrix.shape)
        self._upper = np.flatnonzero(matrix.indices >= rows)
        self._mirror = numbered.T.tocsr().data[self._upper]
        self._rows, self._columns = rows[self._upper], matrix.indices[self._upper]
        starts = np.concatenate([[0], np.cumsum(np.bincount(self._rows, minlength=matrix.shape[0]))])
        return starts.astype(np.int32) + 1, self._columns.astype(np.int32) + 1

    def _entries(self, matrix: csr_matrix) -> Array:
        """Entries of the symmetric part on and above the diagonal."""
        return (matrix.data[self._upper] + matrix.data[self._mirror]) / 2


class SinglePardiso(SymmetricPardiso):
    """The symmetric factor in single precision, for solutions that guide an iteration.

    Pivots are single numbers: a fifth faster than blocks (0.35 s, not 0.45 s, of one thread for a grasp of 28 500 unknowns), and
    as good a guide. A negative definite block of pressures needs no others (Vanderbei 1995, doi:10.1137/0805005); incompressible
    tissue has zeros there, which the matching meets, and a pivot that MKL perturbs costs the iteration a step or two.

    Parameters
    ----------
    minimum_degree : as for `Pardiso`
    """

    name = "pardiso_single"

    def __init__(self, *, minimum_degree: bool = False) -> None:
        super().__init__(blocks=False, single=True, minimum_degree=minimum_degree)


class QuasiDefinitePardiso(SinglePardiso):
    """The factor in single precision of the tangent of tissue that gives way a little where it is incompressible.

    The tangent of displacements and pressures is [[A, B'], [B, -C]], C zero for incompressible tissue. With a small diagonal
    added to C it is quasi-definite and has a factor in any order without pivots (Vanderbei 1995, doi:10.1137/0805005), so that
    nothing must be matched before the order is chosen: the analysis takes half the time (0.18 instead of 0.38 s for a grasp of
    17 600 unknowns) and the factor a tenth less. What guides an iteration need not be the tangent itself: with ``added`` a ten
    thousandth of what the shear modulus would make, solutions to 1e-8 take eleven steps instead of ten.

    Parameters
    ----------
    added : (n,) in m^3/Pa for pressures, zero for displacements
    """

    name = "pardiso_quasi_definite"

    def __init__(self, added: Array) -> None:
        super().__init__()
        self._added, self._scale = added, np.ones(len(added))
        self._solver.iparm[SCALING] = self._solver.iparm[MATCHING] = 0

    def _entries(self, matrix: csr_matrix) -> Array:
        entries = super()._entries(matrix)
        diagonal = self._rows == self._columns
        entries[diagonal] -= self._added
        sizes = np.abs(entries[diagonal])
        self._scale = 1 / np.sqrt(np.where(sizes > 0, sizes, 1.0))
        return entries * self._scale[self._rows] * self._scale[self._columns]

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,), right to some six digits times the condition of the matrix."""
        return self._scale * super().solve(self._scale * right)


def _call_pardiso(solver: Any, phase: int, system: tuple[Array, Array, Array], right: Array) -> Array:
    """One phase of Pardiso; ``system`` is data, indptr and indices."""
    single = bool(solver.iparm[SINGLE_PRECISION])
    right = np.ascontiguousarray(right, dtype=np.float32 if single else np.float64)
    solution = np.zeros_like(right)
    error = ctypes.c_int32(0)
    integer, real = ctypes.POINTER(ctypes.c_int32), ctypes.POINTER(ctypes.c_float if single else ctypes.c_double)

    def number(value: int) -> Any:
        return ctypes.byref(ctypes.c_int32(value))

    data, indptr, indices = system
    threads = solver.libmkl.MKL_Set_Num_Threads_Local
    before = threads(ctypes.c_int(1 if len(data) and len(right) < SERIAL_UNKNOWNS else 0))
    solver._mkl_pardiso(
        solver.pt.ctypes.data_as(ctypes.POINTER(solver._pt_type[0])),
        number(1),
        number(1),
        number(solver.mtype),
        number(phase),
        number(len(right)),
        data.ctypes.data_as(real),
        indptr.ctypes.data_as(integer),
        indices.ctypes.data_as(integer),
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


def _fresh_binding(kind: int) -> Any:
    """pypardiso's binding for a kind of matrix, with handles of its own."""
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
