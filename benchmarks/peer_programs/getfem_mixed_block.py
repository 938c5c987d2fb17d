"""GetFEM on the block in mixed form: python3 getfem_mixed_block.py PROBLEM.npz RESULT.npz.

Run by the system's Python, as ``getfem_block.py``.
"""

from __future__ import annotations

import getfem
import numpy as np
from clamped_block import Array, Problem
from getfem_block import MACROS, QUADRATURE, _version
from mixed_block import run

ENERGIES = (
    "c10*(I1-3)+c01*(I2-3)+c11*(I1-3)*(I2-3)+p*(J-1)-sqr(p)/(2*bulk0)",
    "shear/2*(I1-3)+p*(J-1)-sqr(p)/(2*bulk1)",
)
"""Saddle-point energies of the tissue and of the ball."""


class MixedBlock:
    """Displacements and pressures, one integral for each material."""

    def __init__(self, problem: Problem) -> None:
        self.version = _version()
        getfem.util_trace_level(0)
        mesh = getfem.Mesh("empty", 3)
        corners = problem["nodes"][problem["elements"][:, :4]]
        mesh.add_convex(getfem.GeoTrans("GT_PK(3,1)"), np.asfortranarray(corners.transpose(2, 1, 0)))
        for region in range(len(ENERGIES)):
            chosen = np.flatnonzero(problem["regions"] == region)
            mesh.set_region(region + 1, np.vstack([chosen, np.full_like(chosen, -1)]))
        displacement, pressure = getfem.MeshFem(mesh, 3), getfem.MeshFem(mesh, 1)
        displacement.set_fem(getfem.Fem("FEM_PK(3,2)"))
        pressure.set_fem(getfem.Fem("FEM_PK(3,1)"))
        self.positions = displacement.basic_dof_nodes()[:, ::3].T
        self.model = getfem.Model("real")
        self.model.add_fem_variable("u", displacement)
        self.model.add_fem_variable("p", pressure)
        values = dict(zip(("c10", "c01", "c11"), problem["mooney"], strict=True))
        values |= {"bulk0": problem["bulk"][0], "bulk1": problem["bulk"][1], "shear": problem["ball_shear"]}
        for name, value in values.items():
            self.model.add_initialized_data(name, float(value))
        for name, text in MACROS.items():
            self.model.add_macro(name, text)
        integration = getfem.MeshIm(mesh, getfem.Integ(QUADRATURE))
        self.kept = mesh, displacement, pressure, integration  # the model holds no reference to them
        for region, energy in enumerate(ENERGIES, start=1):
            self.model.add_nonlinear_term(integration, energy, region, True)
        first, count = self.model.interval_of_variable("u")
        self.displacements = np.arange(first, first + count)
        self.size = len(self.model.from_variables())

    def forces(self, unknowns: Array) -> Array:
        """Derivative (size,) of the energy by the unknowns."""
        self.model.to_variables(unknowns)
        self.model.assembly("build_rhs")
        return -self.model.rhs()

    def correction(self, unknowns: Array, forces: Array, held: Array, moved: Array) -> Array:
        """Change (size,) of the unknowns, ``moved`` at ``held``, by which the linearised forces vanish elsewhere."""
        self.model.to_variables(unknowns)
        self.model.assembly("build_matrix")
        tangent = self.model.tangent_matrix()
        free = np.setdiff1d(np.arange(unknowns.size), held)
        change = moved.copy()
        right = -(forces + tangent.mult(moved))[free]
        change[free] = getfem.linsolve_mumps(getfem.Spmat("copy", tangent, free, free), right).ravel()
        return change


if __name__ == "__main__":
    run(MixedBlock)
