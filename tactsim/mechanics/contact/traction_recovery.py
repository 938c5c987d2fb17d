r"""A smooth contact traction that does the work of the computed one: what the taxels of a sensor are cut out of.

The traction of a finite element solution swings within each facet, and how far depends on the mesh. Its work against smooth
virtual displacements converges twice as fast (Babuska & Miller 1984, doi:10.1002/nme.1620200610), so that only this work is kept.
With the nodal forces :math:`R`, the mass matrix M and

.. math:: S = (M + c K)^{-1} M, \qquad \lambda = \left[I - (I - S)^3\right] M^{-1} R

where K is the stiffness of a Laplacian in which every facet is an equilateral triangle of side 1. Of a wave of n sides the part
:math:`1 - (x / (1 + x))^3` with :math:`x = c (2 \pi / n)^2` stays. The sum of all forces stays to round-off, and so does a
constant traction.
"""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.fem.assembly.space import quadratic_values

SMOOTHING = 0.1
"""c: a wave of one side of a facet, the shortest that its nodes follow, keeps half; one of two sides 88 %, one of four 99.2 %."""
ROUNDS = 3
"""Terms of the smoothing: the error it makes of a smooth traction is of the sixth order in the length of a side."""
_METRIC = np.array([[4.0, -2.0], [-2.0, 4.0]]) / 3
"""Scalar product of gradients on the reference triangle that is the ordinary one on an equilateral triangle of side 1."""


def recovered_forces(facets: Array, forces: Array, weights: Array, points: Array) -> Array:
    """Traction times weight (3, F, Q) in N at the quadrature points of facets, smooth, of the same nodal work over some facets.

    Parameters
    ----------
    facets : (F, 6) node numbers, corners, then mid-sides 01, 12, 02; those without force keep none
    forces : (3, F, Q) computed traction times weight in N
    weights : (F, Q) in m^2
    points : (Q, 2) the points on the reference triangle
    """
    pressed = np.abs(forces).sum(axis=(0, 2)) > 0
    smooth = np.zeros_like(forces)
    if not pressed.any():
        return smooth
    values, gradients = quadratic_values(points.T)
    nodes, numbers = np.unique(facets[pressed], return_inverse=True)
    numbers, area = numbers.reshape(-1, facets.shape[1]), weights[pressed]
    mass = _assembled(np.einsum("fq,qa,qb->fab", area, values, values), numbers)
    stiffness = _assembled(np.einsum("fq,qai,ij,qbj->fab", area, gradients, _METRIC, gradients), numbers)
    work = np.einsum("cfq,qa->cfa", forces[:, pressed], values)
    reactions = np.stack([np.bincount(numbers.ravel(), part.ravel(), len(nodes)) for part in work], axis=1)
    damped = scipy.sparse.linalg.splu(mass + SMOOTHING * stiffness)
    first = traction = damped.solve(reactions)
    for _ in range(ROUNDS - 1):
        traction = traction + first - damped.solve(mass @ traction)
    smooth[:, pressed] = np.einsum("qa,fac,fq->cfq", values, traction[numbers], area)
    return smooth


def _assembled(blocks: Array, numbers: Array) -> scipy.sparse.csc_matrix:
    """The matrix of blocks (F, 6, 6) at nodes (F, 6)."""
    rows, columns = (np.broadcast_to(part, blocks.shape) for part in (numbers[:, :, None], numbers[:, None]))
    return scipy.sparse.csc_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())))


def shape_functions(x: Array) -> Array:
    """Quadratic shape functions at reference points (..., 2): corners, then mid-sides 01, 12, 02, shape (..., 6)."""
    values, _ = quadratic_values(x.reshape(-1, 2).T)
    return values.reshape(*x.shape[:-1], -1)
