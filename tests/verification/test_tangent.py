"""Consistency of the tangent: Newton's matrix is the derivative of the unbalanced forces (verification.md, 6).

Taylor's theorem: the remainder R(u + e d) - R(u) - e K d falls by 4 when e is halved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from mutants import assert_kills
from solids import assert_close, body_of, box, facets_where, on_plane

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.interfaces import Material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.mooney_rivlin_5 import MooneyRivlin5
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.registry import kinds

pytestmark = pytest.mark.usefixtures("one_thread")
MEASURES = ["axisymmetric", "plane_strain", "solid"]
KINDS = sorted(name for name in kinds(Material))
RATIO_TOLERANCE = 0.02
"""Of the ratio 4: the third-order term over the second at the steps taken."""
TAYLOR = {"reference": "Taylor's theorem", "kind": "invariance"}


@dataclass(frozen=True)
class Map:
    """Forces (size,) as a function of the unknowns, and their claimed derivative in a direction."""

    value: Callable[[Array], Array]
    slope: Callable[[Array, Array], Array]


def patch(measure: str, material: Material | None = None, volume_stiffness: float = 0.0) -> tuple[QuadraticMesh, Body]:
    """A small unstructured body, off the axis if axisymmetric."""
    dim = 3 if measure == "solid" else 2
    mesh = box([1.0] * dim, [2, 2, 1][:dim], jitter=0.2, seed=5)
    mesh = mesh.moved(mesh.nodes + np.array([0.5, 0.0, 0.0])[:dim])
    material = material or MooneyRivlin5(c10=0.6, c01=0.2, c20=0.3, c11=0.1, c02=0.05, bulk_modulus=3.0)
    return mesh, body_of(mesh, measure, material, volume_stiffness=volume_stiffness)


def state_and_direction(body: Body) -> tuple[Array, Array]:
    """A deformed state under pressure, and a direction of unit size in which to differentiate."""
    generator = np.random.default_rng(8)
    unknowns, direction = np.zeros(body.space.size), np.zeros(body.space.size)
    size = body.materials[0].shear_modulus
    for vector, amplitude in ((unknowns, 0.03), (direction, 0.3)):
        u, p = body.space.split(vector)
        u[:] = generator.uniform(-amplitude, amplitude, u.shape)
        p[:] = size * generator.uniform(-1, 1, p.shape)
    body.space.split(unknowns)[0][:, 1] += 0.2 * body.space.nodes[:, 0]
    return unknowns, direction


def remainders(map_: Map, unknowns: Array, direction: Array) -> Array:
    """Size of the remainder of the first-order Taylor polynomial, over the change itself, for four halvings of a small step."""
    slope, start = map_.slope(unknowns, direction), map_.value(unknowns)
    steps = 1e-3 / 2.0 ** np.arange(4)
    changes = [map_.value(unknowns + step * direction) - start for step in steps]
    return np.array([np.linalg.norm(c - e * slope) / np.linalg.norm(c) for c, e in zip(changes, steps, strict=True)]) * steps


def assert_taylor(map_: Map, body: Body, *, linear: bool = False) -> float:
    """The last ratio is 4, or there is no remainder but round-off if the map is linear; the ratio, or the remainder."""
    sizes = remainders(map_, *state_and_direction(body))
    if linear:
        assert sizes.max() <= 1e-13, f"remainders {sizes} of a linear map"
        return float(sizes.max())
    assert abs(sizes[-2] / sizes[-1] - 4) <= RATIO_TOLERANCE, f"ratios {sizes[:-1] / sizes[1:]}"
    return float(sizes[-2] / sizes[-1])


def body_map(body: Body, error: float = 0.0) -> Map:
    """Internal forces; ``error`` spoils the tangent by that part of its diagonal."""

    def slope(unknowns, direction):
        matrix = body.pattern.matrix(body.tangent(unknowns))
        return matrix @ direction + error * matrix.diagonal() * direction

    return Map(body.residual, slope)


def entries(load: FollowerPressure, body: Body, displacement: np.ndarray) -> np.ndarray:
    """What a load adds to the entries of the tangent."""
    data = np.zeros(len(body.pattern.indices))
    load.add_stiffness(data, displacement)
    return data


def load_map(body: Body, load: FollowerPressure) -> Map:
    """Minus the external forces, as Newton counts them."""
    split = body.space.split
    return Map(lambda x: -load.force(split(x)[0]), lambda x, d: body.pattern.matrix(entries(load, body, split(x)[0])) @ d)


def traction_map(body: Body, assembly: SurfaceAssembly, *, wrong_sign: bool = False) -> Map:
    """Minus the forces of a traction that is a smooth vector function of the place x of the surface point."""
    dim, points = body.space.dim, assembly.points
    mixing = np.random.default_rng(4).normal(size=(dim, dim))
    reference = points.interpolate(body.space.nodes)

    def place(unknowns):
        return reference + points.interpolate(body.space.split(unknowns)[0])

    def slope(unknowns, direction):
        derivative = np.einsum("ij,jn->ijn", mixing, np.cos(place(unknowns)))
        data = assembly.add_stiffness(np.zeros(len(body.pattern.indices)), -derivative if wrong_sign else derivative)
        return body.pattern.matrix(data) @ direction

    return Map(lambda unknowns: -assembly.force(mixing @ np.sin(place(unknowns))), slope)


def outer_faces(mesh: QuadraticMesh) -> Array:
    """The far faces across the first two axes."""
    return np.vstack([facets_where(mesh, on_plane(0, 1.5)), facets_where(mesh, on_plane(1, 1.0))])


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "linear_elastic"])
def test_tangent_of_a_body(measure, kind, verification_record):
    cls = kinds(Material)[kind]
    body = patch(measure, cls.example())[1]
    sizes = remainders(body_map(body), *state_and_direction(body))
    known = {
        "reference": "Taylor's theorem",
        "kind": "invariance",
        "mesh": f"{measure}, distorted",
        "tolerance": RATIO_TOLERANCE / 4,
    }
    verification_record("remainder of the tangent over half the step, all materials", sizes[-2] / sizes[-1], 4.0, **known)
    assert_taylor(body_map(patch(measure, cls.example())[1]), patch(measure, cls.example())[1])


@pytest.mark.parametrize("bulk_modulus", [None, 3.0])
@pytest.mark.parametrize("measure", MEASURES)
def test_tangent_of_a_body_that_resists_changes_of_volume(measure, bulk_modulus, verification_record):
    """Mutants: the tangent without the resistance, and with another one."""
    material = NeoHookean(c10=0.6, bulk_modulus=bulk_modulus)
    body = patch(measure, material, 3.0)[1]

    def check(stiffness):
        other = patch(measure, material, stiffness)[1]
        return assert_taylor(Map(body.residual, body_map(other).slope), body)

    known = TAYLOR | {"mesh": f"{measure}, distorted", "tolerance": RATIO_TOLERANCE / 4}
    verification_record("remainder of the tangent over half the step, resistance to changes of volume", check(3.0), 4.0, **known)
    assert_kills(check, none=(0.0,), another=(3.03,))


@pytest.mark.parametrize("measure", MEASURES)
def test_tangent_of_a_linear_body_has_no_remainder(measure, verification_record):
    """Mutant: the tangent of large strains at the same state."""
    material = LinearElastic.example()
    _, body = patch(measure, material)
    unknowns, direction = state_and_direction(body)
    change = body.residual(unknowns + direction) - body.residual(unknowns)

    def check(material):
        slope = body_map(patch(measure, material)[1]).slope(unknowns, direction)
        assert_close(slope, change, 1e-12)  # round-off
        return slope

    known = TAYLOR | {"mesh": f"{measure}, distorted", "tolerance": 1e-12}
    verification_record("tangent of a linear body, change of the forces", check(material), change, **known)
    large = NeoHookean(c10=material.shear_modulus / 2, bulk_modulus=material.bulk_modulus)
    assert_kills(check, large_strain=(large,))


@pytest.mark.parametrize("measure", MEASURES)
def test_tangent_of_a_follower_pressure(measure, verification_record):
    """In plane strain the force is linear in the displacement."""
    mesh, body = patch(measure)
    linear, known = measure == "plane_strain", TAYLOR | {"mesh": f"{measure}, distorted"}
    found = assert_taylor(load_map(body, FollowerPressure(body.space, outer_faces(mesh), body.pattern, 0.7)), body, linear=linear)
    if linear:
        verification_record("remainder of the tangent, pressure", found, 0.0, scale=1.0, tolerance=1e-13, **known)
    else:
        words = "remainder of the tangent over half the step, pressure"
        verification_record(words, found, 4.0, tolerance=RATIO_TOLERANCE / 4, **known)


@pytest.mark.parametrize("measure", MEASURES)
def test_tangent_of_a_traction_that_depends_on_the_place(measure, verification_record):
    mesh, body = patch(measure)
    assembly = SurfaceAssembly(body.space.surface_points(outer_faces(mesh)), body.pattern, body.space.dim)
    found = assert_taylor(traction_map(body, assembly), body)
    known = TAYLOR | {"mesh": f"{measure}, distorted", "tolerance": RATIO_TOLERANCE / 4}
    verification_record("remainder of the tangent over half the step, traction", found, 4.0, **known)
    with pytest.raises(AssertionError):
        assert_taylor(traction_map(body, assembly, wrong_sign=True), body)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_tangent_wrong_by_a_thousandth_is_seen(measure):
    _, body = patch(measure)
    with pytest.raises(AssertionError):
        assert_taylor(body_map(body, 0.001), body)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_pressure_that_does_not_follow_is_seen(measure):
    """Mutant: the tangent of a dead load."""
    mesh, body = patch(measure)
    following = load_map(body, FollowerPressure(body.space, outer_faces(mesh), body.pattern, 0.7))
    with pytest.raises(AssertionError):
        assert_taylor(Map(following.value, lambda x, d: 0 * d), body, linear=measure == "plane_strain")


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("bulk_modulus", [None, 50.0])
def test_tangent_of_a_body_is_symmetric(measure, bulk_modulus, verification_record):
    """Mutant: a pressure that follows a part of the surface, which has no potential, counted with the body."""
    mesh, body = patch(measure, MooneyRivlin2(c10=1.0, c01=0.25, bulk_modulus=bulk_modulus))
    unknowns, _ = state_and_direction(body)
    load = FollowerPressure(body.space, outer_faces(mesh), body.pattern, 0.7)

    def check(data):
        matrix = body.pattern.matrix(data).toarray()
        assert_close(matrix, matrix.T, 1e-14)  # round-off

    tangent = body.tangent(unknowns)
    check(tangent)
    matrix = body.pattern.matrix(tangent).toarray()
    known = {"reference": "its transpose", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": 1e-14}
    verification_record("tangent of a body", matrix, matrix.T, **known)
    assert_kills(check, follower=(tangent + entries(load, body, body.space.split(unknowns)[0]),))


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
def test_tangent_of_a_pressure_on_a_closed_surface_is_symmetric(measure, verification_record):
    """A uniform pressure all around has the potential p V (Schweizerhof & Ramm 1984); on a part of the surface it has not."""
    mesh, body = patch(measure)
    displacement = body.space.split(state_and_direction(body)[0])[0]
    for facets, symmetric in ((mesh.boundary_facets()[0], True), (outer_faces(mesh), False)):
        pressure = FollowerPressure(body.space, facets, body.pattern, 0.7)
        matrix = body.pattern.matrix(entries(pressure, body, displacement)).toarray()
        asymmetry = np.abs(matrix - matrix.T).max() / np.abs(matrix).max()
        assert (asymmetry < 1e-13) == symmetric
        if symmetric:
            known = {
                "reference": "Schweizerhof & Ramm 1984",
                "kind": "exact",
                "mesh": f"{measure}, distorted",
                "tolerance": 1e-13,
            }
            verification_record("tangent of a pressure all around, asymmetry", asymmetry, 0.0, scale=1.0, **known)
