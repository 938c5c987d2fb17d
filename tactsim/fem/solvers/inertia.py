"""How many eigenvalues of a symmetric matrix are negative, which its factor tells without any of them being computed."""

from __future__ import annotations

from scipy.sparse import csr_matrix

from tactsim.fem.solvers.pardiso import SymmetricPardiso

PERTURBED, NEGATIVE = 13, 22
"""Which of Pardiso's settings hold the pivots that it perturbed and the negative eigenvalues (oneMKL Developer Reference,
pardiso iparm)."""


class Inertia(SymmetricPardiso):
    """The signs of the pivots of a factor with blocks of two by two: those of the eigenvalues (Sylvester 1852)."""

    name = "pardiso_inertia"

    def negative(self, matrix: csr_matrix) -> int | None:
        """Number of the negative eigenvalues of a symmetric matrix; None if a pivot was so small that it has no sign."""
        self.factor(matrix)
        return None if self._solver.iparm[PERTURBED] else int(self._solver.iparm[NEGATIVE])
