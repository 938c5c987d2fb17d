"""Systems of a body that is its own mirror image, solved for the unknowns of one part."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.solvers.linear import IterativeSolver, LinearSystem, is_solved
from tactsim.fem.solvers.mirror_images import MirrorImages, ReducedMatrices


class MirroredSolver(IterativeSolver):
    """Solves for what stands for all images, and fails where the system is not its own mirror image.

    A grasp of a lump in the middle of a block is mirrored by three planes: of its unknowns an eighth stand for all.

    Parameters
    ----------
    images : of the unknowns
    reduced : gives the reduced matrix of a matrix
    solver : of the reduced systems
    """

    def __init__(self, images: MirrorImages, reduced: ReducedMatrices, solver: IterativeSolver):
        self._images, self._reduced, self._solver = images, reduced, solver
        self._matrix: csr_matrix | None = None

    @property
    def name(self) -> str:  # type: ignore[override]  # of the class elsewhere
        """Of the solver of the reduced systems."""
        return f"{self._solver.name}, mirrored"

    def factor(self, system: LinearSystem) -> None:
        """Take a system and make its preconditioner."""
        self._matrix = system.matrix
        self._solver.factor(LinearSystem(self._reduced.of(system.matrix), lambda: self._reduced.of(system.nearby)))

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,) of the last system; its error over its size may be ``accuracy``.

        Raises
        ------
        InputError
            If there is no system yet.
        ConvergenceError
            If matrix or right-hand side are not their own mirror images, or the reduced system is not solved.
        """
        if self._matrix is None:
            raise InputError("factor a matrix before solving")
        reduced = self._images.reduced(right)
        if np.isfinite(right).all() and is_solved(self._images.whole(reduced), right):
            solution = self._images.whole(self._solver.solve(reduced, accuracy))
            if is_solved(self._matrix @ solution, right, accuracy):
                return solution
        raise ConvergenceError("the system is not its own mirror image")

    def close(self) -> None:
        """Release the memory of the solver."""
        self._solver.close()
        self._matrix = None
