"""Sparse direct solution by MKL Pardiso, through pypardiso's binding."""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.solvers.pardiso_binding import (
    ANALYSE,
    ANALYSE_AND_FACTOR,
    ENTRIES,
    FACTOR,
    GENERAL,
    MATCHING,
    OPERATIONS,
    ORDER,
    PIVOTING,
    RELEASE,
    SCALING,
    SINGLE_PRECISION,
    SOLVE,
    SYMMETRIC_INDEFINITE,
    CompressedRows,
    call_pardiso,
    fresh_binding,
)

GENERAL_SETTINGS = {0: 1, 1: 2, 7: 0, 9: 13, 10: 1, 12: 1}
"""User settings, nested dissection, refinement only after perturbed pivots, perturbation 1e-13, scaling and matching: MKL's
defaults for nonsymmetric matrices but for the refinement. Two rounds of it for every solution
take a third of a factor in a section, and without them the residual is 4e-15 of the right-hand side already."""


Kept = TypeVar("Kept")


def of_last_matrix(kept: Kept | None) -> Kept:
    """What a solver kept of the last matrix that it took.

    Raises
    ------
    InputError
        If there was none.
    """
    if kept is None:
        raise InputError("factor a matrix before solving")
    return kept


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
        self._solver = fresh_binding(self.kind)
        self._single = single
        for index, value in (GENERAL_SETTINGS | {SINGLE_PRECISION: int(single)}).items():
            self._solver.iparm[index] = value
        if minimum_degree:
            self._solver.iparm[ORDER] = 0
        self._system: CompressedRows | None = None

    def factor(self, matrix: csr_matrix) -> None:
        """Factor the matrix; analyses the pattern on the first call.

        Raises
        ------
        ConvergenceError, OutOfMemory
            If it holds numbers that are not finite, or too large for single precision where that is asked, or MKL fails.
        """
        self._take(matrix, ANALYSE_AND_FACTOR if self._system is None else FACTOR)

    def analyse(self, matrix: csr_matrix) -> FactorSize:
        """Size of the factors of matrices of this pattern, whose values do not matter if nothing is matched; factor them next.

        Raises
        ------
        ConvergenceError
            If the matrix holds numbers that are not finite, or too large for single precision.
        """
        self._solver.iparm[ENTRIES] = self._solver.iparm[OPERATIONS] = -1
        self._take(matrix, ANALYSE)
        return FactorSize(float(self._solver.iparm[ENTRIES]), 1e6 * float(self._solver.iparm[OPERATIONS]))

    def _take(self, matrix: csr_matrix, phase: int, written: Array | None = None) -> None:
        """Analyse or factor a matrix; ``written`` takes what Pardiso returns beside the factor."""
        if self._system is None:
            row_starts, columns = self._structure(matrix)
            nothing = CompressedRows(np.zeros(0), np.zeros(0), np.zeros(0))
            self._release = weakref.finalize(self, call_pardiso, self._solver, RELEASE, nothing, nothing.entries)
        else:
            row_starts, columns = self._system.row_starts, self._system.columns
        entries = self._entries(matrix)
        if self._single and not np.abs(entries).max() < np.finfo(np.float32).max:
            raise ConvergenceError("the matrix holds numbers that are not finite, or too large for single precision")
        entries = entries.astype(np.float32 if self._single else np.float64, copy=False)
        self._system = CompressedRows(entries, row_starts, columns)
        call_pardiso(self._solver, phase, self._system, np.zeros(matrix.shape[0]), written)

    def _structure(self, matrix: csr_matrix) -> tuple[Array, Array]:
        """Row starts and columns, counted from one."""
        return matrix.indptr.astype(np.int32) + 1, matrix.indices.astype(np.int32) + 1

    def _entries(self, matrix: csr_matrix) -> Array:
        """Values of the entries of the structure."""
        return matrix.data

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,)."""
        system = of_last_matrix(self._system)
        if not self._single:
            return call_pardiso(self._solver, SOLVE, system, right)
        size = float(np.abs(right).max())
        return size * call_pardiso(self._solver, SOLVE, system, right / size) if size else np.zeros_like(right)

    def close(self) -> None:
        """Release MKL's memory; the next matrix may have another pattern."""
        if self._system is not None:
            self._release()
            self._system = None


@dataclass(frozen=True)
class UpperHalf:
    """Entries of a matrix on and above its diagonal, and their mirror images, which the pattern must hold too.

    Attributes
    ----------
    upper, mirror : where they stand (k,) among the entries of the matrix
    rows, columns : their rows and columns (k,)
    """

    upper: Array
    mirror: Array
    rows: Array
    columns: Array

    @classmethod
    def of(cls, matrix: csr_matrix) -> UpperHalf:
        """That of matrices of the pattern of this one."""
        small = matrix.indices.dtype
        rows = np.repeat(np.arange(matrix.shape[0], dtype=small), np.diff(matrix.indptr))
        numbered = csr_matrix((np.arange(matrix.nnz, dtype=small), matrix.indices, matrix.indptr), matrix.shape)
        upper = np.flatnonzero(matrix.indices >= rows)
        return cls(upper, numbered.T.tocsr().data[upper], rows[upper], matrix.indices[upper])

    def structure(self, size: int) -> tuple[Array, Array]:
        """Starts (size + 1,) of its ``size`` rows and its columns (k,), counted from one."""
        starts = np.concatenate([[0], np.cumsum(np.bincount(self.rows, minlength=size))])
        return starts.astype(np.int32) + 1, self.columns.astype(np.int32) + 1

    def symmetric(self, data: Array) -> Array:
        """Entries (k,) of the symmetric part of the matrix with the entries ``data`` (nnz,)."""
        return (data[self.upper] + data[self.mirror]) / 2

    def skew(self, data: Array, some: Array | slice = slice(None)) -> Array:
        """Entries (k,) of its skew part, or ``some`` of them."""
        return (data[self.upper[some]] - data[self.mirror[some]]) / 2


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
        self._half = UpperHalf.of(matrix)
        return self._half.structure(matrix.shape[0])

    def _entries(self, matrix: csr_matrix) -> Array:
        """Entries of the symmetric part on and above the diagonal."""
        return self._half.symmetric(matrix.data)


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
        entries, rows, columns = super()._entries(matrix), self._half.rows, self._half.columns
        diagonal = rows == columns
        entries[diagonal] -= self._added
        sizes = np.abs(entries[diagonal])
        self._scale = 1 / np.sqrt(np.where(sizes > 0, sizes, 1.0))
        return entries * self._scale[rows] * self._scale[columns]

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,), right to some six digits times the condition of the matrix."""
        return self._scale * super().solve(self._scale * right)
