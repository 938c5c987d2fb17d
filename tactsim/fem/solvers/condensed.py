"""Systems that friction makes unsymmetric at a few unknowns: these are left out of a symmetric factor, and solved densely.

With the unknowns where friction acts last, the matrix is [[A, B], [B', C + D]], symmetric but for D. MKL Pardiso factors A, for
half the operations of a general factor, and returns the Schur complement C - B' A^-1 B of the others, to which D is added. Two
substitutions with the factor, and a dense solution between them, solve the whole.

Source: Haynsworth 1968, doi:10.1016/0024-3795(68)90050-5 (the complement); oneMKL Developer Reference, pardiso, iparm[35].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.solvers.linear import FirstSolution, IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import SymmetricPardiso, UpperHalf, of_last_matrix
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


@dataclass(frozen=True)
class ScaledHalf:
    """Entries on and above the diagonal of matrices of one pattern, scaled.

    Attributes
    ----------
    half : where they stand
    scale : (n,) factors of the rows and columns
    sizes : (k,) those of the entries
    """

    half: UpperHalf
    scale: Array
    sizes: Array

    @classmethod
    def of(cls, matrix: csr_matrix) -> ScaledHalf:
        """By the entries of this matrix."""
        half, scale = UpperHalf.of(matrix), scales(matrix)
        return cls(half, scale, scale[half.rows] * scale[half.columns])

    def symmetric(self, matrix: csr_matrix) -> Array:
        """Entries (k,) of the symmetric part."""
        return self.half.symmetric(matrix.data) * self.sizes

    def skew(self, matrix: csr_matrix, some: Array | slice = slice(None)) -> Array:
        """Entries (k,) of the skew part, or ``some`` of them."""
        return self.half.skew(matrix.data, some) * self.sizes[some]


class CondensedPardiso(SymmetricPardiso):
    """MKL Pardiso: the symmetric factor of all unknowns but some, and a dense general one of their Schur complement.

    Pardiso neither scales nor matches then, so that the matrix comes scaled, or else residuals in a section are 4e-10 of the
    right-hand side instead of 3e-15. In one of 7 976 unknowns of which 168 are left out, a factor takes 10.7 ms and a solution
    2.0 ms; a general factor takes 16.5 ms and a solution 2.4 ms.

    The order is that of minimum degree, as fast here. With nested dissection, the analysis of MKL 2026.2 ends a process now and
    then: it takes the last separator of n unknowns, m of them left out, to reach to 2 n - m + 1, and reads a table of n there.

    Parameters
    ----------
    scaled : the pattern of the matrices, and how they are scaled
    left_out : numbers (m,) of unknowns, rising; only between these may a matrix be unsymmetric
    """

    name = "pardiso_condensed"

    def __init__(self, scaled: ScaledHalf, left_out: Array) -> None:
        super().__init__(minimum_degree=True)
        self._scaled, self._left_out = scaled, left_out
        self._place = np.full(len(scaled.scale), -1)
        self._place[left_out] = np.arange(len(left_out))
        rows, columns = self._place[scaled.half.rows], self._place[scaled.half.columns]
        self._between = np.flatnonzero((rows >= 0) & (columns >= 0))
        self._rows, self._columns = rows[self._between], columns[self._between]
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
        skew = self._scaled.skew(matrix, self._between)
        complement[self._rows, self._columns] += skew
        complement[self._columns, self._rows] -= skew
        self._dense = lu_factor(complement, overwrite_a=True, check_finite=False)

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,)."""
        system = of_last_matrix(self._system)
        reduced = call_pardiso(self._solver, FORWARD, system, self._scaled.scale * right)
        reduced[self._left_out] = lu_solve(self._dense, reduced[self._left_out], check_finite=False)
        return self._scaled.scale * call_pardiso(self._solver, BACKWARD, system, reduced)

    def _structure(self, matrix: csr_matrix) -> tuple[Array, Array]:
        return self._scaled.half.structure(matrix.shape[0])

    def _entries(self, matrix: csr_matrix) -> Array:
        return self._scaled.symmetric(matrix)


class CondensedFactors(IterativeSolver):
    """A condensed factor of each system; a solution fails where friction acts on no unknown or on too many, or a factor is not
    exact."""

    name = CondensedPardiso.name
    exact = True

    def __init__(self) -> None:
        self._scaled: ScaledHalf | None = None
        self._direct: CondensedPardiso | None = None
        self._first = FirstSolution("condensed")

    def factor(self, system: LinearSystem) -> None:
        """Factor a system if friction acts on some of its unknowns; its pattern must be that of the first one."""
        matrix = system.matrix
        if self._scaled is None:
            self._scaled = ScaledHalf.of(matrix)
        there = np.flatnonzero(~(np.abs(self._scaled.skew(matrix)) <= SKEW))
        touched = np.union1d(self._scaled.half.rows[there], self._scaled.half.columns[there])
        if self._direct is None or not self._direct.leaves_out(touched):
            if self._direct is not None:
                self._direct.close()
            left_out = _left_out(touched, system)
            self._direct = CondensedPardiso(self._scaled, left_out) if len(left_out) else None
        if self._direct is not None:
            self._direct.factor(matrix)
            self._first.awaited(matrix)

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Exact solution for one right-hand side (n,) of the last system.

        Raises
        ------
        ConvergenceError
            If friction acts on no unknown or on too many, or the factor is not exact.
        """
        of_last_matrix(self._scaled)
        if self._direct is None:
            raise ConvergenceError("friction acts on no unknown, or on too many")
        return self._first.checked(self._direct.solve(right), right)

    def close(self) -> None:
        """Release the factor's memory; the next matrix may have another pattern."""
        if self._direct is not None:
            self._direct.close()
        self._first.awaited(None)
        self._direct = self._scaled = None


def _left_out(touched: Array, system: LinearSystem) -> Array:
    """What is left out of the factor (m,), rising: what friction touches, and the surface beside it; none if that is too much."""
    size, surface = system.matrix.shape[0], system.surface
    chosen = np.zeros(size, bool)
    chosen[touched] = True
    beside = system.matrix[surface][:, surface] != 0
    for _ in range(MARGIN):
        chosen[surface] |= beside @ chosen[surface]
    left_out = np.flatnonzero(chosen)
    return left_out if len(left_out) <= MOST_LEFT_OUT * np.sqrt(size) else left_out[:0]


def scales(matrix: csr_matrix) -> Array:
    """Factors (n,) of rows and columns, after which displacements have one on the diagonal, and pressures, of which the entries
    there are negative or zero, one at most beside it."""
    diagonal = matrix.diagonal()
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    beside = np.asarray(abs(matrix).multiply(np.where(diagonal > 0, scale, 0.0)).tocsr().max(axis=1).todense()).ravel()
    return np.where((diagonal <= 0) & (beside > 0), 1 / np.where(beside > 0, beside, 1.0), scale)
