"""Cook's membrane, nearly incompressible, finite strain, plane strain (verification.md, 2.4; OpenGeoSys, CooksMembrane).

Corners (0, 0), (48, 44), (48, 60), (0, 44); clamped on the left, dead load of 6.25 per length on the 16-long right edge;
isochoric neo-Hooke with G = 80.1938 and K/2 (J - 1)^2 with K = 40.0942e4. Mutants: a hundredth of K, small strain.
"""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshTri
from solids import body_of, facets_where, held, on_plane

from tactsim.fem.assembly.dead_load import DeadLoad
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.newton import Problem
from tactsim.interfaces import Material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.axisymmetric import edge_graded
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh

pytestmark = pytest.mark.usefixtures("one_thread")
SHEAR_MODULUS, BULK_MODULUS, EDGE_LOAD = 80.1938, 40.0942e4, 6.25
TIP, UPPER_CLAMP = np.array([48.0, 60.0]), np.array([0.0, 44.0])
TIP_RISE = 6.932
"""Extrapolated with an uncertainty of 0.003 (0.04 %)."""
TOLERANCE = 1e-3
"""Relative, demanded of the tip's rise: the uncertainty of the reference and as much again for the mesh."""
LADDER = {
    4: (-5.4428, 6.6032, 6.6411),
    8: (-5.6644, 6.8001, 6.8365),
    16: (-5.7587, 6.8741, 6.9030),
    32: (-5.7986, 6.9043, 6.9324),
}
"""By elements per side: u_x and u_y of the tip, u_y of the middle of the loaded edge; P2/P1 by scikit-fem, to four digits."""


def uniform_mesh(count: int) -> MeshTri:
    """Two triangles per cell, cut along the diagonal that rises to the right."""
    mesh = MeshTri.init_tensor(np.linspace(0, 1, count + 1), np.linspace(0, 1, count + 1))
    x, y = mesh.p
    return MeshTri(np.stack([48 * x, 44 * x + y * (44 - 28 * x)]), mesh.t)


def graded_mesh(finest: float) -> MeshTri:
    """Bisected towards the singular corners of the clamp; the upper one is the stronger."""
    mesh = uniform_mesh(8)
    size = edge_graded(np.array([UPPER_CLAMP, [0.0, 0.0]]), finest=finest, growth=0.3, coarsest=6.0)
    while True:
        corners = mesh.p.T[mesh.t.T]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        marked = np.flatnonzero(longest > np.min([size(corners[:, i]) for i in range(3)], axis=0))
        if not len(marked):
            return mesh
        mesh = mesh.refined(marked)


def quadratic(mesh: MeshTri) -> QuadraticMesh:
    """Quadratic triangles on a scikit-fem mesh."""
    return quadratic_mesh(mesh.p.T.copy(), mesh.t.T.astype(np.int64))


RUBBER = NeoHookean(c10=SHEAR_MODULUS / 2, bulk_modulus=BULK_MODULUS)
SOFT_VOLUME = NeoHookean(c10=SHEAR_MODULUS / 2, bulk_modulus=BULK_MODULUS / 100)
SMALL_STRAIN = LinearElastic(
    youngs_modulus=9 * BULK_MODULUS * SHEAR_MODULUS / (3 * BULK_MODULUS + SHEAR_MODULUS),
    poisson_ratio=(3 * BULK_MODULUS - 2 * SHEAR_MODULUS) / (6 * BULK_MODULUS + 2 * SHEAR_MODULUS),
)


def tip_displacements(mesh: QuadraticMesh, material: Material = RUBBER) -> tuple[float, float, float]:
    """u_x and u_y of the tip, u_y of the middle of the loaded edge; the load in four steps."""
    body = body_of(mesh, "plane_strain", material)
    points = body.space.surface_points(facets_where(mesh, on_plane(0, 48.0)))
    traction = np.array([[0.0], [EDGE_LOAD]]) * np.ones(len(points.weights))
    force = SurfaceAssembly(points, body.pattern, 2).force(traction)
    problem = Problem(body, np.concatenate([held(mesh, axis, on_plane(0, 0.0)) for axis in (0, 1)]))
    unknowns = np.zeros(body.space.size)
    for share in (0.25, 0.5, 0.75, 1.0):
        unknowns = problem.solve(unknowns, loads=[DeadLoad(share * force)]).unknowns
    u, _ = body.space.split(unknowns)
    tip, middle = (int(np.argmin(np.linalg.norm(mesh.nodes - place, axis=1))) for place in (TIP, TIP - [0.0, 8.0]))
    return u[tip, 0], u[tip, 1], u[middle, 1]


def assert_tip(rise: float) -> None:
    """The tip's rise is within the tolerance."""
    assert abs(rise / TIP_RISE - 1) <= TOLERANCE, f"the tip rises by {rise:.5f}, expected {TIP_RISE}"


def assert_printed(values: tuple[float, ...], printed: tuple[float, ...]) -> None:
    """Equal to the last of four printed digits."""
    assert np.abs(np.subtract(values, printed)).max() <= 0.51e-4, f"{values}, printed {printed}"


@pytest.mark.parametrize("count", [pytest.param(count, marks=[pytest.mark.slow] * (count > 16)) for count in LADDER])
def test_uniform_ladder_to_the_printed_digits(count, verification_record):
    values = tip_displacements(quadratic(uniform_mesh(count)))
    assert_printed(values, LADDER[count])
    known = {
        "reference": "scikit-fem, P2/P1, four printed digits",
        "kind": "published",
        "mesh": f"uniform, {count} cells per side",
    }
    verification_record("Cook's membrane, displacements", values, LADDER[count], scale=1.0, tolerance=0.51e-4, **known)


def test_graded_mesh_reaches_the_extrapolated_rise(verification_record):
    mesh = quadratic(graded_mesh(0.1))
    rise = tip_displacements(mesh)[1]
    assert_tip(rise)
    known = {"reference": "OpenGeoSys benchmark, extrapolated to 0.04 %", "kind": "published", "tolerance": TOLERANCE}
    verification_record(
        "Cook's membrane, rise of the tip", rise, TIP_RISE, mesh=f"graded, {len(mesh.elements)} triangles", **known
    )


@pytest.mark.parametrize(
    "wrong", [pytest.param(SOFT_VOLUME, id="soft_volume", marks=pytest.mark.slow), pytest.param(SMALL_STRAIN, id="small_strain")]
)
def test_a_wrong_material_is_seen(wrong):
    """By the rise within 0.1 % on the graded mesh, and by the printed digits on a coarse one."""
    graded = quadratic(graded_mesh(0.1))
    with pytest.raises(AssertionError):
        assert_tip(tip_displacements(graded, wrong)[1])
    with pytest.raises(AssertionError):
        assert_printed(tip_displacements(quadratic(uniform_mesh(8)), wrong), LADDER[8])


@pytest.mark.slow
def test_a_uniform_mesh_of_more_elements_would_be_worse_than_the_graded_one():
    graded, uniform = quadratic(graded_mesh(0.1)), quadratic(uniform_mesh(64))
    assert len(graded.elements) < len(uniform.elements) / 3
    assert abs(tip_displacements(graded)[1] - TIP_RISE) < abs(tip_displacements(uniform)[1] - TIP_RISE) / 2
