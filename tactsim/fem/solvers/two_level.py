"""Two-level cycle for the displacement block of quadratic tissue: relaxation node by node, correction by the linear functions.

The nodes that a contact makes stiff and those of their elements stay in the coarse system: linear functions cannot follow an edge
of contact inside a facet (110 754 unknowns: 39 iterations; without the neighbours none of 486 sufficed). The coarse system alone
moves the nodes that contact rules. Relaxation contracts errors where a matrix is positive; a rigid body of radius R under a
pressure p takes p / R from the stiffness along it, and there relaxation makes them grow (8 208 unknowns: 32 iterations; relaxed,
none sufficed). Source: hierarchies of degree, Rønquist & Patera 1987, doi:10.1007/BF01061297; block Gauss-Seidel, Trottenberg,
Oosterlee & Schüller 2001, chapter 8.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix, diags, hstack

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import ELEMENTS, TaylorHood, tabulate
from tactsim.fem.solvers.linear import guiding_solver

STIFF = 10.0
"""Diagonal over that of the stress-free tissue from which on contact rules a node; large strains stay below three."""
SWEEPS = 2
"""Relaxations before and after the correction: on a grasp of 82 832 unknowns 32 steps to 1e-6 instead of 45, in the same time."""
TURNED = 0.1
"""Change of a node's own block over its size from which on contact acts on it otherwise: it opens, closes, sticks or slips."""
CHANGED, FEW = 0.1, 8
"""Part of the nodes that contact rules on which it may act otherwise, or how many, for a coarse factor to serve further systems.

Why: at a million unknowns it takes most of the time of a system. While contact changes nowhere, the iterations with an old one
are the same; where most points had begun to slip, of a grasp of 381 170 unknowns, a system took 62 instead of 13."""
SERVICE = 60
"""Cycles with one coarse factor: where it no longer fits, the tissue far from where it was, a new one costs about as much."""
YIELDING = 0.2
"""Smallest eigenvalue of a node's symmetric block over that of the stress-free tissue below which contact rules it too."""


@dataclass(frozen=True, eq=False)
class _Ruled:
    """Which ``nodes`` (n,) contact rules, the ``blocks`` (n, d, d) of all, and which unknowns are ``free`` (n, d)."""

    nodes: Array
    blocks: Array
    free: Array

    def resembles(self, other: _Ruled) -> bool:
        """Whether the coarse factor of the other serves this one."""
        either = self.nodes | other.nodes
        now, before = self.blocks[either], other.blocks[either]
        changed = np.linalg.norm(now - before, axis=(1, 2)) > TURNED * np.linalg.norm(before, axis=(1, 2))
        return bool(changed.sum() <= max(CHANGED * len(changed), FEW)) and np.array_equal(self.free, other.free)


class TwoLevel:
    """Approximate inverse of displacement blocks (n d, n d) of one body, symmetric or not, in single precision."""

    def __init__(self, body: Body):
        space = body.space
        self._interpolation = linear_interpolation(space)
        self._diagonal = tissue_diagonal(body)
        self._dim = space.dim
        self._direct = guiding_solver()
        self._pattern: tuple[Array, Array] | None = None
        self._now: _Ruled | None = None
        self._factored: _Ruled | None = None
        self._cycles = 0

    def factor(self, block: bsr_matrix, free: Array) -> None:
        """Take a matrix of ``d x d`` blocks in single precision, its indices sorted, and which unknowns (n, d) are free.

        The coarse factor of an earlier matrix serves as long as contact acts on nearly all nodes as it did, up to ``SERVICE``
        cycles.

        Raises
        ------
        ConvergenceError
            If a node's own block or the coarse system is singular.
        """
        rows = np.repeat(np.arange(block.shape[0] // self._dim), np.diff(block.indptr))
        diagonal = block.data[np.flatnonzero(block.indices == rows)]
        try:
            self._inverses = np.linalg.inv(diagonal.astype(float)).astype(np.float32)
        except np.linalg.LinAlgError as error:
            raise ConvergenceError("the tangent of a node is singular; is the material stable?") from error
        self._block, self._now = block, _Ruled(self._ruled_by_contact(diagonal, free), diagonal, free)
        self._relaxed = np.flatnonzero(~self._now.nodes)
        if self._factored is None or self._cycles >= SERVICE or not self._now.resembles(self._factored):
            self._factor_coarse(self._now)

    @property
    def is_current(self) -> bool:
        """Whether the coarse factor is that of the last matrix."""
        return self._factored is self._now

    def renew(self) -> None:
        """Make the coarse factor of the last matrix, if it is that of an earlier one."""
        if self._now is not None and not self.is_current:
            self._factor_coarse(self._now)

    def _factor_coarse(self, now: _Ruled) -> None:
        dim, block = self._dim, self._block
        count = block.shape[0] // dim
        self._factored = None  # a factor that fails serves no later system
        graph = csr_matrix((np.ones(len(block.indices)), block.indices, block.indptr), shape=(count, count))
        prolongation = blocked(self._coarse_nodes(graph @ now.nodes.astype(float) > 0), now.free)
        coarse = (prolongation.T.tobsr((dim, dim)) @ (block @ prolongation)).tocsr().astype(float)
        coarse.sort_indices()
        self._prolongation, self._restriction = prolongation.tocsr(), prolongation.T.tocsr()
        coarse.setdiag(np.where(coarse.diagonal() == 0, 1.0, coarse.diagonal()))
        pattern = (coarse.indptr, coarse.indices)
        if self._pattern is None or not all(map(np.array_equal, self._pattern, pattern)):
            self._direct.close()  # contact rules other nodes; the analysis of a pattern takes as long as a factor
        self._direct.factor(coarse)
        self._pattern, self._factored, self._cycles = pattern, now, 0

    def __call__(self, right: Array) -> Array:
        """One cycle for a right-hand side (n d,), beginning at zero."""
        self._cycles += 1
        size = float(np.abs(right).max())
        if not size:
            return np.zeros_like(right)
        block, right = self._block, (right / size).astype(np.float32)
        solution = np.zeros_like(right)
        entries = (block.indptr, block.indices, block.data, self._inverses, self._relaxed)
        for _ in range(SWEEPS):
            _sweep(*entries, right, solution, True)
        solution += self._prolongation @ self._direct.solve(self._restriction @ (right - block @ solution)).astype(np.float32)
        for _ in range(SWEEPS):
            _sweep(*entries, right, solution, False)
        return size * solution.astype(float)

    def close(self) -> None:
        """Release the coarse factor."""
        self._direct.close()
        self._pattern = self._factored = None

    def _ruled_by_contact(self, diagonal: Array, free: Array) -> Array:
        """Which nodes (n,) a contact makes much stiffer than their tissue, or takes stiffness from, where they are free (n, d).

        ``diagonal`` (n, d, d) holds their own blocks.
        """
        relative = (diagonal.astype(float) + diagonal.swapaxes(1, 2)) / (2 * self._diagonal[:, None, None])
        nodes, axes = np.nonzero(~free)
        relative[nodes, axes, axes] = 1.0
        eigenvalues = np.linalg.eigvalsh(relative)
        return (eigenvalues.sum(axis=1) > STIFF * self._dim) | (eigenvalues[:, 0] < YIELDING)

    def _coarse_nodes(self, stiff: Array) -> csr_matrix:
        """Interpolation (n, m) from the corners and from the stiff nodes on edges, which stand for themselves."""
        linear = self._interpolation
        count, corners = linear.shape
        edges = corners + np.flatnonzero(stiff[corners:])
        soft = np.ones(count)
        soft[edges] = 0.0
        alone = csr_matrix((np.ones(len(edges)), (edges, np.arange(len(edges)))), shape=(count, len(edges)))
        nodes = hstack([diags(soft) @ linear, alone], format="csr")
        nodes.eliminate_zeros()
        return nodes


def linear_interpolation(space: TaylorHood) -> csr_matrix:
    """Weights (n, n_corner) of the corners at the nodes."""
    quadratic, linear = ELEMENTS[space.dim]
    local, _ = tabulate(linear, np.asarray(quadratic.doflocs).T)
    nodes, first = np.unique(space.elements.ravel(), return_index=True)
    element, place = np.divmod(first, space.elements.shape[1])
    rows = np.repeat(nodes, space.dim + 1)
    corners = space.elements[element, : space.dim + 1]
    weights = csr_matrix((local[place].ravel(), (rows, corners.ravel())), shape=(len(space.nodes), space.corner_count))
    weights.eliminate_zeros()
    return weights


def tissue_diagonal(body: Body) -> Array:
    """Integral (n,) in N/m of the shear modulus times the squared gradient of each node's function, plus the hoop term."""
    points = body.points
    square = (points.gradients**2).sum(axis=-1) + points.hoop**2
    return np.bincount(body.space.elements.ravel(), np.einsum("e,eq,eqa->ea", body.shear_moduli, points.weights, square).ravel())


def blocked(nodes: csr_matrix, free: Array) -> bsr_matrix:
    """Interpolation of vectors by the weights (n, m) of ``nodes`` with zeros where a component (n, d) is not free.

    The first nodes of the coarse space are the corners, which are the first of the fine one; the others are fine nodes.
    """
    dim = free.shape[1]
    columns = np.zeros((nodes.shape[1], dim), bool)
    rows = np.repeat(np.arange(nodes.shape[0]), np.diff(nodes.indptr))
    whole = nodes.data == 1.0
    columns[nodes.indices[whole]] = free[rows[whole]]
    data = np.zeros((nodes.nnz, dim, dim), np.float32)
    for i in range(dim):
        data[:, i, i] = nodes.data * free[rows, i] * columns[nodes.indices, i]
    return bsr_matrix((data, nodes.indices, nodes.indptr), shape=(nodes.shape[0] * dim, nodes.shape[1] * dim))


@numba.njit(cache=True)
def _sweep(indptr, indices, data, inverses, nodes, right, solution, forwards):  # type: ignore[no-untyped-def]
    """Gauss-Seidel over some ``nodes``, in place; ``inverses`` (n, d, d) of the own blocks of all."""
    count, dim = len(nodes), inverses.shape[1]
    left = np.zeros(dim, data.dtype)
    for turn in range(count):
        node = nodes[turn if forwards else count - 1 - turn]
        for i in range(dim):
            left[i] = right[dim * node + i]
        for k in range(indptr[node], indptr[node + 1]):
            other = dim * indices[k]
            for i in range(dim):
                for j in range(dim):
                    left[i] -= data[k, i, j] * solution[other + j]
        for i in range(dim):
            for j in range(dim):
                solution[dim * node + i] += inverses[node, i, j] * left[j]
