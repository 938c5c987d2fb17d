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
from tactsim.fem.solvers.linear import IterativeSolver, LinearSystem, solves
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
"""Skew part of an entry that is round-off, after its row and its column have been scaled."""
MARGIN = 6
"""Facets of the surface by which the unknowns that are left out reach beyond those where friction acts, as the contact will grow:
a new choice costs an analysis, as much as two factors. Two choices serve `annulus_icf`."""
MOST_LEFT_OUT = 4.0
"""Most unknowns that are left out, over the root of the number of all: with 438 of 7 976 a system costs as much as by a general
factor, with 190 two thirds of it."""


class CondensedPardiso(SymmetricPardiso):
    """MKL Pardiso: the symmetric factor of all unknowns but some, and a dense general one of their Schur complement.

    Pardiso neither scales nor matches then, so that the matrix comes scaled, or else residuals in a section are 4e-10 of the
    right-hand side instead of 3e-15. In one of 7 976 unknowns of which 168 are left out, a factor takes 10.7 ms and a solution
    2.0 ms; a general factor takes 16.5 ms and a solution 2.4 ms.

    Parameters
    ----------
    left_out : numbers (m,) of unknowns, rising; only between these may the matrix be unsymmetric
    scale : (n,) factors of the rows and columns
    """

    name = "pardiso_condensed"

    def __init__(self, left_out: Array, scale: Array) -> None:
        super().__init__()
        self._left_out, self._scale = left_out, scale
        self._place = np.full(len(scale), -1)
        self._place[left_out] = np.arange(len(left_out))
        self._dense: Any = None
        self._solver.iparm[SCALING] = self._solver.iparm[MATCHING] = 0
        self._solver.iparm[SCHUR] = 2
        self._solver.perm = (self._place >= 0).astype(np.int32)

    def leaves_out(self, unknowns: Array) -> bool:
        """Whether all unknowns, by their numbers (k,), are among those that are left out."""
        return bool((self._place[unknowns] >= 0).all())

    def factor(self, matrix: csr_matrix) -> None:
        """Factor the matrix; analyses the pattern on the first call."""
        upper = np.zeros((len(self._left_out), len(self._left_out)))
        self._take(matrix, ANALYSE_AND_FACTOR if self._system is None else FACTOR, upper)
        complement = np.triu(upper) + np.triu(upper, 1).T
        half, between = self._half, self._between
        skew = half.skew(matrix.data, between) * self._scale[half.rows[between]] * self._scale[half.columns[between]]
        rows, columns = self._place[half.rows[between]], self._place[half.columns[between]]
        complement[rows, columns] += skew
        complement[columns, rows] -= skew
        self._dense = lu_factor(complement, overwrite_a=True, check_finite=False)

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,).

        Raises
        ------
        InputError
            If no matrix was factored.
        """
        if self._system is None:
            raise InputError("factor a matrix before solving")
        reduced = call_pardiso(self._solver, FORWARD, self._system, self._scale * right)
        reduced[self._left_out] = lu_solve(self._dense, reduced[self._left_out], check_finite=False)
        return self._scale * call_pardiso(self._solver, BACKWARD, self._system, reduced)

    def _structure(self, matrix: csr_matrix) -> tuple[Array, Array]:
        structure = super()._structure(matrix)
        self._between = np.flatnonzero((self._place[self._half.rows] >= 0) & (self._place[self._half.columns] >= 0))
        return structure

    def _entries(self, matrix: csr_matrix) -> Array:
        return super()._entries(matrix) * self._scale[self._half.rows] * self._scale[self._half.columns]


class CondensedFactors(IterativeSolver):
    """A condensed factor of each system; a solution fails where friction acts on no unknown or on too many, or a factor is not
    exact."""

    name = CondensedPardiso.name
    exact = True

    def __init__(self) -> None:
        self._half: UpperHalf | None = None
        self._scale, self._sizes = np.zeros(0), np.zeros(0)
        self._direct: CondensedPardiso | None = None
        self._unchecked: csr_matrix | None = None

    def factor(self, system: LinearSystem) -> None:
        """Factor a system if friction acts on some of its unknowns; its pattern must be that of the first one."""
        matrix = system.matrix
        if self._half is None:
            self._half, self._scale = UpperHalf.of(matrix), scales(matrix)
            self._sizes = self._scale[self._half.rows] * self._scale[self._half.columns]
        skew = self._half.skew(matrix.data) * self._sizes
        there = np.flatnonzero(~(np.abs(skew) <= SKEW))
        touched = np.union1d(self._half.rows[there], self._half.columns[there])
        if self._direct is None or not self._direct.leaves_out(touched):
            self._choose(touched, system)
        if self._direct is not None:
            self._direct.factor(matrix)
            self._unchecked = matrix

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
            raise ConvergenceError("friction acts on no unknown, or on too many")
        solution, matrix, self._unchecked = self._direct.solve(right), self._unchecked, None
        if matrix is not None and not solves(matrix, solution, right):
            raise ConvergenceError("the pivots of the condensed factor do not suffice")
        return solution

    def close(self) -> None:
        """Release the factor's memory; the next matrix may have another pattern."""
        if self._direct is not None:
            self._direct.close()
        self._direct = self._half = self._unchecked = None

    def _choose(self, touched: Array, system: LinearSystem) -> None:
        """Choose anew what is left out of the factor: what friction touches, and the surface beside it."""
        if self._direct is not None:
            self._direct.close()
        size, surface = system.matrix.shape[0], system.surface
        chosen = np.zeros(size, bool)
        chosen[touched] = True
        beside = system.matrix[surface][:, surface] != 0
        for _ in range(MARGIN):
            chosen[surface] |= beside @ chosen[surface]
        left_out = np.flatnonzero(chosen)
        worth = 0 < len(left_out) <= MOST_LEFT_OUT * np.sqrt(size)
        self._direct = CondensedPardiso(left_out, self._scale) if worth else None


def scales(matrix: csr_matrix) -> Array:
    """Factors (n,) of rows and columns, after which displacements have one on the diagonal, and pressures, of which the entries
    there are negative or zero, one at most beside it."""
    diagonal = matrix.diagonal()
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    beside = np.asarray(abs(matrix).multiply(np.where(diagonal > 0, scale, 0.0)).tocsr().max(axis=1).todense()).ravel()
    return np.where((diagonal <= 0) & (beside > 0), 1 / np.where(beside > 0, beside, 1.0), scale)
