"""Linear systems under stiff contact, of sections above all: symmetric factors without friction, with it one that is reused."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.fem.solvers.linear import IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import Pardiso, SinglePardiso, SymmetricPardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import FAILED, ReusedFactor

ASYMMETRY = 1e-12
"""Largest difference of x'(A y) and y'(A x), over the sum of the sizes of what is added, that is round-off, for vectors x and y
without order: sections without friction have up to 1e-15."""
EXACT = 1e-9
"""Largest residual of the first solution with a symmetric factor, over its right-hand side: 1e-15 where the pivots suffice."""
WORTH, MOST = 12, 12
"""Solutions that count as much as a new factor, and most with an old one for a system: in a section of 8 000 unknowns a factor in
single precision takes 7.7 ms and a solution 0.66 ms."""
LARGEST_ERROR = 1e-4
"""Error of a solution over its size, at most. The contact of sections is stiff: with 1e-2, which suffices in space, `annulus_icf`
takes 165 systems instead of 141, no time less and other steps, and Newton does not find into a block that sticks to a plate."""


class SectionSolver(IterativeSolver):
    """MKL Pardiso: a symmetric factor of each system until one is not symmetric or that factor not exact; from then on one in
    single precision, of the part that friction does not couple, guides the iteration for as long as it pays.

    Pivots are single numbers, chosen by the matching; a section of 32 000 unknowns then takes 52 ms for a factor and 8.7 ms for a
    solution, with blocks as pivots 63 and 13 ms, by the general factor 90 and 11 ms. Where they do not suffice, the residual of
    the first solution says so, which is looked at for every factor. With friction a reused factor takes a fifth (`annulus_icf`)
    to a third (`switch_tissues_fem`) less time than general factors of all systems, in space under as stiff a contact half
    (`annulus_tilted_3d`).
    """

    def __init__(self) -> None:
        self._symmetric = SymmetricPardiso(blocks=False)
        self._guided: IterativeSolver | None = None
        self._probes: tuple[Array, Array] | None = None
        self._system: LinearSystem | None = None
        self._checked = False

    @property
    def name(self) -> str:  # type: ignore[override]  # of the class elsewhere
        """Of the solver that solves now."""
        return self._symmetric.name if self._guided is None else self._guided.name

    @property
    def exact(self) -> bool:  # type: ignore[override]  # of the class elsewhere
        """As long as every system is symmetric."""
        return self._guided is None

    def factor(self, system: LinearSystem) -> None:
        """Factor a system, or keep it for the iteration; its pattern must be that of the first one."""
        self._system, self._checked = system, False
        if self._guided is None and self._is_symmetric(system.matrix):
            self._symmetric.factor(system.matrix)
        else:
            self._guide().factor(system)

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,) of the last system; its error over its size may be ``accuracy``.

        Raises
        ------
        InputError
            If there is no system yet.
        ConvergenceError
            If no factor solves it.
        """
        if self._system is None:
            raise InputError("factor a matrix before solving")
        if self._guided is not None:
            return self._guided.solve(right, min(accuracy, LARGEST_ERROR))
        solution = self._symmetric.solve(right)
        if self._checked or np.abs(self._system.matrix @ solution - right).max() <= EXACT * np.abs(right).max():
            self._checked = True
            return solution
        guided = self._guide()
        guided.factor(self._system)
        return guided.solve(right, min(accuracy, LARGEST_ERROR))

    def close(self) -> None:
        """Release the memory of the factors; the next matrix may have another pattern."""
        self._symmetric.close()
        if self._guided is not None:
            self._guided.close()
        self._probes = self._system = None

    def _guide(self) -> IterativeSolver:
        """The iteration; general factors take over where it fails."""
        if self._guided is None:
            self._symmetric.close()
            first = ReusedFactor(SinglePardiso(minimum_degree=True), largest_left=FAILED, worth=WORTH, most=MOST)
            self._guided = Relay(first, lambda: ReusedFactor(Pardiso()))
        return self._guided

    def _is_symmetric(self, matrix: csr_matrix) -> bool:
        """Whether two vectors find it so: a tenth of the time that every entry and its mirror image take."""
        if self._probes is None:
            generator = np.random.default_rng(0)
            self._probes = generator.standard_normal(matrix.shape[0]), generator.standard_normal(matrix.shape[0])
        x, y = self._probes
        first, second = x * (matrix @ y), y * (matrix @ x)
        return bool(abs(first.sum() - second.sum()) <= ASYMMETRY * (np.abs(first).sum() + np.abs(second).sum()))
