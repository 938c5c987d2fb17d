"""GetFEM on the block: python3 getfem_block.py WARM_UP.npz PROBLEM.npz RESULT.npz. Displacement form, MUMPS.

Run by the system's Python, for which Debian packages it: ``apt-get install --no-install-recommends python3-getfem`` (written for
5.4.2). The energies are in GetFEM's own language, and it differentiates them; its Python interface to MUMPS factors by LU.
"""

from __future__ import annotations

import shutil
import subprocess

import getfem
import numpy as np
from clamped_block import Array, Problem, run

QUADRATURE = "IM_TETRAHEDRON(2)"
"""Four points, as in FElupe and C3D10."""
MATERIALS = ("c10*(I1-3)+c01*(I2-3)+c11*(I1-3)*(I2-3)+bulk0/2*sqr(J-1)", "shear/2*(I1-3)+bulk1/2*sqr(J-1)")
"""Energies of the tissue and of the ball."""
MACROS = {
    "F": "Id(3)+Grad_u",
    "J": "Det(F)",
    "I1": "Matrix_j1(Right_Cauchy_Green(F))",
    "I2": "Matrix_j2(Right_Cauchy_Green(F))",
}
"""Matrix_j1 and Matrix_j2 are the invariants of C without its change of volume."""


class Block:
    """Quadratic displacements on straight tetrahedra, one region of convexes for each material."""

    def __init__(self, problem: Problem) -> None:
        self.version = _version()
        getfem.util_trace_level(0)
        mesh = getfem.Mesh("empty", 3)
        corners = problem["nodes"][problem["elements"][:, :4]]
        mesh.add_convex(getfem.GeoTrans("GT_PK(3,1)"), np.asfortranarray(corners.transpose(2, 1, 0)))
        for region in range(len(MATERIALS)):
            chosen = np.flatnonzero(problem["regions"] == region)
            mesh.set_region(region + 1, np.vstack([chosen, np.full_like(chosen, -1)]))
        space = getfem.MeshFem(mesh, 3)
        space.set_fem(getfem.Fem("FEM_PK(3,2)"))
        self.positions = space.basic_dof_nodes()[:, ::3].T
        self.model = getfem.Model("real")
        self.model.add_fem_variable("u", space)
        values = dict(zip(("c10", "c01", "c11"), problem["mooney"], strict=True))
        values |= {"bulk0": problem["bulk"][0], "bulk1": problem["bulk"][1], "shear": problem["ball_shear"]}
        for name, value in values.items():
            self.model.add_initialized_data(name, float(value))
        for name, text in MACROS.items():
            self.model.add_macro(name, text)
        integration = getfem.MeshIm(mesh, getfem.Integ(QUADRATURE))
        self.kept = mesh, space, integration  # the model holds no reference to them
        for region, energy in enumerate(MATERIALS, start=1):
            self.model.add_nonlinear_term(integration, energy, region, True)

    def forces(self, displacements: Array) -> Array:
        """Internal forces (3 n,) in N."""
        self.model.set_variable("u", displacements)
        self.model.assembly("build_rhs")
        return -self.model.rhs()

    def correction(self, displacements: Array, forces: Array, held: Array, moved: Array) -> Array:
        """Solution (3 n,) in m of the partitioned linear system."""
        self.model.set_variable("u", displacements)
        self.model.assembly("build_matrix")
        tangent = self.model.tangent_matrix()
        free = np.setdiff1d(np.arange(displacements.size), held)
        right = -(forces + tangent.mult(moved))[free]
        change = moved.copy()
        change[free] = getfem.linsolve_mumps(getfem.Spmat("copy", tangent, free, free), right).ravel()
        return change


def _version() -> str:
    """The Debian package's, for the module does not say its own."""
    if shutil.which("dpkg-query") is None:
        return "unknown"
    command = ["dpkg-query", "--show", "--showformat", "${Version}", "python3-getfem"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout or "unknown"


if __name__ == "__main__":
    run(Block)
