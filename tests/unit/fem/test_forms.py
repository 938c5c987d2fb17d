"""The compiled loops equal the readable forms to round-off, for every material and every measure of volume."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from solids import assert_close, body_of, box

from tactsim.fem.assembly import forms
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.history_variables import elastic_stress
from tactsim.fem.assembly.symmetric import ROWS_AND_COLUMNS
from tactsim.interfaces import Material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.registry import kinds

pytestmark = pytest.mark.usefixtures("one_thread")
MEASURES = {"axisymmetric": (2, 3), "plane_strain": (2, 3), "solid": (2, 1, 2)}
ROUND_OFF = 1e-12
"""Relative to the largest entry: some thousand operations of 1e-16 each, and cancellation of W1, W2 and pressure terms."""
KINDS = sorted(kinds(Material).items())
RESISTING = 1
"""Seed with which elements resist the change of volume that pressures leave, each with a stiffness of its own."""


def mesh_of(measure: str) -> QuadraticMesh:
    """A jittered box; regions 0 and 1 alternate."""
    counts = MEASURES[measure]
    mesh = box([1.0] * len(counts), counts, jitter=0.2, seed=3)
    nodes = mesh.nodes + (np.array([0.3, 0.0]) if measure == "axisymmetric" else 0.0)
    return QuadraticMesh(nodes, mesh.elements, np.arange(len(mesh.elements)) % 2)


def random_unknowns(body: Body, seed: int) -> np.ndarray:
    """Displacements that keep every J > 0, and pressures of the size of the shear modulus."""
    generator = np.random.default_rng(seed)
    unknowns = np.empty(body.space.size)
    u, p = body.space.split(unknowns)
    stretch = np.eye(body.space.dim) + generator.uniform(-0.2, 0.2, (body.space.dim, body.space.dim))
    u[:] = body.space.nodes @ (stretch - np.eye(body.space.dim)).T + generator.uniform(-0.01, 0.01, u.shape)
    p[:] = generator.normal(size=p.shape) * body.materials[0].shear_modulus
    assert body.kinematics(unknowns).J.min() > 0.1
    return unknowns


def with_random_history(body: Body, seed: int) -> Body:
    """In a time step, with a history stress as large as the shear modulus."""
    generator = np.random.default_rng(seed)
    shape, modulus = body.points.weights.shape, body.materials[0].shear_modulus
    return body.with_relaxation(
        RelaxationStep(generator.uniform(0.2, 1.0, shape[0]), modulus * generator.normal(size=(6, *shape)))
    )


@pytest.mark.parametrize("relaxing", [False, True], ids=["elastic", "relaxing"])
@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("kind", [name for name, _ in KINDS])
@pytest.mark.parametrize("seed", [1, 2])
def test_compiled_loops_equal_the_readable_forms(measure, kind, seed, relaxing):
    material = dict(KINDS)[kind].example()
    other = MooneyRivlin2(c10=0.4 * material.shear_modulus, c01=0.1 * material.shear_modulus, bulk_modulus=material.shear_modulus)
    mesh = mesh_of(measure)
    stiffness = np.linspace(1.0, 20.0, len(mesh.elements)) if seed == RESISTING else 0.0
    body = body_of(mesh, measure, material, other, volume_stiffness=stiffness)
    body = with_random_history(body, seed) if relaxing else body
    unknowns = random_unknowns(body, seed)
    split = body.space.displacement_size
    compiled, readable = body.residual(unknowns), forms.residual(body, unknowns)
    assert_close(compiled[:split], readable[:split], ROUND_OFF)
    assert_close(compiled[split:], readable[split:], ROUND_OFF)
    difference = (body.pattern.matrix(body.tangent(unknowns)) - forms.tangent(body, unknowns)).toarray()
    expected = forms.tangent(body, unknowns).toarray()
    for rows in (slice(None, split), slice(split, None)):
        for columns in (slice(None, split), slice(split, None)):
            block = expected[rows, columns]
            assert_close(difference[rows, columns] + block, block, ROUND_OFF, scale=max(np.abs(block).max(), 1e-300))


@pytest.mark.parametrize("measure", MEASURES)
def test_a_wrong_coefficient_is_seen(measure):
    material = MooneyRivlin2(c10=80.0, c01=20.0)
    wrong = MooneyRivlin2(c10=80.0, c01=20.0 * (1 + 1e-9))
    body, broken = (body_of(mesh_of(measure), measure, m, m) for m in (material, wrong))
    unknowns = random_unknowns(body, 1)
    with pytest.raises(AssertionError):
        assert_close(broken.residual(unknowns), forms.residual(body, unknowns), ROUND_OFF)


@pytest.mark.parametrize("measure", MEASURES)
def test_the_history_stress_is_part_of_the_tangent(measure):
    body = with_random_history(body_of(mesh_of(measure), measure, MooneyRivlin2.example(), LinearElastic.example()), 3)
    unknowns, direction = random_unknowns(body, 5), random_unknowns(body, 6)
    step = 1e-6
    ahead, behind = (body.residual(unknowns + sign * step * direction) for sign in (1, -1))
    difference = (ahead - behind) / (2 * step)
    assert_close(body.pattern.matrix(body.tangent(unknowns)) @ direction, difference, 1e-7)
    forgotten = body.with_relaxation(RelaxationStep(body.relaxation.scale, 0 * body.relaxation.stress))
    with pytest.raises(AssertionError):
        assert_close(body.pattern.matrix(forgotten.tangent(unknowns)) @ direction, difference, 1e-7)


@pytest.mark.parametrize("measure", MEASURES)
def test_deformation_and_invariants_equal_the_readable_ones(measure):
    body = body_of(mesh_of(measure), measure, MooneyRivlin2.example(), LinearElastic.example())
    unknowns = random_unknowns(body, 4)
    state, F = body.kinematics(unknowns), forms.deformation_gradient(body, unknowns)
    C = np.einsum("iJ...,iK...->JK...", F, F)
    J = np.linalg.det(np.moveaxis(F, (0, 1), (-2, -1)))
    trace = np.einsum("JJ...->...", C)
    assert_close(state.F, F, ROUND_OFF)
    assert_close(state.J, J, ROUND_OFF)
    assert_close(state.I1, J ** (-2 / 3) * trace, ROUND_OFF)
    assert_close(state.I2, J ** (-4 / 3) * (trace**2 - np.einsum("JK...,JK...->...", C, C)) / 2, ROUND_OFF)


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("kind", [name for name, _ in KINDS])
def test_the_elastic_stress_is_that_of_the_material(measure, kind):
    material, other = dict(KINDS)[kind].example(), MooneyRivlin2.example()
    body = with_random_history(body_of(mesh_of(measure), measure, material, other), 3)
    state = body.kinematics(random_unknowns(body, 4))
    expected = np.zeros((3, 3, *state.J.shape))
    for index, law in enumerate((material, other)):
        mine = body.regions == index
        P = np.moveaxis(law.first_piola_kirchhoff(state.F[:, :, mine], np.zeros(state.J[mine].shape)), (0, 1), (-2, -1))
        F = np.moveaxis(state.F[:, :, mine], (0, 1), (-2, -1))
        expected[:, :, mine] = np.moveaxis(P if law.small_strain else np.linalg.solve(F, P), (-2, -1), (0, 1))
    stress = elastic_stress(body, state)
    assert_close(stress, expected[ROWS_AND_COLUMNS], ROUND_OFF)
    with pytest.raises(AssertionError):
        assert_close(stress, expected.swapaxes(0, 1)[::-1][ROWS_AND_COLUMNS], ROUND_OFF)


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("kind", [name for name, _ in KINDS])
def test_what_has_relaxed_and_what_has_not_yet_is_the_elastic_force(measure, kind):
    """With the resistance to changes of volume; mutant: that is no part of the history."""
    material, other = dict(KINDS)[kind].example(), MooneyRivlin2.example()
    body = body_of(mesh_of(measure), measure, material, other, volume_stiffness=3.0)
    unknowns, left = random_unknowns(body, 4), np.random.default_rng(5).uniform(0.2, 1.0, len(body.regions))
    forces = slice(body.space.displacement_size)
    whole, state = body.residual(unknowns)[forces], body.kinematics(unknowns)

    def check(stress):
        step = RelaxationStep(left, (1 - left)[:, None] * stress)
        assert_close(body.with_relaxation(step).residual(unknowns)[forces], whole, ROUND_OFF)

    check(elastic_stress(body, state, unknowns))
    assert_kills(check, without=(elastic_stress(body, state),))
