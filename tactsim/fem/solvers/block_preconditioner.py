"""Iterative solution for bodies too large for a factor: flexible GMRES with a block triangular preconditioner for (u, p).

For the tangent [[A, B'], [B, -C]] the residual's forces are first augmented by B' W^-1 times its volumes, then divided by
[[A~, B' (1 - W^-1 C)], [0, -S~]]. W is the lumped mass matrix of the pressures over b G, A~ a cycle of two levels for A and
b G (div u) (div v), S~ the mass matrix over (4/3 + b) G + kappa and C, kappa the stiffness by which a `Body` resists what its
pressures leave of a change of volume. Without W the iterations grow with every refinement, at free
edges: A alone hardly resists a change of volume there. The preconditioner works in single precision, half the memory to read,
and its rounding changes from step to step: GMRES must be the flexible one (51 steps to 1e-8 where the plain one takes 81).

Sources: Elman, Silvester & Wathen 2014, Finite Elements and Fast Iterative Solvers, chapter 9 (block preconditioner); Benzi &
Olshanskii 2006, doi:10.1137/050646421 (augmentation); Saad 1993, doi:10.1137/0914028 (flexible GMRES).
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.linalg import LinearOperator, gcrotmk

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body
from tactsim.fem.solvers.linear import CAUSES, LARGEST_RESIDUAL, LOOSENESS, IterativeSolver, LinearSystem, guiding_solver
from tactsim.fem.solvers.pardiso import of_last_matrix
from tactsim.fem.solvers.tangent_blocks import TangentBlocks
from tactsim.fem.solvers.two_level import TwoLevel

RESTART = 80
"""Search directions before a restart; the systems of a grasp need 4 to 30 for Newton's accuracy."""
MOST_WITH_OLD = 20
"""Search directions with the coarse factor of an earlier system, before it is made anew: a hard state took 67 with it."""
MOST_CYCLES = 6
FINEST = 1e-11
"""Smallest relative error requested; below it, round-off of the stiff contact dominates."""
FINEST_STEP = 1e-3
"""Smallest error of a step that Newton asks for. A step in contact is as good with it: a grasp of 93 660 unknowns takes as many
systems as with 8e-5, the longest of them 17 iterations instead of 21."""
BULK = 1.0
"""b, bulk over shear modulus of the augmentation."""
SHARE = 0.3
"""Fraction of the largest residual that ``linear.solved`` accepts."""


class BlockPreconditioned(IterativeSolver):
    """A solver for the tangents of one body by GMRES; deterministic, its memory is some copies of the matrix.

    The residual is measured without units: each force over the root of its stiffness, each volume over that of its compliance.
    """

    name = "block_preconditioned"
    finest_step = FINEST_STEP

    def __init__(self, body: Body):
        self._displacements, self._dilatation = TwoLevel(body), dilatation(body)
        self._blocks: TangentBlocks | None = None
        shear = body.shear_moduli
        self._mass = pressure_mass(body, (4 / 3 + BULK) * shear + body.volume_stiffness)
        self._lumped = np.asarray(pressure_mass(body, BULK * shear).sum(axis=1)).ravel()
        self._split, self._dim = body.space.displacement_size, body.space.dim
        self._schur = guiding_solver()
        self._factored_schur: Array | None = None
        self._matrix: csr_matrix | None = None
        self.iterations = 0

    def factor(self, system: LinearSystem) -> None:
        """Make the preconditioner of the system's matrix.

        Raises
        ------
        ConvergenceError
            If a part of it is singular or the matrix holds numbers that are not finite.
        """
        split, matrix = self._split, system.matrix
        if not np.isfinite(matrix.data).all():
            raise ConvergenceError("the tangent holds numbers that are not finite")
        self._matrix = matrix
        self._blocks = blocks = self._blocks or TangentBlocks(matrix, split, self._dim)
        self._gradient, self._compliance = blocks.gradient(matrix), blocks.compliance(matrix)
        schur = (self._mass + self._compliance).tocsr()
        schur.sort_indices()
        diagonal = np.concatenate([matrix.diagonal()[:split], schur.diagonal()])
        if not diagonal.all():
            raise ConvergenceError("an unknown has no stiffness; is the material stable?")
        self._scale = 1 / np.sqrt(np.abs(diagonal))
        self._factor_schur(schur)
        self._displacements.factor(*blocks.stiffness(matrix, self._dilatation.data, BULK))

    def _factor_schur(self, schur: csr_matrix) -> None:
        """Factor it unless it is the one that was: that of incompressible tissue never changes."""
        if self._factored_schur is None or not np.array_equal(self._factored_schur, schur.data):
            self._factored_schur = None  # one that fails serves no later system
            self._schur.factor(schur)
            self._factored_schur = schur.data

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,) of the last matrix, its scaled residual over the right-hand side's ``accuracy``.

        Raises
        ------
        ConvergenceError
            If the iteration does not reach it, as with a singular matrix.
        """
        matrix = of_last_matrix(self._matrix)
        solution, left, self.iterations = np.zeros_like(right), right, 0
        size = float(np.linalg.norm(self._scale * right))
        goal = max(accuracy, FINEST) * size
        largest = SHARE * max(LARGEST_RESIDUAL, LOOSENESS * accuracy) * float(np.abs(right).max())
        operator = LinearOperator((len(right),) * 2, matvec=self._scaled_product, dtype=float)
        guide = LinearOperator((len(right),) * 2, matvec=self._scaled_guess, dtype=float)
        for _ in range(MOST_CYCLES):
            if not self._above(left, goal, largest):
                return solution
            now = float(np.linalg.norm(self._scale * left))
            target = goal if now > goal else SHARE * now
            most = RESTART if self._displacements.is_current else MOST_WITH_OLD
            y, _ = gcrotmk(operator, self._scale * left, rtol=0.0, atol=target, M=guide, m=most, k=1, maxiter=1)
            solution = solution + self._scale * y
            left = right - matrix @ solution
            if self._above(left, goal, largest):
                self._displacements.renew()
        if self._above(left, goal, largest):
            raise ConvergenceError(
                f"the iterative solver left {np.linalg.norm(self._scale * left) / size:.1e} of the residual after "
                f"{self.iterations} iterations; {CAUSES}"
            )
        return solution

    def close(self) -> None:
        """Release the factors' memory."""
        self._displacements.close()
        self._schur.close()
        self._matrix = self._factored_schur = None

    def _above(self, left: Array, goal: float, largest: float) -> bool:
        """Whether a residual exceeds the goal, or its largest entry what a solution may leave."""
        return not (np.linalg.norm(self._scale * left) <= 1.01 * goal and np.abs(left).max() <= largest)

    def _scaled_product(self, y: Array) -> Array:
        """The matrix without units times a vector."""
        return self._scale * (self._matrix @ (self._scale * y))

    def _scaled_guess(self, y: Array) -> Array:
        """The preconditioner without units times a vector."""
        self.iterations += 1
        return self._approximate(y / self._scale) / self._scale

    def _approximate(self, residual: Array) -> Array:
        """M^-1 times a residual."""
        split = self._split
        force = residual[:split] + self._gradient @ (residual[split:] / self._lumped)
        pressure = -self._schur.solve(residual[split:])
        effective = pressure - (self._compliance @ pressure) / self._lumped
        return np.concatenate([self._displacements(force - self._gradient @ effective), pressure])


def pressure_mass(body: Body, moduli: Array) -> csr_matrix:
    """Mass matrix of the pressures over a modulus (E,) in Pa, in m^3/Pa, shape (n_pressure, n_pressure)."""
    values, space = body.points.pressure_values, body.space
    blocks = np.einsum("e,eq,qv,qw->evw", 1 / moduli, body.points.weights, values, values)
    pressures = space.pressures
    rows, columns = np.broadcast_arrays(pressures[:, :, None], pressures[:, None, :])
    return csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(len(space.pressure_corners),) * 2)


def dilatation(body: Body) -> bsr_matrix:
    """Stiffness of G (div u) (div v) on the undeformed body in N/m, shape (n d, n d) in blocks."""
    space, points = body.space, body.points
    count, dim = len(space.nodes), space.dim
    rows, columns = np.broadcast_arrays(space.elements[:, :, None], space.elements[:, None, :])
    places, weights = (rows.ravel(), columns.ravel()), body.shear_moduli[:, None] * points.weights
    divergence = [points.gradients[..., i] + (points.hoop if i == 0 else 0.0) for i in range(dim)]
    parts = {}
    for i in range(dim):
        for j in range(dim):
            entries = np.matmul((weights[..., None] * divergence[i]).swapaxes(1, 2), divergence[j])
            parts[i, j] = csr_matrix((entries.ravel(), places), shape=(count, count))
    data = np.stack([[parts[i, j].data for j in range(dim)] for i in range(dim)]).transpose(2, 0, 1)
    return bsr_matrix((np.ascontiguousarray(data), parts[0, 0].indices, parts[0, 0].indptr), shape=(count * dim, count * dim))
