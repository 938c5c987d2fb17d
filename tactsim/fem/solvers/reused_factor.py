"""Linear systems that change little: an old factor preconditions the next systems until it no longer pays.

Factoring a sparse matrix of tissue in 3D costs as much as 20 to 70 solutions with the factor, more the larger it is. GMRES needs
fewer than that while the tangent is near to the factored one. It is the flexible one, so that a factor in single precision does.
A factor is replaced once the solutions with it have cost as much as a new one: at worst twice what the best moments would cost.

Source: Saad 1993, doi:10.1137/0914028 (flexible GMRES); Karlin et al. 1988, doi:10.1007/BF01762111 (whether to rent or to buy).
"""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import LinearOperator, gcrotmk

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.solvers.linear import DirectSolver, IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import of_last_matrix

WORTH_A_FACTOR = 30
"""Solutions with a factor that count as much as a new one; the system after them is factored. In processor time a factor costs 18
at 17 600 unknowns, but a coarse block takes 17 systems and 4 factors with 30, and 19 and 6 with 18."""
MOST_OF_ONE = 24
"""Most solutions with an old factor for one system before the system itself is factored."""
MOST_CYCLES = 6
"""Restarts with a new factor; it lacks only the skew part that friction makes."""
FAILED = 1e-6
"""Residual over the right-hand side above which a guide has failed; round-off ends other iterations near 1e-12."""
FINEST = 1e-12
"""Smallest error over its size that is asked of an iteration."""


class ReusedFactor(IterativeSolver):
    """A direct solver that factors rarely; what it returns depends on the systems that it has solved before, to ``accuracy``.

    Parameters
    ----------
    direct : makes the factors
    largest_left : residual over the right-hand side above which the iteration with a new factor is an error, beside twice the
        accuracy; otherwise the user of the solution has to look at it
    largest_error : error of a solution over its size at most, also where more is asked for
    worth : solutions that count as much as a new factor
    most : most solutions with an old factor for one system before the system itself is factored
    """

    def __init__(
        self,
        direct: DirectSolver,
        *,
        largest_left: float = math.inf,
        largest_error: float = math.inf,
        worth: int = WORTH_A_FACTOR,
        most: int = MOST_OF_ONE,
    ):
        self.factorisations = self.solutions = 0
        self.name = f"{direct.name}, reused"
        self._direct, self._largest_left = direct, largest_left
        self._system: LinearSystem | None = None
        self._largest_error, self._worth, self._most = largest_error, worth, most
        self._current, self._spent = False, worth

    def factor(self, system: LinearSystem) -> None:
        """Keep the system; its nearby matrix is factored only once the last factor no longer pays."""
        self._system, self._current = system, False

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,) of the last matrix, its residual over the right-hand side below ``accuracy``.

        Raises
        ------
        ConvergenceError
            If the right-hand side holds numbers that are not finite, or the solution leaves more than it may.
        """
        system = of_last_matrix(self._system)
        if not np.isfinite(right).all():
            raise ConvergenceError("the right-hand side holds numbers that are not finite")
        matrix, begin, accuracy = system.matrix, None, min(accuracy, self._largest_error)
        if not right.any():
            return np.zeros_like(right)
        if not self._current and self._spent < self._worth:
            begin, left = self._iterated(matrix, right, begin, max(accuracy, FINEST), cycles=1)
            if left <= 2 * max(accuracy, FINEST):
                return begin
        if not self._current:
            self._factor_anew(system)
        solution, left = self._iterated(matrix, right, begin, max(accuracy, FINEST), cycles=MOST_CYCLES)
        if not left <= max(2 * accuracy, self._largest_left):
            raise ConvergenceError(
                f"with a new factor ({self._direct.name}) the iteration left {left:.1e} of the right-hand side"
            )
        return solution

    def _factor_anew(self, system: LinearSystem) -> None:
        self._spent = self._worth  # a factor that fails serves no later system
        self._direct.factor(system.nearby)
        self.factorisations += 1
        self._current, self._spent = True, 0

    def close(self) -> None:
        """Release the factor's memory."""
        self._direct.close()
        self._system, self._current, self._spent = None, False, self._worth

    def _iterated(
        self, matrix: csr_matrix, right: Array, begin: Array | None, accuracy: float, *, cycles: int
    ) -> tuple[Array, float]:
        """Solution by flexible GMRES, which measures the true residual even with a rounded factor; that over the right side."""
        guide = LinearOperator(matrix.shape, matvec=self._counted, dtype=float)
        restart = self._most - 1  # and one more direction instead of those of the cycle before
        solution, _ = gcrotmk(matrix, right, begin, rtol=accuracy, M=guide, m=restart, k=1, maxiter=cycles)
        return solution, float(np.linalg.norm(matrix @ solution - right) / np.linalg.norm(right))

    def _counted(self, vector: Array) -> Array:
        self.solutions += 1
        self._spent += 1
        return self._direct.solve(vector)
