"""Systems of bodies that are their own mirror images: solved by a part as by the whole, and known where they are not.

Mutants: displacements across a plane without their sign, those of nodes on the plane kept, orbits without the roots of their
lengths, pressures of another region, materials not looked at.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.solvers.linear import LinearSystem, direct_solver, has_pardiso
from tactsim.fem.solvers.mirror_images import ReducedMatrices, mirror_images
from tactsim.fem.solvers.mirrored_solver import MirroredSolver
from tactsim.fem.solvers.reused_factor import ReusedFactor
from tactsim.fem.solvers.solver_choice import solver_for
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block
from tactsim.mesh.inclusions.sphere import Sphere

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


def mirrored_state(body):
    """Unknowns that are their own images in the middle planes across all axes: odd across, even along each."""
    space = body.space
    unknowns = np.zeros(space.size)
    u, p = space.split(unknowns)
    x, y, z = (2 * space.nodes / SIZE - 1).T
    u[:] = 1e-3 * np.stack([x * (1 - y**2) * (2 + z**2), y * (1 + x**2), -z * (1 + x**2 * y**2)], axis=1)
    p[:] = -1e3 * (1 + z**2 + x**2)[space.pressure_corners]
    return unknowns


def system(body):
    """The tangent at a mirrored state, held by springs, and a mirrored right-hand side."""
    state = mirrored_state(body)
    data, held = body.tangent(state), np.arange(body.space.displacement_size)
    data[body.pattern.positions(held, held)] += 1.0
    matrix = body.pattern.matrix(data)
    return matrix, matrix @ state


def mirrored(body, matrix):
    images = mirror_images(body)
    return MirroredSolver(images, ReducedMatrices(images, matrix), ReusedFactor(direct_solver()))


@pytest.mark.parametrize(
    ("make", "parts"),
    [
        (lumped, 8),
        (lambda: lumped((0.008, 0.01, 0.005)), 4),
        (lambda: ended(SOFT, SOFT), 8),
        (lambda: ended(HARD, HARD), 8),
        (lambda: ended(HARD, HARDER), 4),
    ],
    ids=["lump in the middle", "lump aside", "plain", "ends alike", "ends unlike"],
)
def test_an_unknown_stands_for_its_images(make, parts):
    one = make()
    images, state = mirror_images(one), mirrored_state(one)
    assert one.space.size / parts < len(images.first) < 2 * one.space.size / parts, "nodes on the planes stand for fewer"
    assert_allclose(images.whole(images.reduced(state)), state, rtol=0, atol=1e-12 * np.abs(state).max())
    assert np.linalg.norm(images.reduced(state)) == pytest.approx(np.linalg.norm(state), rel=1e-12)
    some = np.random.default_rng(1).normal(size=one.space.size)
    part = images.whole(images.reduced(some))
    assert part @ (some - part) == pytest.approx(0, abs=1e-10 * (some @ some))
    for axis in range(3 if parts == 8 else 0):
        moved = np.zeros(one.space.size)
        one.space.split(moved)[0][:, axis] = 1.0
        assert np.abs(images.reduced(moved)).max() < 1e-12, "a motion of the whole body is nobody's image"


def test_a_body_that_no_plane_mirrors_has_none():
    assert mirror_images(lumped((0.008, 0.007, 0.004))) is None


def test_the_part_solves_as_the_whole_does():
    one = lumped()
    matrix, right = system(one)
    reduced = ReducedMatrices(mirror_images(one), matrix).of(matrix)
    assert np.abs((reduced - reduced.T).data).max() < 1e-9 * np.abs(matrix.data).max()
    solver = mirrored(one, matrix)
    solver.factor(LinearSystem(matrix))
    assert_allclose(solver.solve(right), mirrored_state(one), atol=1e-9 * np.abs(mirrored_state(one)).max())
    solver.close()
    with pytest.raises(InputError):
        solver.solve(right)


def test_what_is_not_its_own_image_is_known():
    one = lumped()
    matrix, right = system(one)
    solver = mirrored(one, matrix)
    solver.factor(LinearSystem(matrix))
    aside = right.copy()
    aside[0] += np.abs(right).max()
    with pytest.raises(ConvergenceError, match="mirror"):
        solver.solve(aside)
    with pytest.raises(ConvergenceError, match="mirror"):
        solver.solve(np.full_like(right, np.nan))
    uneven = matrix.copy()
    uneven.data[uneven.indptr[0] : uneven.indptr[300]] *= 3
    solver.factor(LinearSystem(uneven))
    with pytest.raises(ConvergenceError, match="mirror"):
        solver.solve(right)


@pytest.mark.skipif(not has_pardiso(), reason="without Pardiso bodies are solved whole")
def test_the_whole_takes_over_where_a_load_has_no_image():
    one = lumped()
    matrix, right = system(one)
    aside = right.copy()
    aside[:3] += np.abs(right).max()
    solver = solver_for(one)
    for given, mirrored_now in ((right, True), (aside, False), (right, False)):
        solver.factor(LinearSystem(matrix))
        solution = solver.solve(given, 1e-10)
        assert np.linalg.norm(matrix @ solution - given) < 1e-9 * np.linalg.norm(given)
        assert ("mirrored" in solver.name) is mirrored_now
