"""Thick Mooney-Rivlin sphere under internal pressure: exact solution (verification.md, 2.2).

r^3 = R^3 + c, l = r / R: p = C10 [(4/lb + 1/lb^4) - (4/la + 1/la^4)] + C01 [4 (la - lb) - 2 (la^-2 - lb^-2)], with radii 1
and 2, C10 = 1 and C01 = 0.25: la = 1.10 at p = 0.73414785, la = 1.20 at p = 1.25543543.
Mutants: C01 wrong by 0.05, which C10 makes up for at small strain; C10 and C01 swapped; the tube in place of the sphere.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from shells import inflated, radial_displacement, radial_stress
from skfem import MeshTri
from solids import assert_close, box, cauchy_stress, facets_where, held, on_plane

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.equilibrium.balance import Equilibrium
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh

pytestmark = pytest.mark.usefixtures("one_thread")
C10, C01 = 1.0, 0.25
MATERIAL = MooneyRivlin2(c10=C10, c01=C01)
PRINTED = {1.10: 0.73414785, 1.20: 1.25543543}
STRETCH_TOLERANCE = {"axisymmetric": 1e-4, "solid": 2e-3}
"""Of la - 1, relative: the error of the mesh with twelve layers in the section, five in the octant."""
STRESS_TOLERANCE = 0.01
"""Of the radial stress over the pressure at every quadrature point: linear in each element."""


MESHES = {"axisymmetric": "axisymmetric, 12 x 12 cells", "solid": "solid, octant, 5 layers"}


def exact_pressure(la: float, c10: float = C10, c01: float = C01) -> float:
    """Internal pressure that stretches the bore to la."""
    lb = (1 + (la**3 - 1) / 8) ** (1 / 3)
    first = (4 / lb + lb**-4) - (4 / la + la**-4)
    return c10 * first + c01 * (4 * (la - lb) - 2 * (la**-2 - lb**-2))


def exact_radial_stress(R: Array, la: float, c10: float = C10, c01: float = C01) -> Array:
    """sigma_rr at reference radius R: minus the pressure that the sphere outside R bears."""
    c = la**3 - 1
    stretch, lb = (1 + c / R**3) ** (1 / 3), (1 + c / 8) ** (1 / 3)
    first = (4 / lb + lb**-4) - (4 / stretch + stretch**-4)
    return -c10 * first - c01 * (4 * (stretch - lb) - 2 * (stretch**-2 - lb**-2))


def tube_stress(R: Array, la: float) -> Array:
    """sigma_rr in a tube of these radii and this stretch of its bore, as in ``test_thick_tube``."""
    c = la**2 - 1
    stretch, lb = np.sqrt(1 + c / R**2), np.sqrt(1 + c / 4)
    return -2 * (C10 + C01) * (np.log(stretch / lb) + (lb**-2 - stretch**-2) / 2)


def quarter_section() -> tuple[QuadraticMesh, Array, Array]:
    """A quarter of the meridian section, its bore and its unknowns held by symmetry."""
    flat = box([1.0, 1.0], [12, 12])
    R, angle = 2.0 ** flat.nodes[:, 0], np.pi / 2 * flat.nodes[:, 1]
    on_axis = on_plane(1, 1.0)(flat.nodes)
    nodes = np.column_stack([np.where(on_axis, 0.0, R * np.cos(angle)), R * np.sin(angle)])
    fixed = np.concatenate([held(flat, 0, on_plane(1, 1.0)), held(flat, 1, on_plane(1, 0.0))])
    return flat.moved(nodes), facets_where(flat, on_plane(0, 0.0)), fixed


def octant(layers: int = 5, refinements: int = 3) -> tuple[QuadraticMesh, Array, Array]:
    """An eighth of the sphere: a triangulated face of an octahedron in layers, each prism cut into three tetrahedra."""
    face = MeshTri(np.eye(2, 3, 1), np.array([[0], [1], [2]]))
    face = face.refined(refinements)
    count = face.p.shape[1]
    levels = np.repeat(np.linspace(0.0, 1.0, layers + 1), count)
    corners = np.column_stack([np.tile(face.p.T, (layers + 1, 1)), levels])
    a, b, c = np.sort(face.t, axis=0)
    prisms = [(a, b, c, c + count), (a, b, b + count, c + count), (a, a + count, b + count, c + count)]
    tetrahedra = np.vstack([np.column_stack(p) + layer * count for layer in range(layers) for p in prisms])
    flat = quadratic_mesh(corners, tetrahedra)
    x, y, s = flat.nodes.T
    direction = np.column_stack([x, y, np.maximum(1 - x - y, 0.0)])
    direction[np.abs(direction) < 1e-12] = 0.0
    nodes = 2.0 ** s[:, None] * direction / np.linalg.norm(direction, axis=1)[:, None]
    mesh = flat.moved(nodes)
    fixed = np.concatenate([held(mesh, axis, on_plane(axis, 0.0)) for axis in range(3)])
    return mesh, facets_where(flat, on_plane(2, 0.0)), fixed


def solve_sphere(measure: str, pressure: float, material: MooneyRivlin2 = MATERIAL) -> tuple[Body, Equilibrium]:
    """A quarter of the section or an eighth of the sphere under a pressure."""
    mesh, bore, fixed = quarter_section() if measure == "axisymmetric" else octant()
    return inflated(mesh, measure, material, pressure, bore=bore, fixed=fixed)


def assert_stretch(measure: str, body: Body, solved: Equilibrium, la: float) -> None:
    """The bore is stretched to la at every node."""
    actual = radial_displacement(body, solved, 1.0, axes=body.space.dim)
    assert_close(actual, la - 1, STRETCH_TOLERANCE[measure])


def test_the_closed_form_gives_the_printed_numbers(verification_record):
    def check(c10, c01):
        for la, pressure in PRINTED.items():
            assert abs(exact_pressure(la, c10, c01) - pressure) <= 6e-9  # printed to eight digits

    check(C10, C01)
    found = [exact_pressure(la, C10, C01) for la in PRINTED]
    known = {"reference": "printed to eight digits", "kind": "published", "mesh": "closed form", "scale": 1.0, "tolerance": 6e-9}
    verification_record("thick sphere, closed form", found, list(PRINTED.values()), **known)
    assert_kills(check, swapped=(C01, C10))


@pytest.mark.parametrize(
    ("la", "pressure", "measure"),
    [
        pytest.param(*printed, measure, marks=pytest.mark.slow if measure == "solid" and printed[0] != 1.2 else ())
        for printed in PRINTED.items()
        for measure in STRETCH_TOLERANCE
    ],
)
def test_stretch_and_stress(measure, la, pressure, verification_record):
    body, solved = solve_sphere(measure, pressure)
    assert_stretch(measure, body, solved, la)
    R, stress = radial_stress(body, cauchy_stress(body, solved), solved.unknowns, axes=body.space.dim)

    def check(expected):
        assert_close(stress, expected, STRESS_TOLERANCE, scale=pressure)

    check(exact_radial_stress(R, la))
    known = {"reference": "closed form of the hollow Mooney-Rivlin sphere", "kind": "exact", "mesh": MESHES[measure]}
    bore, exact = radial_displacement(body, solved, 1.0, axes=body.space.dim), exact_radial_stress(R, la)
    verification_record("thick sphere, stretch of the bore", bore, la - 1, tolerance=STRETCH_TOLERANCE[measure], **known)
    verification_record(
        "thick sphere, radial stress everywhere", stress, exact, tolerance=STRESS_TOLERANCE, scale=pressure, **known
    )
    assert_kills(check, swapped=(exact_radial_stress(R, la, C01, C10),), tube=(tube_stress(R, la),))


@pytest.mark.parametrize(
    "measure", [pytest.param(one, marks=pytest.mark.slow if one == "solid" else ()) for one in STRETCH_TOLERANCE]
)
def test_a_wrong_c01_is_seen(measure):
    wrong = MooneyRivlin2(c10=C10 + 0.05, c01=C01 - 0.05)
    with pytest.raises(AssertionError):
        assert_stretch(measure, *solve_sphere(measure, PRINTED[1.20], wrong), 1.20)
