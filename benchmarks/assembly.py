"""Assembly of the mixed P2/P1 residual and tangent on tetrahedra, scatter into the sparse matrix included."""

from __future__ import annotations

import time
from statistics import median

import numpy as np
from skfem import MeshTet

from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.stability import strongly_elliptic
from tactsim.mesh.quadratic import quadratic_mesh

REPETITIONS = 7
POINTS = 20_000
"""Points judged for strong ellipticity, in a tenth of a second as asked."""


def measure(cells: int = 24) -> dict[str, float]:
    """Tetrahedra per second for kinematics, residual and tangent together, by the median of some repetitions."""
    lines = np.linspace(0, 0.02, cells + 1)
    tetrahedra = MeshTet.init_tensor(lines, lines, lines)
    mesh = quadratic_mesh(tetrahedra.p.T, tetrahedra.t.T)
    material = MooneyRivlin3(c10=1000.0, c01=685.0, c11=500.0, bulk_modulus=2e5)
    space = TaylorHood(mesh.nodes, mesh.elements, "solid")
    body = Body(space, [material], mesh.regions)
    unknowns = np.random.default_rng(0).normal(size=space.size) * 1e-6
    times = []
    for _ in range(REPETITIONS + 1):
        begin = time.perf_counter()
        state = body.kinematics(unknowns)
        body.residual(unknowns, state)
        body.tangent(unknowns, state)
        times.append(time.perf_counter() - begin)
    seconds = median(times[1:])
    stretched = np.eye(3)[:, :, None] + 0.2 * np.random.default_rng(6).normal(size=(3, 3, POINTS))
    begin = time.perf_counter()
    strongly_elliptic(material, stretched)
    judged = time.perf_counter() - begin
    return {
        "ellipticity_points_per_second": POINTS / judged,
        "tetrahedra": len(mesh.elements),
        "unknowns": space.size,
        "seconds": seconds,
        "tetrahedra_per_second": len(mesh.elements) / seconds,
    }


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """The row of the performance table: what, what is asked, what was measured."""
    rate = f"{round(taken['tetrahedra_per_second'], -3):,.0f} per second".replace(",", " ")
    return [("assembly, residual and tangent, P2/P1 tetrahedra", "80 000 per second", rate)]
