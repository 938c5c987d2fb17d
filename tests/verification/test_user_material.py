"""A material that a user writes as stress and tangent: Ogden's law, equal to neo-Hooke's at an exponent of two (Ogden 1972)."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from principal_ogden import PrincipalOgden
from solids import assert_close, body_of, box, first_piola_kirchhoff, solve_near

from tactsim.experiments.indentation.indentation import Indentation
from tactsim.fem.assembly import forms
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.material_forms import compiled_form
from tactsim.interfaces import Array, Material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.result import Result, Status

pytestmark = pytest.mark.usefixtures("one_thread")
MODULUS = 1e3
SAME = 1e-8
"""Of stress and tangent: divided differences of stretches that are 1e-5 apart lose half of the digits."""
MEASURES = {"axisymmetric": (2, 3), "plane_strain": (2, 3), "solid": (2, 1, 2)}


def deformations(count: int = 60) -> np.ndarray:
    """Rest, equal stretches, and random deformation gradients (3, 3, count)."""
    F = np.eye(3)[:, :, None] + 0.15 * np.random.default_rng(4).normal(size=(3, 3, count))
    F[:, :, 0], F[:, :, 1] = np.eye(3), np.diag([1.2, 1.2, 0.8])
    return F


@pytest.mark.parametrize("alpha", [2.0, 3.5, -2.0])
def test_the_tangent_is_the_derivative_of_the_stress(alpha, verification_record):
    material, F = PrincipalOgden(modulus=MODULUS, alpha=alpha), deformations()
    pressure, step = np.full(F.shape[2], 300.0), 1e-6
    computed = np.empty((3, 3, 3, 3, F.shape[2]))
    for k in range(3):
        for L in range(3):
            shift = np.zeros((3, 3, 1))
            shift[k, L] = step
            above, below = (material.first_piola_kirchhoff(F + sign * shift, pressure) for sign in (1, -1))
            computed[:, :, k, L] = (above - below) / (2 * step)
    assert_close(
        material.tangent(F, pressure), computed, 1e-7
    )  # a central difference: the square of the step and round-off over it
    known = {"reference": "central differences of its stress", "kind": "exact", "mesh": "none", "tolerance": 1e-7}
    verification_record("tangent of a user's law, exponents of 2, 3.5 and -2", material.tangent(F, pressure), computed, **known)
    with pytest.raises(AssertionError):
        assert_close(PrincipalOgden(modulus=MODULUS, alpha=alpha + 0.01).tangent(F, pressure), computed, 1e-7)


def test_an_exponent_of_two_is_neo_hooke(verification_record):
    own, known, F = PrincipalOgden(modulus=MODULUS), NeoHookean(c10=MODULUS / 2), deformations()
    pressure = np.full(F.shape[2], 300.0)
    assert_close(own.first_piola_kirchhoff(F, pressure), known.first_piola_kirchhoff(F, pressure), SAME)
    assert_close(own.tangent(F, pressure), known.tangent(F, pressure), SAME)
    identity = {"reference": "neo-Hooke's law", "kind": "invariance", "mesh": "none", "tolerance": SAME}
    for name in ("first_piola_kirchhoff", "tangent"):
        computed, expected = (getattr(one, name)(F, pressure) for one in (own, known))
        verification_record(f"a user's law with an exponent of two, {name.replace('_', ' ')}", computed, expected, **identity)
    other = PrincipalOgden(modulus=MODULUS, alpha=2.001)
    with pytest.raises(AssertionError):
        assert_close(other.first_piola_kirchhoff(F, pressure), known.first_piola_kirchhoff(F, pressure), SAME)


def body_and_unknowns(measure: str, material: Material, *, relaxing: bool, resisting: float = 0.0) -> tuple[Body, Array]:
    """A jittered box of two materials, deformed; with ``relaxing``, in a step of time of materials that relax.

    ``resisting`` is the stiffness a against what the pressures leave of the volume change, in the first element; the last has
    twice as much.
    """
    counts = MEASURES[measure]
    mesh = box([1.0] * len(counts), counts, jitter=0.2, seed=3)
    nodes = mesh.nodes + (np.array([0.3, 0.0]) if measure == "axisymmetric" else 0.0)
    mesh = QuadraticMesh(nodes, mesh.elements, np.arange(len(mesh.elements)) % 2)
    stiffness = resisting * np.linspace(1.0, 2.0, len(mesh.elements))
    body = body_of(mesh, measure, material, NeoHookean(c10=MODULUS / 4, bulk_modulus=MODULUS), volume_stiffness=stiffness)
    generator = np.random.default_rng(1)
    if relaxing:
        shape = body.points.weights.shape
        earlier = MODULUS * generator.normal(size=(6, *shape))
        body = body.with_relaxation(RelaxationStep(generator.uniform(0.2, 1.0, shape[0]), earlier))
    unknowns = MODULUS * generator.normal(size=body.space.size)
    u, _ = body.space.split(unknowns)
    stretch = generator.uniform(-0.2, 0.2, (body.space.dim,) * 2)
    u[:] = nodes @ stretch.T + generator.uniform(-0.01, 0.01, u.shape)
    return body, unknowns


@pytest.mark.parametrize("resisting", [0.0, 3.0])
@pytest.mark.parametrize("relaxing", [False, True], ids=["elastic", "relaxing"])
@pytest.mark.parametrize("measure", MEASURES)
def test_interpreted_elements_have_the_terms_of_the_readable_forms(measure, relaxing, resisting, verification_record):
    material = PrincipalOgden(modulus=MODULUS, alpha=3.0, bulk_modulus=2e4)
    body, unknowns = body_and_unknowns(measure, material, relaxing=relaxing, resisting=resisting)
    assert body.forms == (None, "invariants")
    interpreted = body.residual(unknowns), body.pattern.matrix(body.tangent(unknowns)).toarray()

    def check(readable):
        for computed, expected in zip(interpreted, (forms.residual, forms.tangent), strict=True):
            expected = expected(readable, unknowns)
            assert_close(computed, expected if isinstance(expected, np.ndarray) else expected.toarray(), 1e-12)

    check(body)
    known = {"reference": "readable forms", "kind": "invariance", "mesh": f"{measure}, few cells", "tolerance": 1e-12}
    verification_record("residual of an interpreted law", interpreted[0], forms.residual(body, unknowns), **known)
    harder = PrincipalOgden(modulus=MODULUS, alpha=3.0 + 1e-6, bulk_modulus=2e4)
    assert_kills(check, exponent=(body_and_unknowns(measure, harder, relaxing=relaxing, resisting=resisting)[0],))


@pytest.mark.parametrize("measure", MEASURES)
def test_interpreted_elements_equal_compiled_ones(measure, verification_record):
    own, unknowns = body_and_unknowns(measure, PrincipalOgden(modulus=MODULUS), relaxing=True)
    known, _ = body_and_unknowns(measure, NeoHookean(c10=MODULUS / 2), relaxing=True)
    assert_close(own.residual(unknowns), known.residual(unknowns), SAME)
    assert_close(own.tangent(unknowns), known.tangent(unknowns), SAME)
    identity = {"reference": "compiled loops", "kind": "invariance", "mesh": f"{measure}, one to four cells", "tolerance": SAME}
    verification_record("residual by interpreted loops", own.residual(unknowns), known.residual(unknowns), **identity)
    verification_record("tangent by interpreted loops", own.tangent(unknowns), known.tangent(unknowns), **identity)
    other, _ = body_and_unknowns(measure, PrincipalOgden(modulus=MODULUS, alpha=2.1), relaxing=True)
    with pytest.raises(AssertionError):
        assert_close(other.residual(unknowns), known.residual(unknowns), SAME)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_patch_takes_any_homogeneous_deformation(measure, verification_record):
    """u prescribed on the boundary: inside, u = (F - 1) X, and P is the same everywhere."""
    dim = 3 if measure == "solid" else 2
    mesh = box([1.0, 1.5, 0.8][:dim], [2, 2, 2][:dim], jitter=0.25, seed=7)
    F = np.eye(3)
    F[:dim, :dim] += np.random.default_rng(3).uniform(-0.2, 0.2, (dim, dim))
    if measure == "axisymmetric":
        F = np.diag([1.1, 0.8, 1.1])
    material = PrincipalOgden(modulus=MODULUS, alpha=3.0, bulk_modulus=2e4)
    body = body_of(mesh, measure, material)
    displacement = mesh.nodes @ (F - np.eye(3))[:dim, :dim].T
    facets, _ = mesh.boundary_facets()
    fixed = (dim * np.unique(facets)[:, None] + np.arange(dim)).ravel()
    solved = solve_near(body, fixed, displacement)
    u, _ = body.space.split(solved.unknowns)
    assert_close(u, displacement, 1e-10)
    known = {"reference": "affine map", "kind": "exact", "mesh": f"{measure}, distorted", "tolerance": 1e-10}
    verification_record("patch test of a user's law, displacement", u, displacement, **known)
    pressure = np.array(2e4 * float(material.volume_change(F)))
    expected = material.first_piola_kirchhoff(F, pressure)[:, :, None, None]
    assert_close(first_piola_kirchhoff(body, solved), np.broadcast_to(expected, solved.kinematics.F.shape), 1e-9)
    wrong = PrincipalOgden(modulus=MODULUS, alpha=2.5).first_piola_kirchhoff(F, pressure)[:, :, None, None]
    with pytest.raises(AssertionError):
        assert_close(first_piola_kirchhoff(body, solved), np.broadcast_to(wrong, solved.kinematics.F.shape), 1e-9)


def pressed(material: Material) -> Result:
    """A small sphere pressed into a coarse specimen."""
    case = {
        "specimen": {"material": material, "radius": "6 mm", "thickness": "3 mm"},
        "body": {"kind": "sphere", "radius": "3 mm"},
        "contact": {"kind": "coulomb", "friction": 0.0},
        "stop": "displacement",
        "displacement": "0.1 mm",
        "steps": {"first": "0.1 mm", "largest": "0.1 mm"},
        "mesh": {"refinement": 0.2, "adaptive": False},
    }
    return Indentation.model_validate(case).run(lambda step: None)


def test_an_indentation_of_a_users_material_is_that_of_the_compiled_one_and_says_that_it_is_slow(verification_record):
    own, known = pressed(PrincipalOgden(modulus=MODULUS)), pressed(NeoHookean(c10=MODULUS / 2))
    assert own.status is known.status is Status.CONVERGED
    force = float(known.quantities["reaction_force"].value)
    computed = float(own.quantities["reaction_force"].value)
    assert computed == pytest.approx(force, rel=SAME)
    identity = {"reference": "the compiled law", "kind": "invariance", "mesh": "axisymmetric, coarse", "tolerance": SAME}
    verification_record("indentation of a user's material, force", computed, force, **identity)
    warning = "specimen.material: material principal_ogden has no compiled form: assembly is interpreted, several times slower"
    assert warning in own.warnings
    assert not any("interpreted" in words for words in known.warnings)
    assert own.quantities["unstable_volume_fraction"].value == 0.0
    stiffer = pressed(PrincipalOgden(modulus=MODULUS, alpha=6.0))
    assert float(stiffer.quantities["reaction_force"].value) != pytest.approx(force, rel=1e-3)


def test_a_subclass_that_overrides_the_law_has_not_the_form_of_its_base():
    class Halved(LinearElastic):
        def first_piola_kirchhoff(self, F: Array, pressure: Array) -> Array:
            return super().first_piola_kirchhoff(F, pressure) / 2

    assert compiled_form(LinearElastic.example()) == "small_strain"
    assert compiled_form(Halved.example()) is None
    assert compiled_form(NeoHookean.example()) == "invariants"
    assert compiled_form(PrincipalOgden.example()) is None
