"""Linear elastic bodies against closed forms, up to exact incompressibility.

Pure bending (Timoshenko & Goodier 1970, section 102) is quadratic in space, so the elements hold it to round-off:
u = k (-x y, (x^2 + nu (y^2 - z^2)) / 2, nu y z) with sigma_xx = -E k y; in plane strain with E / (1 - nu^2) and nu / (1 - nu).
Lame tube in plane strain: u_r = p a^2 (1 + nu) / (E (b^2 - a^2)) ((1 - 2 nu) r + b^2 / r).
Mutants: another Poisson's ratio, and the moment of plane stress.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from shells import radial_displacement
from solids import assert_close, body_of, box, facets_where, first_piola_kirchhoff, held, on_plane, solve_near

from tactsim.array import Array
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.materials.linear_elastic import LinearElastic

pytestmark = pytest.mark.usefixtures("one_thread")
YOUNG = 18e3
RATIOS = [0.0, 0.3, 0.49, 0.4999, 0.5]
CURVATURE = 0.05
EXACT = 1e-12
"""Of displacement: round-off of one linear solution; of stress a hundred times that, as K tr(eps) cancels where K is 1e3 E."""
LAME_TOLERANCE = {"axisymmetric": 1e-6, "plane_strain": 1e-5, "solid": 5e-4}
"""Of the displacement at the bore: P2 elements across a wall as thick as the bore, curved sides included."""
COUNTS = {"axisymmetric": [8, 2], "plane_strain": [6, 8], "solid": [4, 4, 1]}


def bending(nodes: Array, measure: str, poisson_ratio: float) -> Array:
    """Exact displacement (n, d) of a beam under a moment."""
    nu = poisson_ratio / (1 - poisson_ratio) if measure == "plane_strain" else poisson_ratio
    x, y, z = nodes.T if nodes.shape[1] == 3 else (*nodes.T, 0.0)
    parts = [-x * y, (x**2 + nu * (y**2 - z**2)) / 2, nu * y * z]
    return CURVATURE * np.column_stack(parts[: nodes.shape[1]])


def bending_modulus(measure: str, poisson_ratio: float) -> float:
    """Axial stress over axial strain in Pa."""
    return YOUNG / (1 - poisson_ratio**2) if measure == "plane_strain" else YOUNG


def bend(measure: str, poisson_ratio: float, modulus: float):
    """A beam held at its clamp as pure bending wants it, its far end under the linear traction of a moment.

    ``modulus`` in Pa gives the moment.

    Returns the body, its equilibrium and the exact sigma_xx at the volume points.
    """
    dim = 3 if measure == "solid" else 2
    mesh = box([3.0, 1.0, 0.8][:dim], [4, 3, 2][:dim], jitter=0.2, seed=6)
    mesh = mesh.moved(mesh.nodes - np.array([0.0, 0.5, 0.4])[:dim])
    body = body_of(mesh, measure, LinearElastic(youngs_modulus=YOUNG, poisson_ratio=poisson_ratio))
    displacement = bending(mesh.nodes, measure, poisson_ratio)
    points = body.space.surface_points(facets_where(mesh, on_plane(0, 3.0)))
    traction = np.zeros((dim, len(points.weights)))
    traction[0] = -modulus * CURVATURE * points.interpolate(mesh.nodes)[1]
    force = SurfaceAssembly(points, body.pattern, dim).force(traction)
    fixed = np.concatenate([held(mesh, axis, on_plane(0, 0.0)) for axis in range(dim)])
    height = np.einsum("qa,ea->eq", body.points.values, mesh.nodes[body.space.elements][:, :, 1])
    return body, solve_near(body, fixed, displacement, nodal_force=force), -modulus * CURVATURE * height


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
@pytest.mark.parametrize("poisson_ratio", RATIOS)
def test_a_cantilever_under_a_moment_is_exact(measure, poisson_ratio, verification_record):
    body, solved, stress = bend(measure, poisson_ratio, bending_modulus(measure, poisson_ratio))
    assert solved.iterations == 1

    def check(poisson_ratio):
        displacement = bending(body.space.nodes, measure, poisson_ratio)
        assert_close(body.space.split(solved.unknowns)[0], displacement, EXACT)

    check(poisson_ratio)
    assert_close(first_piola_kirchhoff(body, solved)[0, 0], stress, EXACT * 100)
    expected = bending(body.space.nodes, measure, poisson_ratio)
    known = {"reference": "pure bending", "kind": "exact", "mesh": f"{measure}, distorted", "tolerance": EXACT}
    verification_record("beam under a moment, displacement", body.space.split(solved.unknowns)[0], expected, **known)
    assert_kills(check, poisson_ratio=(poisson_ratio + 1e-3,))


def test_the_moment_of_plane_stress_is_seen():
    body, solved, _ = bend("plane_strain", 0.3, YOUNG)
    with pytest.raises(AssertionError):
        assert_close(body.space.split(solved.unknowns)[0], bending(body.space.nodes, "plane_strain", 0.3), EXACT)


def lame(r: float, poisson_ratio: float, pressure: float) -> float:
    """Radial displacement of a tube of radii 1 and 2."""
    return pressure * (1 + poisson_ratio) / (YOUNG * 3) * ((1 - 2 * poisson_ratio) * r + 4 / r)


def inflate(measure: str, poisson_ratio: float, pressure: float):
    """A strip of the section, a quarter ring or a quarter slice of the tube under a dead pressure; the ends stay plane."""
    flat = box([1.0] * len(COUNTS[measure]), COUNTS[measure])
    R, angle = 2.0 ** flat.nodes[:, 0], np.pi / 2 * flat.nodes[:, 1]
    fixed = [held(flat, 1, on_plane(1, 0.0)), held(flat, 0, on_plane(1, 1.0))]
    if measure == "axisymmetric":
        mesh = flat.moved(np.column_stack([R, flat.nodes[:, 1]]))
        fixed = [held(flat, 1, lambda nodes: np.ones(len(nodes), bool))]
    else:
        mesh = flat.moved(np.column_stack([R * np.cos(angle), R * np.sin(angle), flat.nodes[:, 2:]]))
    if measure == "solid":
        fixed.append(held(flat, 2, lambda nodes: np.ones(len(nodes), bool)))
    body = body_of(mesh, measure, LinearElastic(youngs_modulus=YOUNG, poisson_ratio=poisson_ratio))
    points = body.space.surface_points(facets_where(flat, on_plane(0, 0.0)))
    force = SurfaceAssembly(points, body.pattern, mesh.dim).force(-pressure * points.normals)
    return body, solve_near(body, np.concatenate(fixed), np.zeros_like(mesh.nodes), nodal_force=force, noise=0.0)


@pytest.mark.parametrize("measure", COUNTS)
@pytest.mark.parametrize("poisson_ratio", RATIOS)
def test_lame_tube_without_locking(measure, poisson_ratio, verification_record):
    body, solved = inflate(measure, poisson_ratio, 100.0)
    axes = 1 if measure == "axisymmetric" else 2
    for radius in (1.0, 2.0):
        actual = radial_displacement(body, solved, radius, axes=axes)
        assert_close(actual, lame(radius, poisson_ratio, 100.0), LAME_TOLERANCE[measure])
        known = {"reference": "Lame", "kind": "exact", "mesh": f"{measure}, {COUNTS[measure][0]} elements across the wall"}
        expected = lame(radius, poisson_ratio, 100.0)
        verification_record(
            "linear tube up to a Poisson's ratio of 0.5", actual, expected, tolerance=LAME_TOLERANCE[measure], **known
        )


@pytest.mark.parametrize("measure", COUNTS)
def test_a_wrong_poisson_ratio_is_seen(measure):
    body, solved = inflate(measure, 0.49, 100.0)
    actual = radial_displacement(body, solved, 1.0, axes=1 if measure == "axisymmetric" else 2)
    with pytest.raises(AssertionError):
        assert_close(actual, lame(1.0, 0.48, 100.0), LAME_TOLERANCE[measure])
