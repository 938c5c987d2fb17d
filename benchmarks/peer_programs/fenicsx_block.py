"""FEniCSx on the block: python3 fenicsx_block.py WARM_UP.npz PROBLEM.npz RESULT.npz. Displacement form, symmetric MUMPS by PETSc.

Run by the system's Python, for which Debian packages it: ``apt-get install --no-install-recommends python3-dolfinx`` (written for
0.5.2, whose names later versions change). One process; the energies are UFL's, whose kernels its setup compiles where its cache,
``~/.cache/fenics``, does not hold them.
"""

from __future__ import annotations

import dolfinx
import numpy as np
import ufl
from clamped_block import Array, Problem, run
from dolfinx import fem, mesh
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

QUADRATURE_DEGREE = 2
"""Four points, as in FElupe and C3D10."""


def isochoric(problem: Problem, displacement: ufl.core.expr.Expr) -> tuple[ufl.core.expr.Expr, list[ufl.core.expr.Expr]]:
    """J, and the isochoric energies per volume of the tissue and of the ball."""
    c10, c01, c11, ball_shear = map(float, [*problem["mooney"], problem["ball_shear"]])
    F = ufl.Identity(3) + ufl.grad(displacement)
    J, C = ufl.det(F), F.T * F
    I1 = J ** (-2 / 3) * ufl.tr(C)
    I2 = (I1**2 - J ** (-4 / 3) * ufl.tr(C * C)) / 2
    return J, [c10 * (I1 - 3) + c01 * (I2 - 3) + c11 * (I1 - 3) * (I2 - 3), ball_shear / 2 * (I1 - 3)]


def energies(problem: Problem, displacement: fem.Function) -> list[ufl.core.expr.Expr]:
    """Energies per volume of the tissue and of the ball, K/2 (J - 1)^2 for the volume."""
    J, changing_shape = isochoric(problem, displacement)
    return [W + float(K) / 2 * (J - 1) ** 2 for W, K in zip(changing_shape, problem["bulk"], strict=True)]


def domain_of(problem: Problem) -> tuple[mesh.Mesh, ufl.Measure]:
    """Straight tetrahedra, and their volume by region."""
    shape = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1))
    points = problem["nodes"][: int(problem["corner_count"])]
    domain = mesh.create_mesh(MPI.COMM_WORLD, problem["elements"][:, :4].astype(np.int64), points, shape)
    cells = np.arange(domain.topology.index_map(3).size_local, dtype=np.int32)
    regions = problem["regions"][domain.topology.original_cell_index].astype(np.int32)
    tags, metadata = mesh.meshtags(domain, 3, cells, regions), {"quadrature_degree": QUADRATURE_DEGREE}
    return domain, ufl.Measure("dx", domain=domain, subdomain_data=tags, metadata=metadata)


class Assembled:
    """Forces and tangent of an energy of some unknowns, and MUMPS."""

    version = dolfinx.__version__

    def __init__(self, unknowns: fem.Function, energy: ufl.form.Form, factor: PETSc.PC.Type) -> None:
        space = unknowns.function_space
        force = ufl.derivative(energy, unknowns, ufl.TestFunction(space))
        self.unknowns, self.force = unknowns, fem.form(force)
        self.tangent = fem.form(ufl.derivative(force, unknowns, ufl.TrialFunction(space)))
        self.matrix = petsc.create_matrix(self.tangent)
        for option in (PETSc.Mat.Option.KEEP_NONZERO_PATTERN, PETSc.Mat.Option.SYMMETRIC):
            self.matrix.setOption(option, True)
        self.solver = PETSc.KSP().create(space.mesh.comm)
        self.solver.setOperators(self.matrix)
        self.solver.setType(PETSc.KSP.Type.PREONLY)
        self.solver.getPC().setType(factor)
        self.solver.getPC().setFactorSolverType(PETSc.Mat.SolverType.MUMPS)

    def forces(self, unknowns: Array) -> Array:
        """Derivative (size,) of the energy by the unknowns: internal forces in N."""
        self.unknowns.x.array[:] = unknowns
        return petsc.assemble_vector(self.force).array.copy()

    def correction(self, unknowns: Array, forces: Array, held: Array, moved: Array) -> Array:
        """Solution (size,) of the linear system whose held rows and columns are struck out."""
        self.unknowns.x.array[:] = unknowns
        self.matrix.zeroEntries()
        petsc.assemble_matrix(self.matrix, self.tangent)
        self.matrix.assemble()
        change, right = (self.matrix.createVecRight() for _ in range(2))
        change.setArray(moved)
        right.setArray(-forces)
        self.matrix.zeroRowsColumns(held.astype(np.int32), diag=1.0, x=change, b=right)
        self.solver.solve(right, change)
        if self.solver.getConvergedReason() < 0:
            raise ValueError(f"MUMPS failed, PETSc's reason {self.solver.getConvergedReason()}")
        return change.array.copy()


class Block(Assembled):
    """Quadratic displacements, one integral for each material."""

    def __init__(self, problem: Problem) -> None:
        domain, measure = domain_of(problem)
        space = fem.VectorFunctionSpace(domain, ("Lagrange", 2))
        self.positions = space.tabulate_dof_coordinates()
        displacement = fem.Function(space)
        energy = sum(value * measure(region) for region, value in enumerate(energies(problem, displacement)))
        super().__init__(displacement, energy, PETSc.PC.Type.CHOLESKY)


if __name__ == "__main__":
    run(Block)
