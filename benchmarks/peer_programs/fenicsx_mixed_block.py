"""FEniCSx on the block in mixed form: python3 fenicsx_mixed_block.py PROBLEM.npz RESULT.npz.

Run by the system's Python, as ``fenicsx_block.py``.
"""

from __future__ import annotations

import numpy as np
import ufl
from clamped_block import Problem
from dolfinx import fem
from fenicsx_block import Assembled, domain_of, isochoric
from mixed_block import run
from petsc4py import PETSc


def energies(problem: Problem, displacement: ufl.core.expr.Expr, pressure: ufl.core.expr.Expr) -> list[ufl.core.expr.Expr]:
    """Saddle-point energies per volume of the tissue and of the ball."""
    J, changing_shape = isochoric(problem, displacement)
    return [W + pressure * (J - 1) - pressure**2 / (2 * float(K)) for W, K in zip(changing_shape, problem["bulk"], strict=True)]


class MixedBlock(Assembled):
    """Quadratic displacements and linear pressures, one integral for each material."""

    def __init__(self, problem: Problem) -> None:
        domain, measure = domain_of(problem)
        quadratic, linear = ufl.VectorElement("Lagrange", ufl.tetrahedron, 2), ufl.FiniteElement("Lagrange", ufl.tetrahedron, 1)
        space = fem.FunctionSpace(domain, ufl.MixedElement(quadratic, linear))
        displacements, numbers = space.sub(0).collapse()
        self.positions, self.displacements = displacements.tabulate_dof_coordinates(), np.array(numbers)
        unknowns = fem.Function(space)
        self.size = unknowns.x.array.size
        energy = sum(value * measure(region) for region, value in enumerate(energies(problem, *ufl.split(unknowns))))
        super().__init__(unknowns, energy, PETSc.PC.Type.LU)


if __name__ == "__main__":
    run(MixedBlock)
