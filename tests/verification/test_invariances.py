"""Properties of the solver that need no reference: scaling laws, units, objectivity (verification.md, 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from mutants import assert_kills
from small_problems import CUBE, EXTENSION, PLANES, result_of
from solids import assert_close, body_of, box, facets_where, held

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.history_variables import step_error
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.solvers.linear import direct_solver
from tactsim.interfaces import Material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_5 import MooneyRivlin5
from tactsim.mechanics.paths import history_path
from tactsim.mesh.quadratic import QuadraticMesh

pytestmark = pytest.mark.usefixtures("one_thread")
MEASURES = ["axisymmetric", "plane_strain", "solid"]
TOLERANCE = 1e-12
"""Of displacements, pressures and forces: round-off, since Newton takes the same path; 3e-15 was seen."""
MODULI = {"c10": 3e3, "c01": 1e3, "c20": 2e3, "c11": 500.0, "c02": 100.0, "bulk_modulus": 2e5}


@dataclass(frozen=True)
class Squeezed:
    """What a squeezed block shows: displacement (n, d), pressure at the corners, reaction (d,) on its base."""

    displacement: Array
    pressure: Array
    reaction: Array


def block(measure: str, *, length: float = 1.0) -> QuadraticMesh:
    """An unstructured block of 20 mm, times ``length``."""
    dim = 3 if measure == "solid" else 2
    mesh = box([0.02] * dim, [3, 3, 2][:dim], jitter=0.2, seed=4)
    return mesh.moved(mesh.nodes * length)


def squeeze(
    measure: str, *, modulus: float = 1.0, length: float = 1.0, solver: str | None = None, spoil: float = 0.0
) -> Squeezed:
    """A block of moduli times ``modulus`` glued to its base, its top pushed down by 15 % and its side under pressure.

    ``spoil`` changes c01 by that part.
    """
    mesh = block(measure, length=length)
    material = MooneyRivlin5(**{name: value * modulus for name, value in MODULI.items()})
    material = material.model_copy(update={"c01": material.c01 * (1 + spoil)})
    body, top, dim = body_of(mesh, measure, material), 0.02 * length, mesh.dim
    base = np.concatenate([held(mesh, axis, lambda nodes: nodes[:, 1] == 0.0) for axis in range(dim)])
    axis_unknowns = held(mesh, 0, lambda nodes: nodes[:, 0] == 0.0)
    pushed = held(mesh, 1, lambda nodes: np.isclose(nodes[:, 1], top))
    side = facets_where(mesh, lambda nodes: np.isclose(nodes[:, 0], top))
    load = FollowerPressure(body.space, side, body.pattern, 0.0)
    problem = Problem(body, np.concatenate([base, axis_unknowns, pushed]), solver=direct_solver(solver))
    unknowns = np.zeros(body.space.size)
    for share in (1 / 3, 2 / 3, 1.0):
        unknowns = unknowns.copy()
        unknowns[pushed], load.pressure = -0.15 * top * share, 500.0 * modulus * share
        unknowns = problem.solve(unknowns, loads=[load]).unknowns
    problem.solver.close()
    u, p = body.space.split(unknowns)
    forces = body.space.split(body.residual(unknowns))[0]
    return Squeezed(u, p, forces[mesh.nodes[:, 1] == 0.0].sum(axis=0))


def assert_same(actual: Squeezed, expected: Squeezed, *, length: float = 1.0, pressure: float = 1.0, force: float = 1.0) -> None:
    """Equal up to the given factors."""
    assert_close(actual.displacement, expected.displacement * length, TOLERANCE)
    assert_close(actual.pressure, expected.pressure * pressure, TOLERANCE)
    assert_close(actual.reaction, expected.reaction * force, TOLERANCE)


@pytest.mark.parametrize("measure", MEASURES)
def test_moduli_scale_pressures_and_forces(measure, verification_record):
    """Mutant: one modulus, c01, is left as it was."""
    plain = squeeze(measure)
    stiffer = squeeze(measure, modulus=7.0)
    assert_same(stiffer, plain, pressure=7.0, force=7.0)
    known = {"reference": "dimensional analysis", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": TOLERANCE}
    verification_record("moduli times 7, reaction", stiffer.reaction, 7 * plain.reaction, **known)
    with pytest.raises(AssertionError):
        assert_same(squeeze(measure, modulus=7.0, spoil=1 / 7 - 1), plain, pressure=7.0, force=7.0)


@pytest.mark.parametrize("measure", MEASURES)
def test_lengths_scale_forces_by_their_square(measure, verification_record):
    """Force per unit thickness, in plane strain, by the first power."""
    power = 1 if measure == "plane_strain" else 2
    scaled, plain = squeeze(measure, length=3.0), squeeze(measure)
    assert_same(scaled, plain, length=3.0, force=3.0**power)
    known = {"reference": "dimensional analysis", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": TOLERANCE}
    verification_record("lengths times 3, reaction", scaled.reaction, 3.0**power * plain.reaction, **known)
    with pytest.raises(AssertionError):
        assert_same(scaled, plain, length=3.0, force=3.0 ** (3 - power))


@pytest.mark.parametrize("measure", MEASURES)
def test_millimetres_and_megapascals_give_what_metres_and_pascals_give(measure, verification_record):
    force = 1e-3 if measure == "plane_strain" else 1.0  # N/mm there
    millimetres, metres = squeeze(measure, length=1e3, modulus=1e-6), squeeze(measure)
    assert_same(millimetres, metres, length=1e3, pressure=1e-6, force=force)
    known = {"reference": "metres and pascals", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": TOLERANCE}
    verification_record("millimetres and megapascals, reaction", millimetres.reaction, force * metres.reaction, **known)
    with pytest.raises(AssertionError):  # thickness of a millimetre or a metre taken for the other
        assert_same(millimetres, metres, length=1e3, pressure=1e-6, force=1e-3 / force)


@pytest.mark.parametrize("measure", [*MEASURES[:2], pytest.param("solid", marks=pytest.mark.slow)])
def test_superlu_gives_what_pardiso_gives(measure, verification_record):
    one, other = squeeze(measure, solver="superlu"), squeeze(measure, solver="pardiso")
    assert_same(one, other)
    known = {"reference": "PARDISO", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": TOLERANCE}
    verification_record("displacement by SuperLU", one.displacement, other.displacement, **known)
    with pytest.raises(AssertionError):
        assert_same(squeeze(measure, solver="superlu", spoil=1e-7), squeeze(measure, solver="pardiso"))


def rotation(dim: int) -> Array:
    """A rotation by 70 degrees in the plane, or about a skew axis."""
    if dim == 2:
        angle = np.radians(70)
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    Q, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    return Q * np.linalg.det(Q)


def forces_and_state(measure: str, material: Material) -> tuple[Body, Array, Array]:
    """A body, a deformed state with pressure, and its internal forces (n, d)."""
    body = body_of(block(measure), measure, material)
    unknowns = np.zeros(body.space.size)
    u, p = body.space.split(unknowns)
    generator = np.random.default_rng(1)
    u[:] = generator.uniform(-2e-4, 2e-4, u.shape) + body.space.nodes * 0.1
    p[:] = generator.normal(size=p.shape) * material.shear_modulus
    return body, unknowns, body.space.split(body.residual(unknowns))[0]


def rotated_forces(body: Body, unknowns: Array, Q: Array) -> Array:
    """Internal forces (n, d) after the deformed body was turned by Q."""
    turned = unknowns.copy()
    u, _ = body.space.split(turned)
    u[:] = (body.space.nodes + u) @ Q.T - body.space.nodes
    return body.space.split(body.residual(turned))[0]


def assert_isotropic(measure: str, material: Material) -> tuple[Array, Array]:
    """The forces of a body are those of one whose reference is turned by Q, at the same place of every particle; both."""
    body, unknowns, forces = forces_and_state(measure, material)
    turned = body.space.nodes @ rotation(body.space.dim).T
    other = body_of(QuadraticMesh(turned, body.space.elements, body.regions), measure, material)
    state = unknowns.copy()
    other.space.split(state)[0][:] += body.space.nodes - turned
    found = other.space.split(other.residual(state))[0]
    assert_close(found, forces, 1e-12)  # round-off
    return found, forces


def assert_objective(measure: str, material: Material) -> tuple[Array, Array]:
    """The forces of a turned body are the turned forces; both."""
    body, unknowns, forces = forces_and_state(measure, material)
    Q = rotation(body.space.dim)
    found, expected = rotated_forces(body, unknowns, Q), forces @ Q.T
    assert_close(found, expected, 1e-12)  # round-off
    return found, expected


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
def test_the_forces_of_a_turned_body_are_the_turned_forces(measure, verification_record):
    known = {"reference": "the forces turned", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": 1e-12}
    verification_record("forces of a turned body", *assert_objective(measure, MooneyRivlin5(**MODULI)), **known)
    with pytest.raises(AssertionError):  # small strains are not objective
        assert_objective(measure, LinearElastic(youngs_modulus=1e4, poisson_ratio=0.4))


@pytest.mark.parametrize("measure", ["plane_strain", "solid"])
def test_the_forces_of_a_body_cut_in_another_direction_are_the_same(measure, verification_record):
    known = {"reference": "itself, turned before", "kind": "invariance", "mesh": f"{measure}, distorted", "tolerance": 1e-12}
    verification_record("forces of a body cut elsewhere", *assert_isotropic(measure, MooneyRivlin5(**MODULI)), **known)
    with pytest.raises(AssertionError):  # small strains take the turn for a strain
        assert_isotropic(measure, LinearElastic(youngs_modulus=1e4, poisson_ratio=0.4))


def test_an_axisymmetric_body_does_not_feel_a_shift_along_its_axis(verification_record):
    body, unknowns, forces = forces_and_state("axisymmetric", MooneyRivlin5(**MODULI))
    shifted = unknowns.copy()
    body.space.split(shifted)[0][:, 1] += 0.3
    found = body.space.split(body.residual(shifted))[0]
    assert_close(found, forces, 1e-12)  # round-off
    known = {"reference": "the body where it was", "kind": "invariance", "mesh": "axisymmetric, distorted", "tolerance": 1e-12}
    verification_record("forces of a body shifted along its axis", found, forces, **known)
    body.space.split(shifted)[0][:, 0] += 1e-6
    with pytest.raises(AssertionError):
        assert_close(body.space.split(body.residual(shifted))[0], forces, 1e-12)


@pytest.mark.parametrize("measure", MEASURES)
def test_the_forces_of_a_body_balance(measure, verification_record):
    """No net force in any direction that a rigid shift may take, whatever the deformation.

    Mutants: nodes in the middles of edges left out, and the radial forces, which the hoop stress does not let balance.
    """
    body, _, forces = forces_and_state(measure, MooneyRivlin5(**MODULI))
    along = forces[:, 1:] if measure == "axisymmetric" else forces

    def check(forces):
        assert_close(forces.sum(axis=0), 0.0, 1e-13, scale=np.abs(forces).sum())  # round-off

    check(along)
    known = {"reference": "balance", "kind": "exact", "mesh": f"{measure}, distorted", "tolerance": 1e-13}
    verification_record("sum of the forces of a body", along.sum(axis=0), 0.0, scale=np.abs(along).sum(), **known)
    corners = np.unique(body.space.elements[:, : body.space.dim + 1])
    assert_kills(check, corners=(along[corners],))
    if measure == "axisymmetric":
        assert_kills(check, radial=(forces,))


def test_a_small_load_is_followed_as_closely_in_time_as_one_a_hundred_times_larger(monkeypatch, verification_record):
    """Both in the linear range. Mutant: an error that counts by at least 1e-7 of the modulus, which takes 83 steps, not 106."""

    def extensions(load: float) -> list[float]:
        pieces = [
            {"kind": "ramp", "to": 1.0, "duration": 3.0},
            {"kind": "sine", "amplitude": 0.5, "frequency": 0.5, "duration": 4.0},
        ]
        result = result_of(
            geometry=CUBE,
            material={"kind": "neo_hookean", "c10": 3e3, "relaxation": {"fractions": [0.3, 0.45], "times": [0.2, 8.0]}},
            conditions=[*PLANES, {"kind": "traction", "face": "top", "z": load}],
            amplitude={"pieces": pieces},
            time={"tolerance": 1e-3},
            steps=10,
            asked=EXTENSION,
        )
        return [step.values["number"] / load for step in result.steps]

    def check(small):
        assert len(small) == pytest.approx(len(large), abs=3)
        assert small[-1] == pytest.approx(large[-1], rel=2e-5)

    large, small = extensions(6e-3), extensions(6e-5)
    check(small)
    known = {"reference": "a load a hundred times as large", "kind": "invariance", "mesh": "one cell", "tolerance": 2e-5}
    verification_record("relaxing cube under a small load, extension over load", small[-1], large[-1], **known)
    monkeypatch.setattr(history_path, "step_error", lambda body, state, least: step_error(body, state, max(least, 1e-7 * 6e3)))
    assert_kills(check, part_of_modulus=(extensions(6e-5),))
