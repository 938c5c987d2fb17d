"""Linear systems under stiff contact: symmetric factors without friction, with it condensed ones or, in 3D, a reused one."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.solvers.condensed import CondensedFactors
from tactsim.fem.solvers.linear import FirstSolution, IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import Pardiso, SinglePardiso, SymmetricPardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import FAILED, ReusedFactor

ASYMMETRY = 1e-12
"""Largest difference of x'(A y) and y'(A x), over the sum of the sizes of what is added, that is round-off, for vectors x and y
without order: sections without friction have up to 1e-15."""
WORTH, MOST = 12, 12
"""Solutions that count as much as a new factor, and most with an old one for a system, under stiff contact in 3D."""
LARGEST_ERROR = 1e-4
"""Error of a solution over its size, at most: with 1e-2, which suffices for softer contact, Newton does not find into a block
that sticks to a plate."""


class GeneralFactors(IterativeSolver):
    """MKL Pardiso: a general factor of each system, exact with friction too."""

    name = Pardiso.name
    exact = True

    def __init__(self) -> None:
        self._direct = Pardiso(minimum_degree=True)

    def factor(self, system: LinearSystem) -> None:
        """Factor a system; its pattern must be that of the first one."""
        self._direct.factor(system.matrix)

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Exact solution for one right-hand side (n,) of the last system."""
        return self._direct.solve(right)

    def close(self) -> None:
        """Release the factor's memory; the next matrix may have another pattern."""
        self._direct.close()


class SymmetricFactors(IterativeSolver):
    """MKL Pardiso: a symmetric factor of each system; a solution fails where a system is not symmetric or its factor not exact.

    Pivots are single numbers, chosen by the matching; a section of 32 000 unknowns then takes 52 ms for a factor and 8.7 ms for a
    solution, with blocks as pivots 63 and 13 ms, by the general factor 90 and 11 ms. Where they do not suffice, the residual of
    the first solution says so, which is looked at for every factor.
    """

    name = SymmetricPardiso.name
    exact = True

    def __init__(self) -> None:
        self._direct = SymmetricPardiso(blocks=False, minimum_degree=True)
        self._probes: tuple[Array, Array] | None = None
        self._first = FirstSolution("symmetric")
        self._symmetric = False

    def factor(self, system: LinearSystem) -> None:
        """Factor a system if it is symmetric; its pattern must be that of the first one."""
        self._symmetric = self._is_symmetric(system.matrix)
        if self._symmetric:
            self._direct.factor(system.matrix)
            self._first.awaited(system.matrix)

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Exact solution for one right-hand side (n,) of the last system.

        Raises
        ------
        ConvergenceError
            If the system is not symmetric, or its factor not exact.
        """
        if not self._symmetric:
            raise ConvergenceError("the matrix is not symmetric")
        return self._first.checked(self._direct.solve(right), right)

    def close(self) -> None:
        """Release the factor's memory; the next matrix may have another pattern."""
        self._direct.close()
        self._first.awaited(None)
        self._probes, self._symmetric = None, False

    def _is_symmetric(self, matrix: csr_matrix) -> bool:
        """Whether two vectors find it so: a tenth of the time that every entry and its mirror image take."""
        if self._probes is None:
            generator = np.random.default_rng(0)
            self._probes = generator.standard_normal(matrix.shape[0]), generator.standard_normal(matrix.shape[0])
        x, y = self._probes
        first, second = x * (matrix @ y), y * (matrix @ x)
        return bool(abs(first.sum() - second.sum()) <= ASYMMETRY * (np.abs(first).sum() + np.abs(second).sum()))


def section_factors() -> Relay:
    """Of a section: symmetric factors until one will not do, which is with friction; from then on condensed ones, until friction
    acts on too many unknowns or their pivots do not suffice; from then on general ones.

    Exact steps of Newton's are polished with the factor of the step before, so that `annulus_icf` took 102 systems. A symmetric
    factor in single precision that is reused as the guide of GMRES took 141 for the same states, 77 factors and 1 179 solutions:
    twice the time for the systems where a solution costs a fifth of a factor, as memory is slow.
    """
    return Relay(SymmetricFactors(), CondensedFactors, GeneralFactors)


def solid_factors() -> Relay:
    """Of a body in 3D: symmetric factors until one will not do; from then on one in single precision, of the part that
    friction does not couple, guides the iteration for as long as it pays; general factors where that fails.

    A factor costs more solutions than in a section: with friction `annulus_tilted_3d` takes two thirds of the time that general
    factors of all systems would. In the order of nested dissection its factors take a tenth less time, and the same share is lost
    to more solutions, which are slower.
    """

    def guided() -> ReusedFactor:
        single = SinglePardiso(minimum_degree=True)
        return ReusedFactor(single, largest_left=FAILED, largest_error=LARGEST_ERROR, worth=WORTH, most=MOST)

    return Relay(SymmetricFactors(), guided, lambda: ReusedFactor(Pardiso(), largest_error=LARGEST_ERROR))
