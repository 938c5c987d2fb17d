"""The part of a body that stands for the whole: what it computes of a mirrored state is what the whole computes there.

Mutants: displacements across a plane without their sign, forces at nodes on a plane not shared, entries between them counted
once, pressures of another region, materials not looked at, planes that cut elements.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from solids import facets_where, on_plane

from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.dead_load import DeadLoad
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.assembly.regularising_springs import AnchoredSprings, RegularisingSprings
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.balance import ExternalForces
from tactsim.fem.equilibrium.diagnosis import element_in_words
from tactsim.fem.equilibrium.mirrored_part import mirrored_part
from tactsim.fem.equilibrium.mirrored_problem import MirroredProblem
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.structured_block import structured_block

SIZE = np.array([0.03, 0.02, 0.01])
COARSE = BlockMeshSettings(size=10e-3, inclusion_size=0.8e-3, edge_size=4e-3, growth=2)
"""An even number of cells across the lump: with an odd one the tetrahedra are no images of one another."""
SOFT, HARD, HARDER = NeoHookean(c10=1e3), NeoHookean(c10=1e4, bulk_modulus=1e6), NeoHookean(c10=2e4)


@cache
def lumped(center=(0.015, 0.01, 0.005)):
    """A block with one lump."""
    mesh = graded_block(SIZE, [Sphere(center=center, radius=0.002)], COARSE).mesh
    return body_of(mesh, mesh.regions, SOFT, HARD)


@cache
def ended(*ends):
    """A block of one tissue with an end of another on the left and on the right."""
    mesh = graded_block(SIZE, [], COARSE).mesh
    x = mesh.nodes[mesh.elements[:, :4], 0].mean(axis=1) / SIZE[0]
    return body_of(mesh, np.where(x < 1 / 3, 1, np.where(x > 2 / 3, 2, 0)), SOFT, *ends)


def body_of(mesh, regions, *materials):
    return Body(TaylorHood(mesh.nodes, mesh.elements, "solid", regions), materials, regions, volume_stiffness=3.0)


def stiffness(load, body, displacement):
    """What a load adds to the tangent."""
    data = np.zeros(len(body.pattern.indices))
    load.add_stiffness(data, displacement)
    return body.pattern.matrix(data)


def mirrored_state(body):
    """Unknowns that are their own images in the middle planes across all axes: odd across, even along each."""
    space = body.space
    unknowns = np.zeros(space.size)
    u, p = space.split(unknowns)
    x, y, z = (2 * space.nodes / SIZE - 1).T
    u[:] = 3e-4 * np.stack([x * (1 - y**2) * (2 + z**2), y * (1 + x**2), -z * (1 + x**2 * y**2)], axis=1)
    p[:] = -1e3 * (1 + z**2 + x**2)[space.pressure_corners]
    return unknowns


@pytest.mark.parametrize(
    ("make", "copies"),
    [
        (lumped, 8),
        (lambda: lumped((0.008, 0.01, 0.005)), 4),
        (lambda: ended(SOFT, SOFT), 8),
        (lambda: ended(HARD, HARD), 8),
        (lambda: ended(HARD, HARDER), 4),
    ],
    ids=["lump in the middle", "lump aside", "plain", "ends alike", "ends unlike"],
)
def test_the_part_computes_what_the_whole_does(make, copies):
    whole = make()
    part, state = mirrored_part(whole), mirrored_state(whole)
    assert part.copies == copies
    assert part.body.points.weights.sum() == pytest.approx(whole.points.weights.sum() / copies, rel=1e-12)
    assert_allclose(part.unfolded(part.folded(state)), state, rtol=0, atol=1e-12 * np.abs(state).max())
    free = np.ones(part.body.space.size, bool)
    free[part.held] = False
    assert (part.folded(state)[part.held] == 0).all()
    forces = whole.residual(state)
    assert_allclose(
        part.body.residual(part.folded(state))[free], part.own.share(forces)[free], rtol=0, atol=1e-11 * np.abs(forces).max()
    )
    tangent, own = whole.tangent(state), part.body.tangent(part.folded(state))
    for direction in np.random.default_rng(3).standard_normal((5, part.body.space.size)) * free:
        given = part.own.share(whole.pattern.matrix(tangent) @ part.unfolded(direction))[free]
        assert_allclose((part.body.pattern.matrix(own) @ direction)[free], given, rtol=0, atol=1e-11 * np.abs(given).max())


def test_loads_on_the_whole_act_on_the_part():
    whole = lumped()
    part, u = mirrored_part(whole), whole.space.split(mirrored_state(whole))[0]
    springs = AnchoredSprings(whole, 0.1, np.zeros(whole.space.size))
    (load,) = part.forces(ExternalForces(loads=(springs,))).loads
    displacement = u[part.nodes]
    assert_allclose(load.force(displacement), part.own.share(springs.force(u)), rtol=1e-12)
    moved = stiffness(load, part.body, displacement) @ np.ones(part.body.space.size)
    assert_allclose(moved, part.own.share(stiffness(springs, whole, u) @ np.ones(whole.space.size)), rtol=1e-12)


def test_a_dead_load_on_the_whole_acts_on_the_part():
    whole = lumped()
    part, u = mirrored_part(whole), whole.space.split(mirrored_state(whole))[0]
    weight = DeadLoad(np.where(np.arange(whole.space.size) < whole.space.displacement_size, mirrored_state(whole), 0.0)).at(2.0)
    (load,) = part.forces(ExternalForces(loads=(weight,))).loads
    assert_allclose(load.force(u[part.nodes]), part.own.share(weight.force(u)), rtol=1e-12)
    assert not stiffness(load, part.body, u[part.nodes]).data.any()


def test_pressure_on_the_whole_acts_on_the_part():
    mesh = graded_block(SIZE, [Sphere(center=SIZE / 2, radius=0.002)], COARSE).mesh
    ends = np.concatenate([facets_where(mesh, on_plane(0, place)) for place in (0.0, SIZE[0])])
    whole = lumped()
    part, u = mirrored_part(whole), whole.space.split(mirrored_state(whole))[0]
    pressure = FollowerPressure(whole.space, ends, whole.pattern, 300.0)
    (load,) = part.forces(ExternalForces(loads=(pressure,))).loads
    displacement, free = u[part.nodes], np.setdiff1d(np.arange(part.body.space.size), part.held)
    assert_allclose(load.force(displacement)[free], part.own.share(pressure.force(u))[free], rtol=0, atol=1e-12)
    moved = mirrored_part(whole).folded(mirrored_state(whole))
    moved[part.body.space.displacement_size :] = 0.0
    unfolded = part.unfolded(moved)
    given = part.own.share(stiffness(pressure, whole, u) @ unfolded)
    own = stiffness(load, part.body, displacement) @ moved
    assert_allclose(own[free], given[free], rtol=0, atol=1e-11 * np.abs(given).max())


def test_the_tangent_of_a_whole_that_mirrors_itself_is_never_laid_out():
    """That of a grasp of 77 000 unknowns takes a second, and an eighth of it stands for all."""
    mesh = graded_block(SIZE, [], COARSE).mesh
    whole = body_of(mesh, mesh.regions, SOFT)
    problem = MirroredProblem(mirrored_part(whole), options=NewtonOptions())
    rest = 1e-3 * (whole.space.nodes / SIZE - 0.5).ravel()
    anchored = AnchoredSprings(whole, 0.3, np.concatenate([rest, np.zeros(whole.space.size - len(rest))]))
    ends = np.concatenate([facets_where(mesh, on_plane(0, place)) for place in (0.0, SIZE[0])])
    pressure, none = FollowerPressure(whole.space, ends, whole.pattern, 10.0), DeadLoad(np.zeros(whole.space.size)).at(1.0)
    problem.solve(np.zeros(whole.space.size), loads=[anchored, pressure, none, RegularisingSprings(whole)])
    assert problem.copies == 8
    assert "_structure" not in vars(whole.pattern)


def test_a_part_relaxes_by_the_loops_of_the_whole():
    """Numba takes half a minute to compile them anew for stresses in another order of memory."""
    whole = lumped()
    part, shape = mirrored_part(whole), whole.points.weights.shape
    generator = np.random.default_rng(0)
    step = RelaxationStep(generator.random(shape[0]), generator.random((6, *shape)))
    own = part.relaxation(step)
    assert np.array_equal(own.stress, step.stress[:, part.elements])
    assert np.array_equal(own.scale, step.scale[part.elements])
    assert own.stress.flags.c_contiguous


def test_bodies_that_no_plane_mirrors_have_no_part():
    assert mirrored_part(lumped((0.008, 0.007, 0.004))) is None
    block = structured_block(SIZE, (3, 3, 3)).mesh
    assert mirrored_part(body_of(block, block.regions, SOFT)) is None, "its tetrahedra are no images, and planes cut some"


def test_messages_number_elements_as_in_the_whole():
    whole = lumped()
    part = mirrored_part(whole)
    assert element_in_words(part.body, 5) == element_in_words(whole, int(part.elements[5]))


def test_the_whole_is_solved_once_what_acts_is_no_image_of_itself():
    whole = ended(SOFT, SOFT)
    even, uneven = (np.zeros(whole.space.size) for _ in range(2))
    whole.space.split(even)[0][:] = 1e-3 * (whole.space.nodes / SIZE - 0.5)
    whole.space.split(uneven)[0][:, 0] = 1e-3 * (whole.space.nodes[:, 1] / SIZE[1]) ** 2
    options, start = NewtonOptions(), np.zeros(whole.space.size)
    problem = MirroredProblem(mirrored_part(whole), options=options)
    plain = Problem(whole, np.zeros(0, int), options=options)
    sizes = []
    for rest in (even, uneven, even):
        loads = [AnchoredSprings(whole, 0.3, rest), RegularisingSprings(whole)]
        found, asked = (one.solve(start, loads=loads) for one in (problem, plain))
        assert_allclose(found.unknowns, asked.unknowns, rtol=0, atol=1e-8 * np.abs(asked.unknowns).max())
        sizes.append(problem.solver)
    assert sizes[0] is not sizes[1] is sizes[2], "from the first uneven load on"
