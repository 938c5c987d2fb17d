"""Factors of matrices that are symmetric as long as no friction acts: half the work while they are, the general factor after."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.fem.solvers.pardiso import Pardiso, SymmetricPardiso

ASYMMETRY = 1e-12
"""Largest difference of x'(A y) and y'(A x), over the sum of the sizes of what is added, that is round-off, for vectors x and y
without order: sections without friction have up to 1e-15."""
EXACT = 1e-9
"""Largest residual of the first solution with a symmetric factor, over its right-hand side: 1e-15 where the pivots suffice."""


class SymmetricWhereItIs:
    """MKL Pardiso: the symmetric factor until a matrix is not symmetric or that factor not exact, from then on the general one.

    Pivots are single numbers, chosen by the matching; a section of 32 000 unknowns then takes 52 ms for a factor and 8.7 ms for a
    solution, with blocks as pivots 63 and 13 ms, by the general factor 90 and 11 ms. Where they do not suffice, the residual of
    the first solution says so, which is looked at for every factor.
    """

    def __init__(self) -> None:
        self._symmetric = SymmetricPardiso(blocks=False)
        self._inner: Pardiso = self._symmetric
        self.name = self._symmetric.name
        self._probes: tuple[Array, Array] | None = None
        self._unchecked: csr_matrix | None = None

    def factor(self, matrix: csr_matrix) -> None:
        """Factor a matrix; its pattern must be that of the first one."""
        if self._inner is self._symmetric and not self._is_symmetric(matrix):
            self._turn_general()
        self._unchecked = matrix if self._inner is self._symmetric else None
        self._inner.factor(matrix)

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,) of the last matrix.

        Raises
        ------
        InputError
            If no matrix was factored.
        """
        solution, matrix, self._unchecked = self._inner.solve(right), self._unchecked, None
        if matrix is None or np.abs(matrix @ solution - right).max() <= EXACT * np.abs(right).max():
            return solution
        self._turn_general()
        self._inner.factor(matrix)
        return self._inner.solve(right)

    def close(self) -> None:
        """Release the factor's memory; the next matrix may have another pattern."""
        self._inner.close()
        self._probes = self._unchecked = None

    def _turn_general(self) -> None:
        self._inner.close()
        self._inner = Pardiso()
        self.name = self._inner.name

    def _is_symmetric(self, matrix: csr_matrix) -> bool:
        """Whether two vectors find it so: a tenth of the time that every entry and its mirror image take."""
        if self._probes is None:
            generator = np.random.default_rng(0)
            self._probes = generator.standard_normal(matrix.shape[0]), generator.standard_normal(matrix.shape[0])
        x, y = self._probes
        first, second = x * (matrix @ y), y * (matrix @ x)
        return bool(abs(first.sum() - second.sum()) <= ASYMMETRY * (np.abs(first).sum() + np.abs(second).sum()))
