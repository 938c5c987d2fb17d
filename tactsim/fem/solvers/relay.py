"""A fast solver, and sturdier ones that take over for good where it fails."""

from __future__ import annotations

from collections.abc import Callable

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.solvers.linear import IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import of_last_matrix


class Relay(IterativeSolver):
    """The first of some solvers until it fails with a system, from then on the next; only the last one's failure is an error.

    Parameters
    ----------
    first : the fastest
    others : make the sturdier ones, in this order
    """

    def __init__(self, first: IterativeSolver, *others: Callable[[], IterativeSolver]):
        self.current = first
        self._others = list(others)
        self._system: LinearSystem | None = None

    @property
    def name(self) -> str:  # type: ignore[override]  # of the class elsewhere
        """Of the solver that solves now."""
        return self.current.name

    @property
    def exact(self) -> bool:  # type: ignore[override]  # of the class elsewhere
        """Whether that one is."""
        return self.current.exact

    @property
    def finest_step(self) -> float:  # type: ignore[override]  # of the class elsewhere
        """Of the solver that solves now."""
        return self.current.finest_step

    def factor(self, system: LinearSystem) -> None:
        """Take a system and make its factor or preconditioner.

        Raises
        ------
        ConvergenceError
            If the last of the solvers fails.
        """
        self._system = system
        try:
            self.current.factor(system)
        except ConvergenceError:
            if not self._others:
                raise
            self._hand_on(system)

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,) of the last system; its error over its size may be ``accuracy``.

        Raises
        ------
        ConvergenceError
            If the last of the solvers fails.
        """
        system = of_last_matrix(self._system)
        try:
            return self.current.solve(right, accuracy)
        except ConvergenceError:
            if not self._others:
                raise
            self._hand_on(system)
            return self.solve(right, accuracy)

    def close(self) -> None:
        """Release the memory of the solver that solves now."""
        self.current.close()
        self._system = None

    def _hand_on(self, system: LinearSystem) -> None:
        """Give the system to the next solver."""
        self.current.close()
        self.current = self._others.pop(0)()
        self.factor(system)
