"""Systems that friction makes unsymmetric at a few unknowns: these are left out of a symmetric factor, and solved densely.

With the unknowns where friction acts last, the matrix is [[A, B], [B', C + D]], symmetric but for D. MKL Pardiso factors A, for
half the operations of a general factor, and returns the Schur complement C - B' A^-1 B of the others, to which D is added. Two
substitutions with the factor, and a dense solution between them, solve the whole.

Source: Haynsworth 1968, doi:10.1016/0024-3795(68)90050-5 (the complement); oneMKL Developer Reference, pardiso, iparm[35].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.solvers.linear import EXACT, IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import SymmetricPardiso, UpperHalf
from tactsim.fem.solvers.pardiso_binding import (
    ANALYSE_AND_FACTOR,
    BACKWARD,
    FACTOR,
    FORWARD,
    MATCHING,
    SCALING,
    SCHUR,
    call_pardiso,
)

SKEW = 1e-12
"""Skew part of an entry that is round-off, over the geometric mean of the diagonal entries in its row and its column."""
MARGIN = 6
"""Facets of the surface by which the unknowns that are left out reach beyond those where friction acts, as the contact will grow:
a new choice costs an analysis, as much as two factors. Two choices serve `annulus_icf`."""
MOST_KEPT = 4.0
"""Most unknowns that are left out, over the root of the number of all: with 438 of 7 976 a system costs as much as by a general
factor, with 190 two thirds of it."""


class CondensedPardiso(SymmetricPardiso):
    """MKL Pardiso: the symmetric factor of all unknowns but some, and the Schur complement of these.

    Pardiso neither scales nor matches then, so that the matrix comes scaled, or else residuals in a section are 4e-10 of the
    right-hand side instead of 3e-15.

    Parameters
    ----------
    kept : numbers (m,) of the unknowns that are left out, rising
    scale : (n,) factors of the rows and columns
    """

    name = "pardiso_condensed"

    def __init__(self, kept: Array, scale: Array) -> None:
        super().__init__()
        self._kept, self._scale = kept, scale
        self.complement = np.zeros((0, 0))
        """Schur complement (m, m) of the symmetric part of the last scaled matrix."""
        self._solver.iparm[SCALING] = self._solver.iparm[MATCHING] = 0
        self._solver.iparm[SCHUR] = 2
        self._solver.perm = np.zeros(len(scale), np.int32)
        self._solver.perm[kept] = 1

    def factor(self, matrix: csr_matrix) -> None:
        """Factor the matrix, and make the complement; analyses the pattern on the first call."""
        upper = np.zeros((len(self._kept), len(self._kept)))
        self._take(matrix, ANALYSE_AND_FACTOR if self._system is None else FACTOR, upper)
        self.complement = np.triu(upper) + np.triu(upper, 1).T

    def _entries(self, matrix: csr_matrix) -> Array:
        return super()._entries(matrix) * self._scale[self._half.rows] * self._scale[self._half.columns]

    def forward(self, right: Array) -> Array:
        """The right-hand side (n,) after the first substitution: at the unknowns left out, that of the complement."""
        return call_pardiso(self._solver, FORWARD, self._taken, self._scale * right)

    def backward(self, reduced: Array) -> Array:
        """The solution (n,), given ``reduced`` from the first substitution with the scaled unknowns left out solved."""
        return self._scale * call_pardiso(self._solver, BACKWARD, self._taken, reduced)

    @property
    def _taken(self) -> tuple[Array, Array, Array]:
        if self._system is None:
            raise InputError("factor a matrix before solving")
        return self._system


class CondensedFactors(IterativeSolver):
    """A symmetric factor of each system without the unknowns that friction makes unsymmetric, and a dense one of these.

    In a section of 7 976 unknowns of which 168 are left out, a factor takes 10.7 ms and a solution 2.0 ms; a general factor takes
    16.5 ms and a solution 2.4 ms.
    """

    name = CondensedPardiso.name
    exact = True

    def __init__(self) -> None:
        self._half: UpperHalf | None = None
        self._scale, self._sizes = np.zeros(0), np.zeros(0)
        self._kept, self._place = np.zeros(0, int), np.zeros(0, int)
        self._direct: CondensedPardiso | None = None
        self._dense: Any = None
        self._unchecked: csr_matrix | None = None

    def factor(self, system: LinearSystem) -> None:
        """Factor a system if friction acts on some of its unknowns; its pattern must be that of the first one."""
        matrix = system.matrix
        if self._half is None:
            self._half, self._scale = UpperHalf.of(matrix), scales(matrix)
            self._sizes = self._scale[self._half.rows] * self._scale[self._half.columns]
        skew = self._half.skew(matrix.data) * self._sizes
        there = np.flatnonzero(~(np.abs(skew) <= SKEW))
        rows, columns = self._half.rows[there], self._half.columns[there]
        if self._direct is None or (self._place[rows] < 0).any() or (self._place[columns] < 0).any():
            self._leave_out(np.union1d(rows, columns), system)
        if self._direct is None:
            return
        self._direct.factor(matrix)
        dense, rows, columns = self._direct.complement.copy(), self._place[rows], self._place[columns]
        dense[rows, columns] += skew[there]
        dense[columns, rows] -= skew[there]
        self._dense, self._unchecked = lu_factor(dense, overwrite_a=True, check_finite=False), matrix

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Exact solution for one right-hand side (n,) of the last system.

        Raises
        ------
        InputError
            If there is no matrix yet.
        ConvergenceError
            If friction acts on no unknown or on too many, or the factor is not exact.
        """
        if self._half is None:
            raise InputError("factor a matrix before solving")
        if self._direct is None:
            raise ConvergenceError(f"friction acts on {len(self._kept)} of {len(self._scale)} unknowns")
        reduced = self._direct.forward(right)
        reduced[self._kept] = lu_solve(self._dense, reduced[self._kept], check_finite=False)
        solution, matrix, self._unchecked = self._direct.backward(reduced), self._unchecked, None
        if matrix is not None and not np.abs(matrix @ solution - right).max() <= EXACT * np.abs(right).max():
            raise ConvergenceError("the pivots of the condensed factor do not suffice")
        return solution

    def close(self) -> None:
        """Release the factor's memory; the next matrix may have another pattern."""
        if self._direct is not None:
            self._direct.close()
        self._direct = self._half = self._dense = self._unchecked = None

    def _leave_out(self, touched: Array, system: LinearSystem) -> None:
        """Choose anew what is left out of the factor, which is what friction touches and the surface beside it."""
        size = system.matrix.shape[0]
        left_out = np.zeros(size, bool)
        left_out[touched] = True
        surface = system.surface
        beside = system.matrix[surface][:, surface] != 0
        for _ in range(MARGIN):
            left_out[surface] |= beside @ left_out[surface]
        self._kept = np.flatnonzero(left_out)
        self._place = np.full(size, -1)
        self._place[self._kept] = np.arange(len(self._kept))
        if self._direct is not None:
            self._direct.close()
        worth = 0 < len(self._kept) <= MOST_KEPT * np.sqrt(size)
        self._direct = CondensedPardiso(self._kept, self._scale) if worth else None


def scales(matrix: csr_matrix) -> Array:
    """Factors (n,) of rows and columns, after which displacements have one on the diagonal, and pressures, of which the entries
    there are negative or zero, one at most beside it."""
    diagonal = matrix.diagonal()
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    beside = np.asarray(abs(matrix).multiply(np.where(diagonal > 0, scale, 0.0)).tocsr().max(axis=1).todense()).ravel()
    return np.where((diagonal <= 0) & (beside > 0), 1 / np.where(beside > 0, beside, 1.0), scale)
