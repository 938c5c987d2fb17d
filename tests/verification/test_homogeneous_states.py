"""Homogeneous states of an incompressible Mooney-Rivlin block on unstructured meshes (verification.md, 1).

The printed numbers belong to C10 = 1, C01 = 0.25; the closed forms give them to their last digit, the solver to 1e-10.
Mutants: C10 and C01 swapped, the other measure of stress, an axisymmetric force per radian, C01 wrong by a thousandth.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from solids import assert_close, body_of, box, cauchy_stress, held, on_plane, solve_near

from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
C10, C01 = 1.0, 0.25
TOLERANCE = 1e-10
"""Of stresses and forces over their size: the states lie in the space, so only Newton's tolerance remains."""
UNIAXIAL = {0.5: -10.5, 0.7: -3.639359, 0.8: -2.001562, 0.9: -0.855007, 1.1: 0.671450, 1.5: 2.462963, 2.0: 3.9375}
EQUIBIAXIAL = {0.8: -4.179262, 0.9: -1.717550, 1.1: 1.372800, 1.5: 6.413966}


def uniaxial_nominal(stretch: float, c10: float = C10, c01: float = C01) -> float:
    """Force per reference area: 2 (l - l^-2)(C10 + C01 / l)."""
    return 2 * (stretch - stretch**-2) * (c10 + c01 / stretch)


def equibiaxial_cauchy(stretch: float, c10: float = C10, c01: float = C01) -> float:
    """2 (l^2 - l^-4)(C10 + C01 l^2)."""
    return 2 * (stretch**2 - stretch**-4) * (c10 + c01 * stretch**2)


def pure_shear_cauchy(stretch: float, c10: float = C10, c01: float = C01) -> float:
    """2 (l^2 - l^-2)(C10 + C01)."""
    return 2 * (stretch**2 - stretch**-2) * (c10 + c01)


def block(measure: str, material=None):
    """An unstructured unit block, and its unknowns held by the planes of symmetry (and the axis)."""
    dim = 3 if measure == "solid" else 2
    mesh = box([1.0] * dim, [3, 3, 2][:dim], jitter=0.25, seed=9)
    symmetry = [held(mesh, axis, on_plane(axis, 0.0)) for axis in range(dim)]
    return mesh, body_of(mesh, measure, material or MooneyRivlin2(c10=C10, c01=C01)), symmetry


def pulled(measure: str, stretches: dict[int, float], lateral: float, material=None):
    """Equilibrium with the far faces along some axes moved to a stretch and the others free, where the stretch is ``lateral``.

    Returns the body, the equilibrium and the reactions in N by axis.
    """
    mesh, body, fixed = block(measure, material)
    displacement = np.stack([(stretches.get(axis, lateral) - 1) * mesh.nodes[:, axis] for axis in range(mesh.dim)], axis=1)
    fixed += [held(mesh, axis, on_plane(axis, 1.0)) for axis in stretches]
    solved = solve_near(body, np.concatenate(fixed), displacement)
    forces = body.space.split(body.residual(solved.unknowns))[0]
    return body, solved, {axis: forces[on_plane(axis, 1.0)(mesh.nodes), axis].sum() for axis in stretches}


@pytest.mark.parametrize(
    ("stress", "other_measure", "stretch", "printed"),
    [
        *((uniaxial_nominal, lambda nominal, stretch: nominal * stretch, *row) for row in UNIAXIAL.items()),
        *((equibiaxial_cauchy, lambda cauchy, stretch: cauchy / stretch, *row) for row in EQUIBIAXIAL.items()),
    ],
)
def test_the_closed_forms_give_the_printed_numbers(stress, other_measure, stretch, printed, verification_record):
    def check(computed):
        assert abs(computed - printed) <= 6e-7  # printed to six digits

    check(stress(stretch))
    known = {"reference": "printed to six digits", "kind": "published", "mesh": "closed form", "scale": 1.0, "tolerance": 6e-7}
    verification_record("homogeneous states, closed forms", stress(stretch), printed, **known)
    assert_kills(check, swapped=(stress(stretch, C01, C10),), measure=(other_measure(stress(stretch), stretch),))


@pytest.mark.parametrize("stretch", UNIAXIAL)
@pytest.mark.parametrize("measure", ["axisymmetric", "solid"])
def test_uniaxial_force_and_stress(measure, stretch, verification_record):
    axis, area = (1, np.pi) if measure == "axisymmetric" else (2, 1.0)
    body, solved, reactions = pulled(measure, {axis: stretch}, stretch**-0.5)
    cauchy = cauchy_stress(body, solved)

    def check_force(nominal, area):
        assert_close(reactions[axis], nominal * area, TOLERANCE)

    def check_stress(axial):
        stress = np.zeros((3, 3, 1, 1))
        stress[axis, axis] = axial
        assert_close(cauchy, stress, 10 * TOLERANCE, scale=max(abs(nominal), 2 * (C10 + C01)))

    nominal, swapped = uniaxial_nominal(stretch), uniaxial_nominal(stretch, C01, C10)
    check_force(nominal, area)
    check_stress(nominal * stretch)
    known = {"reference": "Rivlin 1948: 2 (l - l^-2)(C10 + C01 / l)", "kind": "exact", "tolerance": TOLERANCE}
    verification_record(
        "uniaxial force", reactions[axis], nominal * area, mesh=f"{measure}, 3 cells per side, distorted", **known
    )
    assert_kills(check_force, swapped=(swapped, area), cauchy=(nominal * stretch, area))
    assert_kills(check_stress, swapped=(swapped * stretch,), nominal=(nominal,))
    if measure == "axisymmetric":
        assert_kills(check_force, per_radian=(nominal, area / (2 * np.pi)))


@pytest.mark.parametrize("stretch", EQUIBIAXIAL)
@pytest.mark.parametrize("measure", ["axisymmetric", "solid"])
def test_equibiaxial_force_and_stress(measure, stretch, verification_record):
    loaded = {0: stretch} if measure == "axisymmetric" else {0: stretch, 1: stretch}
    body, solved, reactions = pulled(measure, loaded, stretch**-2)
    area = 2 * np.pi if measure == "axisymmetric" else 1.0
    free = 1 if measure == "axisymmetric" else 2
    cauchy = cauchy_stress(body, solved)

    def check_force(nominal, area):
        for reaction in reactions.values():
            assert_close(reaction, nominal * area, TOLERANCE)

    def check_stress(within, free):
        stress = within * np.diag([float(axis != free) for axis in range(3)])[:, :, None, None]
        assert_close(cauchy, stress, 10 * TOLERANCE, scale=max(abs(expected), 2 * (C10 + C01)))

    expected, swapped = equibiaxial_cauchy(stretch), equibiaxial_cauchy(stretch, C01, C10)
    check_force(expected / stretch, area)
    check_stress(expected, free)
    known = {"reference": "Rivlin 1948: 2 (l^2 - l^-4)(C10 + C01 l^2)", "kind": "exact", "tolerance": TOLERANCE}
    mesh, forces = f"{measure}, 3 cells per side, distorted", list(reactions.values())
    verification_record("equibiaxial force", forces, expected / stretch * area, mesh=mesh, **known)
    assert_kills(check_force, swapped=(swapped / stretch, area), cauchy=(expected, area))
    assert_kills(check_stress, swapped=(swapped, free), axes=(expected, 0))
    if measure == "axisymmetric":
        assert_kills(check_force, per_radian=(expected / stretch, 1.0))


@pytest.mark.parametrize("stretch", [0.6, 0.8, 1.3])
@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
def test_plane_strain_compression(measure, stretch, verification_record):
    loaded = {1: stretch} if measure == "plane_strain" else {1: stretch, 0: 1.0}
    _, _, reactions = pulled(measure, loaded, 1 / stretch)

    def check(nominal):
        assert_close(reactions[1], nominal, TOLERANCE)

    nominal = pure_shear_cauchy(stretch) / stretch
    check(nominal)
    known = {"reference": "Rivlin 1948: 2 (l^2 - l^-2)(C10 + C01)", "kind": "exact", "tolerance": TOLERANCE}
    verification_record("plane strain force", reactions[1], nominal, mesh=f"{measure}, 3 cells per side, distorted", **known)
    assert_kills(check, cauchy=(pure_shear_cauchy(stretch),), uniaxial=(uniaxial_nominal(stretch),))


@pytest.mark.parametrize(("measure", "axis"), [("axisymmetric", 1), ("solid", 2)])
def test_a_wrong_c01_is_seen(measure, axis):
    """C01 wrong by a thousandth, C10 making up for it at small strain."""
    wrong = MooneyRivlin2(c10=C10 + C01 * 1e-3, c01=C01 * (1 - 1e-3))
    _, _, reactions = pulled(measure, {axis: 0.8}, 0.8**-0.5, wrong)
    with pytest.raises(AssertionError):
        assert_close(reactions[axis], uniaxial_nominal(0.8) * (np.pi if measure == "axisymmetric" else 1.0), TOLERANCE)


def sheared(material=None):
    """Simple shear of 0.5 in the x-y plane, z free: stress at every point of a block held on its faces across x and y."""
    mesh, body, _ = block("solid", material)
    displacement = np.zeros_like(mesh.nodes)
    displacement[:, 0] = 0.5 * mesh.nodes[:, 1]
    side = lambda nodes: on_plane(0, 0.0)(nodes) | on_plane(0, 1.0)(nodes) | on_plane(1, 0.0)(nodes) | on_plane(1, 1.0)(nodes)  # noqa: E731
    fixed = [held(mesh, axis, side) for axis in (0, 1)] + [held(mesh, 2, on_plane(2, 0.0))]
    return cauchy_stress(body, solve_near(body, np.concatenate(fixed), displacement))


def test_simple_shear_with_its_normal_stresses(verification_record):
    """tau = 1.25, sigma11 = 0.5, sigma22 = -0.125 at shear 0.5; sigma33 = 0."""
    expected = np.array([[0.5, 1.25, 0.0], [1.25, -0.125, 0.0], [0.0, 0.0, 0.0]])[:, :, None, None]
    found = sheared()
    assert_close(found, expected, 10 * TOLERANCE)
    known = {"reference": "Rivlin 1948, shear of 0.5", "kind": "exact", "tolerance": 10 * TOLERANCE}
    verification_record("simple shear, all stresses", found, expected, mesh="solid, 3 cells per side, distorted", **known)
    with pytest.raises(AssertionError):
        assert_close(sheared(MooneyRivlin2(c10=C10 + C01 / 1e3, c01=C01 - C01 / 1e3)), expected, 10 * TOLERANCE)
