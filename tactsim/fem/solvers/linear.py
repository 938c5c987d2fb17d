"""Linear systems: what a solver offers, SuperLU, the choice of a direct solver, and solutions that are checked."""

from __future__ import annotations

import importlib.util
import platform
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.solvers.pardiso import Pardiso, SinglePardiso, SymmetricPardiso, of_last_matrix

LARGEST_RESIDUAL = 1e-3
"""Largest residual over the right-hand side: solvable systems leave about 1e-13, stiff contact included, singular ones 1."""
LOOSENESS = 10.0
"""How much larger the largest entry of a residual may be, relatively, than its accuracy in the mean."""

CAUSES = (
    "is the body held against moving as a whole, has an incompressible one a face that is free (confined on all sides it cannot "
    "change its shape, and its pressure is arbitrary), and is the material stable?"
)
"""What to ask of a singular system."""


EXACT = 1e-9
"""Largest residual of the first solution with a factor that counts as exact, over its right-hand side: 1e-15 where the pivots
suffice."""


@dataclass(frozen=True)
class LinearSystem:
    """A ``matrix``, and what helps to solve it, made only where it is used.

    Attributes
    ----------
    matrix : of the system
    make_nearby : makes a nearly symmetric one whose factor preconditions it as well
    make_surface : makes the numbers (m,) of the unknowns at which contact may act
    """

    matrix: csr_matrix
    make_nearby: Callable[[], csr_matrix] | None = None
    make_surface: Callable[[], Array] | None = None

    @property
    def nearby(self) -> csr_matrix:
        """The nearby matrix, by default the matrix itself."""
        return self.matrix if self.make_nearby is None else self.make_nearby()

    @property
    def surface(self) -> Array:
        """Numbers (k,) of the unknowns at which contact may act, by default none."""
        return np.zeros(0, int) if self.make_surface is None else self.make_surface()


class DirectSolver(Protocol):
    """Factors matrices of one sparse pattern; the symbolic analysis is made once."""

    name: str

    def factor(self, matrix: csr_matrix) -> None:
        """Factor a matrix; its pattern must be that of the first one."""

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,) of the last matrix; raises InputError if there is none."""

    def close(self) -> None:
        """Release the factor's memory."""


class IterativeSolver(ABC):
    """Solves systems of one sparse pattern to a requested accuracy."""

    name: str
    exact: bool = False
    """Whether it solves exactly whatever the accuracy asked for, by a factor of the last system."""
    finest_step: float = 0.0
    """Error of a step of Newton's over its size below which further iterations cost more than the next step."""

    @abstractmethod
    def factor(self, system: LinearSystem) -> None:
        """Take a system and make its preconditioner."""

    @abstractmethod
    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,) of the last system; its error over its size may be ``accuracy``.

        Raises
        ------
        InputError
            If there is no system yet.
        """

    @abstractmethod
    def close(self) -> None:
        """Release the preconditioner's memory."""


LinearSolver = DirectSolver | IterativeSolver


class FirstSolution:
    """Looks at the residual of the first solution with each factor of a ``kind``, whose pivots may not suffice."""

    def __init__(self, kind: str) -> None:
        self._kind = kind
        self._matrix: csr_matrix | None = None

    def awaited(self, matrix: csr_matrix | None) -> None:
        """The next solution will be the first with a factor of this matrix; None: with none."""
        self._matrix = matrix

    def checked(self, solution: Array, right: Array) -> Array:
        """The solution (n,) of a right-hand side (n,).

        Raises
        ------
        ConvergenceError
            If it is the first with its factor and not exact.
        """
        matrix, self._matrix = self._matrix, None
        if matrix is not None and not np.abs(matrix @ solution - right).max() <= EXACT * np.abs(right).max():
            raise ConvergenceError(f"the pivots of the {self._kind} factor do not suffice")
        return solution


def is_exact(solver: LinearSolver) -> bool:
    """Whether its solutions are exact ones of the last system, by a factor that it keeps."""
    return not isinstance(solver, IterativeSolver) or solver.exact


def finest_step(solver: LinearSolver) -> float:
    """Smallest error of a step over its size that Newton asks of a solver; of a direct one, which is exact, none."""
    return solver.finest_step if isinstance(solver, IterativeSolver) else 0.0


class SuperLU:
    """scipy's SuperLU, where Pardiso does not install."""

    name = "superlu"

    def __init__(self) -> None:
        self._factor: Any = None

    def factor(self, matrix: csr_matrix) -> None:
        """Factor the matrix with a minimum-degree order.

        Raises
        ------
        ConvergenceError
            If the matrix is singular.
        """
        from scipy.sparse.linalg import splu

        try:
            self._factor = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": False})
        except RuntimeError as error:
            raise ConvergenceError(f"the sparse direct solver failed ({error}); {CAUSES}") from error

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,)."""
        return of_last_matrix(self._factor).solve(right)

    def close(self) -> None:
        """Drop the factor."""
        self._factor = None


def solved(solver: LinearSolver, system: LinearSystem | csr_matrix, right: Array, accuracy: float = 0.0) -> Array:
    """Checked solution (n,) of one linear system, to an error over its size of ``accuracy`` by an iterative solver.

    Neither solver reports a singular matrix reliably: both replace zero pivots and return huge numbers.

    Raises
    ------
    ConvergenceError
        If the matrix is singular and the right-hand side not in its range, or holds numbers that are not finite.
    """
    system = system if isinstance(system, LinearSystem) else LinearSystem(system)
    if isinstance(solver, IterativeSolver):
        solver.factor(system)
    else:
        solver.factor(system.matrix)
    return resolved(solver, system.matrix, right, accuracy)


def resolved(solver: LinearSolver, matrix: csr_matrix, right: Array, accuracy: float = 0.0) -> Array:
    """Solution (n,) for another right-hand side with the factor that the solver holds.

    Raises
    ------
    ConvergenceError
        As ``solved``.
    """
    solution = solver.solve(right, accuracy) if isinstance(solver, IterativeSolver) else solver.solve(right)
    left = float(np.abs(matrix @ solution - right).max())
    if not left <= max(LARGEST_RESIDUAL, LOOSENESS * accuracy) * float(np.abs(right).max()):
        raise ConvergenceError(
            f"the linear system is singular (largest step {np.abs(solution).max():.2e}, left over {left:.2e} "
            f"of {np.abs(right).max():.2e}); {CAUSES}"
        )
    return solution


def has_pardiso() -> bool:
    """Whether Pardiso is installed, and runs on this machine."""
    return importlib.util.find_spec("pypardiso") is not None and platform.machine() in ("x86_64", "AMD64")


def direct_solver(name: str | None = None) -> DirectSolver:
    """The solver of this name (pardiso_single, pardiso_symmetric, pardiso or superlu), by default the fastest that is installed.

    Raises
    ------
    InputError
        If there is no such solver.
    """
    if name is None:
        name = Pardiso.name if has_pardiso() else SuperLU.name
    kinds: dict[str, type[Pardiso] | type[SuperLU]] = {
        kind.name: kind for kind in (SinglePardiso, SymmetricPardiso, Pardiso, SuperLU)
    }
    if name not in kinds:
        raise InputError(f"unknown linear solver {name!r}; allowed: {', '.join(kinds)}")
    return kinds[name]()


def guiding_solver() -> DirectSolver:
    """The solver of systems whose solutions guide an iteration: in single precision where that is there."""
    return Pardiso(single=True) if has_pardiso() else SuperLU()
