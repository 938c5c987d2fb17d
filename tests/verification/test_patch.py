"""Patch tests: any affine deformation is reproduced on any mesh to round-off (Irons & Razzaque 1972; verification.md, 6).

Exact solution: u = (F - 1) X with P = P(F, p) the same everywhere, p = K (J - 1), or any p where the material is incompressible.
"""

from __future__ import annotations

import numpy as np
import pytest
from solids import assert_close, body_of, box, facets_where, first_piola_kirchhoff, on_plane, solve_near

from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.mooney_rivlin_5 import MooneyRivlin5

pytestmark = pytest.mark.usefixtures("one_thread")
TOLERANCE = 1e-10
"""Of the displacement and the stress over their size: Newton's own tolerance."""
MATERIALS = {
    "soft_volume": MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=500.0),
    "nearly_incompressible": MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=2e7),
    "incompressible": MooneyRivlin2(c10=80.0, c01=20.0),
    "five_terms": MooneyRivlin5(c10=60.0, c01=10.0, c20=30.0, c11=5.0, c02=2.0, bulk_modulus=1e4),
    "linear": LinearElastic(youngs_modulus=600.0, poisson_ratio=0.45),
    "linear_incompressible": LinearElastic(youngs_modulus=600.0, poisson_ratio=0.5),
}


def random_gradient(seed: int, material, dim: int) -> np.ndarray:
    """F (3, 3) with J = 1 where the material is incompressible, J near 1 where it is nearly so."""
    F = np.eye(3)
    change = np.random.default_rng(seed).uniform(-0.25, 0.25, (dim, dim))
    if isinstance(material, LinearElastic):
        F[:dim, :dim] += change - np.eye(dim) * (np.trace(change) / dim if material.bulk_modulus is None else 0.0)
        return F
    F[:dim, :dim] += change
    if material.bulk_modulus is None or material.bulk_modulus > 1e6:
        F[:dim, :dim] /= np.linalg.det(F) ** (1 / dim)
    return F


def solve_patch(
    measure: str, material, F: np.ndarray, *, free_face_scale: float = 1.0, volume_stiffness: float = 0.0, noise: float = 0.01
):
    """Unstructured patch: u prescribed on the boundary but for the last face, which bears the traction P N.

    Returns the body, its equilibrium, the exact displacement and the exact P.
    """
    dim = 3 if measure == "solid" else 2
    mesh = box([1.0, 1.5, 0.8][:dim], [3, 3, 2][:dim], jitter=0.25, seed=7)
    body = body_of(mesh, measure, material, volume_stiffness=volume_stiffness)
    pressure = 40.0 if material.bulk_modulus is None else material.bulk_modulus * float(material.volume_change(F))
    stress = material.first_piola_kirchhoff(F, np.array(pressure))
    top = mesh.nodes[:, 1].max()
    facets, _ = mesh.boundary_facets()
    loaded = facets_where(mesh, on_plane(1, top))
    rest = np.array([face for face in facets if not on_plane(1, top)(mesh.nodes[face]).all()])
    points = body.space.surface_points(loaded)
    force = SurfaceAssembly(points, body.pattern, dim).force(free_face_scale * stress[:dim, :dim] @ points.normals)
    fixed = (dim * np.unique(rest)[:, None] + np.arange(dim)).ravel()
    displacement = mesh.nodes @ (F - np.eye(3))[:dim, :dim].T
    return body, solve_near(body, fixed, displacement, nodal_force=force, noise=noise), displacement, stress


def assert_patch(body, solved, displacement, stress):
    """The exact displacement at every node and the exact stress at every point."""
    assert_close(body.space.split(solved.unknowns)[0], displacement, TOLERANCE)
    scale = max(np.abs(stress).max(), body.materials[0].shear_modulus)
    assert_close(first_piola_kirchhoff(body, solved), stress[:, :, None, None], 10 * TOLERANCE, scale=scale)


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("seed", [11, pytest.param(12, marks=pytest.mark.slow)])
def test_random_affine_maps_are_exact(measure, name, seed, verification_record):
    F = random_gradient(seed, MATERIALS[name], 3 if measure == "solid" else 2)
    body, solved, displacement, stress = solve_patch(measure, MATERIALS[name], F)
    assert_patch(body, solved, displacement, stress)
    known = {"reference": "Irons & Razzaque 1972", "kind": "exact", "mesh": f"{measure}, distorted", "tolerance": TOLERANCE}
    verification_record("patch test, displacement", body.space.split(solved.unknowns)[0], displacement, **known)


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
@pytest.mark.parametrize("name", MATERIALS)
def test_resistance_to_what_the_pressure_leaves_changes_no_exact_state(measure, name, verification_record):
    F = random_gradient(11, MATERIALS[name], 3 if measure == "solid" else 2)
    # Newton starts nearer: a patch that is compressed to 0.86 of its volume has another equilibrium 4 % away.
    body, solved, displacement, stress = solve_patch(measure, MATERIALS[name], F, volume_stiffness=3.0, noise=0.003)
    assert_patch(body, solved, displacement, stress)
    known = {"reference": "Irons & Razzaque 1972", "kind": "exact", "mesh": f"{measure}, distorted", "tolerance": TOLERANCE}
    found = body.space.split(solved.unknowns)[0]
    verification_record("patch test with resistance to changes of volume, displacement", found, displacement, **known)


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
def test_resistance_to_all_change_of_volume_is_seen(measure):
    """Mutant: the resistance does not know what volume the pressure asks for."""
    material = MATERIALS["soft_volume"]
    F = random_gradient(11, material, 3 if measure == "solid" else 2)
    body, solved, _, _ = solve_patch(measure, material, F, volume_stiffness=3.0)
    right = body.residual(solved.unknowns)
    body.compliance = np.zeros_like(body.compliance)
    del body.__dict__["_lasting_tables"]
    split = body.space.displacement_size
    assert np.abs(body.residual(solved.unknowns) - right)[:split].max() > 0.1 * np.abs(right)[:split].max()


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("radial", [0.9, 1.2])
def test_uniform_stretches_of_an_axisymmetric_body_are_exact(name, radial, verification_record):
    material = MATERIALS[name]
    axial = 3 - 2 * radial if isinstance(material, LinearElastic) else radial**-2
    if material.bulk_modulus is not None and material.bulk_modulus < 1e6:
        axial *= 1.1
    body, solved, displacement, stress = solve_patch("axisymmetric", material, np.diag([radial, axial, radial]))
    assert_patch(body, solved, displacement, stress)
    known = {"reference": "Irons & Razzaque 1972", "kind": "exact", "mesh": "axisymmetric, distorted", "tolerance": TOLERANCE}
    verification_record("patch test, displacement", body.space.split(solved.unknowns)[0], displacement, **known)


@pytest.mark.parametrize("measure", ["axisymmetric", "plane_strain", "solid"])
def test_a_cauchy_traction_on_the_reference_area_is_seen(measure):
    F = np.diag([1.1, 1.2, 1.1 if measure != "plane_strain" else 1.0])
    spread = F[0, 0] * F[2, 2]
    assert_patch(*solve_patch(measure, MATERIALS["soft_volume"], F))
    with pytest.raises(AssertionError):
        assert_patch(*solve_patch(measure, MATERIALS["soft_volume"], F, free_face_scale=1 / spread))


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
@pytest.mark.parametrize("name", MATERIALS)
def test_another_law_is_seen(measure, name):
    """Small strain in place of large strain, and large in place of small, under the same pressure."""
    other = MATERIALS["incompressible" if name.startswith("linear") else "linear_incompressible"]
    F = random_gradient(11, MATERIALS[name], 3 if measure == "solid" else 2)
    body, solved, displacement, _ = solve_patch(measure, MATERIALS[name], F)
    pressure = body.pressure(solved.unknowns).ravel()[0]
    with pytest.raises(AssertionError):
        assert_patch(body, solved, displacement, other.first_piola_kirchhoff(F, np.array(pressure)))


def test_a_traction_without_its_circumference_is_seen():
    F, without = np.diag([1.1, 1.2, 1.1]), 1 / (2 * np.pi)
    with pytest.raises(AssertionError):
        assert_patch(*solve_patch("axisymmetric", MATERIALS["soft_volume"], F, free_face_scale=without))
