"""The iterative solver against the factor, on blocks with and without contact, and on systems that have no solution."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from solids import body_of, box, facets_where, held, on_plane

from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.balance import rounding_forces
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.solvers.block_preconditioner import FINEST_STEP, MOST_WITH_OLD, BlockPreconditioned
from tactsim.fem.solvers.linear import LOOSENESS, SuperLU, direct_solver, solved
from tactsim.fem.solvers.pardiso import FactorSize, QuasiDefinitePardiso
from tactsim.fem.solvers.reused_factor import WORTH_A_FACTOR, ReusedFactor
from tactsim.fem.solvers.solver_choice import (
    analysed,
    factor_seconds,
    factored,
    giving_way,
    iterated,
    solutions_per_factor,
    solver_for,
)
from tactsim.fem.solvers.two_level import linear_interpolation
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

SIZE = np.array([0.02, 0.02, 0.01])
BULK = {"exactly": None, "nearly": 1e6}
FRICTION = 0.6
RUBBER = MooneyRivlin2(c10=1000.0, c01=685.0)


def system(cells, **posed):
    """A body, and a matrix and a right-hand side of which each test has its own."""
    body, matrix, right = made_system(cells, **posed)
    return body, matrix.copy(), right.copy()


@cache
def made_system(cells, *, bulk_modulus=None, contact=True, hold=True, giving_way=0.0):
    """The body, its tangent at a strain of percents and a right-hand side, the floor held and a slipping contact on the top.

    Along the edge of the contact the rigid body is round: its pressure over its radius, ``giving_way`` times the penalty, is
    taken from the stiffness along it.
    """
    mesh = box(SIZE, cells)
    body = body_of(mesh, "solid", MooneyRivlin2(c10=1000.0, c01=685.0, bulk_modulus=bulk_modulus))
    generator, space = np.random.default_rng(3), body.space
    unknowns = np.zeros(space.size)
    u, p = space.split(unknowns)
    u[:] = np.einsum("ij,nj->ni", [[0.02, 0.01, 0.0], [0.0, 0.02, 0.01], [0.0, 0.0, -0.04]], mesh.nodes)
    p[:] = -100.0
    data = body.tangent(unknowns)
    if contact:
        facets = facets_where(mesh, on_plane(2, SIZE[2]))
        points = space.surface_points(facets)
        along = points.interpolate(mesh.nodes)[0] / SIZE[0]
        penalty = np.where(along < 0.7, 3370.0 / 5e-7, 0.0)
        derivative = np.zeros((3, 3, len(penalty)))
        derivative[2, 2], derivative[0, 2] = -penalty, FRICTION * penalty
        derivative[0, 0] = giving_way * np.where(along > 0.6, penalty, 0.0)
        SurfaceAssembly(points, body.pattern, 3).add_stiffness(data, derivative)
    floor = np.concatenate([held(mesh, axis, on_plane(2, 0.0)) for axis in range(3)]) if hold else np.zeros(0, int)
    constraints = Constraints(floor, body.pattern)
    matrix = body.pattern.matrix(constraints.apply(data))
    forces = np.repeat(rounding_forces(body), 3) * generator.normal(size=space.displacement_size)
    volumes = 0.01 * body.points.weights.sum() / space.corner_count * generator.normal(size=space.corner_count)
    return body, matrix, constraints.free(np.concatenate([forces, volumes]))


@pytest.mark.parametrize("bulk", BULK)
@pytest.mark.parametrize("contact", [False, True])
def test_it_solves_as_the_factor_does(bulk, contact):
    body, matrix, right = system((5, 5, 3), bulk_modulus=BULK[bulk], contact=contact)
    direct, iterative = direct_solver(), BlockPreconditioned(body)
    expected = solved(direct, matrix, right)
    computed = solved(iterative, matrix, right, 1e-11)
    for exact, mine in zip(body.space.split(expected), body.space.split(computed), strict=True):
        # 1e-10 of the largest, the residual being asked to 1e-11
        np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-10 * np.abs(exact).max())
    direct.close()
    iterative.close()


def test_the_coarser_accuracy_is_kept_and_cheaper():
    body, matrix, right = system((5, 5, 3))
    solver = BlockPreconditioned(body)
    counts = {}
    for accuracy in (1e-4, 1e-10):
        exact = solved(solver, matrix, right, 1e-11)
        coarse = solved(solver, matrix, right, accuracy)
        counts[accuracy] = solver.iterations
        assert np.abs(coarse - exact)[: body.space.displacement_size].max() < 100 * accuracy * np.abs(exact).max()
    assert counts[1e-4] < 0.7 * counts[1e-10]


@pytest.mark.parametrize("contact", [False, True])
def test_iterations_hardly_grow_with_refinement(contact):
    counts = []
    for cells in ((4, 4, 2), (8, 8, 4)):
        body, matrix, right = system(cells, contact=contact)
        solver = BlockPreconditioned(body)
        solved(solver, matrix, right, 1e-6)
        counts.append(solver.iterations)
    assert counts[1] < 1.5 * counts[0] + 5
    assert counts[1] < 60


@pytest.mark.parametrize(
    ("cells", "giving_way"),
    [((5, 5, 3), 0.003), *(pytest.param((8, 8, 4), part, marks=pytest.mark.slow) for part in (0.003, 0.1))],
)
def test_a_round_edge_of_contact_costs_few_iterations_unless_it_is_relaxed(cells, giving_way, monkeypatch):
    body, matrix, right = system(cells, giving_way=giving_way)
    solver, direct = BlockPreconditioned(body), direct_solver()
    expected, computed = solved(direct, matrix, right), solved(solver, matrix, right, 1e-8)
    assert solver.iterations <= 60
    for exact, mine in zip(body.space.split(expected), body.space.split(computed), strict=True):
        # 1e-6 of the largest: the residual is 1e-8 of the right-hand side, the nodes that give way make it grow
        np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-6 * np.abs(exact).max())
    monkeypatch.setattr("tactsim.fem.solvers.block_preconditioner.MOST_CYCLES", 2)  # 160 steps
    solver._displacements._relaxed = np.arange(len(body.space.nodes))
    with pytest.raises(ConvergenceError):
        solver.solve(right, 1e-8)
    solver.close()
    direct.close()


def test_it_stops_where_a_solution_is_accepted():
    body, matrix, right = system((5, 5, 3))
    solver = BlockPreconditioned(body)
    step = solved(solver, matrix, right, 1e-2)
    assert solver.iterations <= 10
    assert np.abs(matrix @ step - right).max() < LOOSENESS * 1e-2 * np.abs(right).max()


def counted_factors(solver, monkeypatch):
    """A list that grows with every coarse factor of the solver."""
    made, factor = [], solver._displacements._direct.factor
    monkeypatch.setattr(solver._displacements._direct, "factor", lambda matrix: made.append(matrix.shape) or factor(matrix))
    return made


def test_a_coarse_factor_serves_until_contact_acts_otherwise(monkeypatch):
    body, pressed, right = system((5, 5, 3))
    free = system((5, 5, 3), contact=False)[1]
    solver = BlockPreconditioned(body)
    made, counts = counted_factors(solver, monkeypatch), []
    monkeypatch.setattr("tactsim.fem.solvers.two_level.SERVICE", 1000)
    slipping = system((5, 5, 3), giving_way=0.2)[1]
    for matrix in (pressed, 1.01 * pressed, pressed, slipping, free, free):
        computed = solved(solver, matrix, right, FINEST_STEP)
        assert np.abs(matrix @ computed - right).max() < LOOSENESS * FINEST_STEP * np.abs(right).max()
        counts.append((len(made), solver.iterations))
    assert [count for count, _ in counts] == [1, 1, 1, 2, 3, 3]
    assert counts[1][1] <= counts[0][1] + 2
    monkeypatch.setattr("tactsim.fem.solvers.two_level.SERVICE", 1)
    solved(solver, free, right, FINEST_STEP)
    assert len(made) == 4


def test_a_coarse_factor_that_no_longer_fits_is_made_anew_before_the_iteration_gives_up(monkeypatch):
    body, pressed, right = system((5, 5, 3))
    free = system((5, 5, 3), contact=False)[1]
    monkeypatch.setattr("tactsim.fem.solvers.two_level._Ruled.resembles", lambda self, other: True)
    monkeypatch.setattr("tactsim.fem.solvers.block_preconditioner.RESTART", 60)
    solver = BlockPreconditioned(body)
    made = counted_factors(solver, monkeypatch)
    solved(solver, free, right, 1e-8)
    monkeypatch.setattr("tactsim.fem.solvers.two_level.TwoLevel.renew", lambda self: None)
    with pytest.raises(ConvergenceError):
        solved(solver, pressed, right, 1e-8)
    monkeypatch.undo()
    assert len(made) == 1
    solved(solver, pressed, right, 1e-2)
    assert solver.iterations <= MOST_WITH_OLD + 1 + 10


def test_a_coarse_factor_that_failed_serves_no_later_system(monkeypatch):
    body, pressed, right = system((5, 5, 3))
    solver = BlockPreconditioned(body)

    def failing(matrix):
        raise ConvergenceError("too large for single precision")

    with monkeypatch.context() as patch:
        patch.setattr(solver._displacements._direct, "factor", failing)
        with pytest.raises(ConvergenceError):
            solved(solver, pressed, right, FINEST_STEP)
    made = counted_factors(solver, monkeypatch)
    solved(solver, pressed, right, FINEST_STEP)
    assert len(made) == 1


def test_a_factor_of_the_pressures_that_failed_serves_no_later_system(monkeypatch):
    body, pressed, right = system((3, 3, 2), bulk_modulus=1e6)
    solver = BlockPreconditioned(body)
    solved(solver, pressed, right, FINEST_STEP)

    def failing(matrix):
        solver._schur.close()
        raise ConvergenceError("a zero pivot")

    with monkeypatch.context() as patch:
        patch.setattr(solver._schur, "factor", failing)
        with pytest.raises(ConvergenceError, match="a zero pivot"):
            solved(solver, 2 * pressed, right, FINEST_STEP)
    solved(solver, pressed, right, FINEST_STEP)


class Recording(BlockPreconditioned):
    """Notes how accurate its solutions are to be."""

    def __init__(self, body):
        super().__init__(body)
        self.asked = []

    def solve(self, right, accuracy=0.0):
        self.asked.append(accuracy)
        return super().solve(right, accuracy)


def test_newton_asks_for_three_digits_of_a_step_and_reaches_its_tolerance_nevertheless():
    mesh = box(SIZE, (3, 3, 2))
    body = body_of(mesh, "solid", RUBBER)
    floor = np.concatenate([held(mesh, axis, on_plane(2, 0.0)) for axis in range(3)])
    lid = held(mesh, 2, on_plane(2, SIZE[2]))
    guess = np.zeros(body.space.size)
    guess[lid] = -5e-4
    found = {}
    for name, solver in {"iteration": Recording(body), "factor": direct_solver()}.items():
        found[name] = Problem(body, np.concatenate([floor, lid]), solver=solver).solve(guess)
        assert found[name].history[-1] < 1e-10
        if name == "iteration":
            assert min(solver.asked) == FINEST_STEP
    largest = np.abs(found["factor"].unknowns).max()
    np.testing.assert_allclose(found["iteration"].unknowns, found["factor"].unknowns, rtol=0, atol=1e-8 * largest)


def test_a_body_that_nothing_holds_is_an_error(monkeypatch):
    monkeypatch.setattr("tactsim.fem.solvers.block_preconditioner.MOST_CYCLES", 2)  # further ones are as vain
    body, matrix, right = system((3, 3, 2), contact=False, hold=False)
    with pytest.raises(ConvergenceError):
        solved(BlockPreconditioned(body), matrix, right, 1e-8)


def test_numbers_that_are_not_finite_are_an_error():
    body, matrix, right = system((2, 2, 2))
    with pytest.raises(ConvergenceError, match="not finite"):
        solved(BlockPreconditioned(body), matrix * np.nan, right)


def test_it_must_have_a_matrix_first():
    body, _, right = system((2, 2, 2))
    with pytest.raises(InputError):
        BlockPreconditioned(body).solve(right)


def test_linear_functions_are_interpolated_exactly():
    body, _, _ = system((2, 2, 2))
    nodes = body.space.nodes
    np.testing.assert_allclose(linear_interpolation(body.space) @ nodes[: body.space.corner_count], nodes, atol=1e-15)


def test_a_factor_takes_over_where_the_iteration_fails(monkeypatch):
    monkeypatch.setattr("tactsim.fem.solvers.block_preconditioner.RESTART", 2)
    body, matrix, right = system((5, 5, 3), contact=False)
    solver = iterated(body)
    computed = solved(solver, matrix, right, 1e-8)
    assert isinstance(solver.current, ReusedFactor)
    assert np.linalg.norm(matrix @ computed - right) <= 2e-8 * np.linalg.norm(right)
    with pytest.raises(ConvergenceError, match="iterative solver left"):
        solved(BlockPreconditioned(body), matrix, right, 1e-8)


@pytest.mark.skipif(direct_solver().name != "pardiso", reason="only Pardiso tells the size of its factors")
def test_the_size_of_the_factor_decides(monkeypatch):
    small, _, _ = system((2, 2, 2))
    cube, slender = (body_of(box(SIZE, cells), "solid", RUBBER) for cells in ((6, 6, 6), (54, 2, 2)))
    assert cube.space.size < slender.space.size
    assert isinstance(solver_for(small).current, ReusedFactor)
    sizes = {}
    for name, body in {"cube": cube, "slender": slender}.items():
        guide = QuasiDefinitePardiso(giving_way(body))
        sizes[name] = analysed(guide, body)
        guide.close()
    assert sizes["slender"].operations < 0.5 * sizes["cube"].operations
    assert factor_seconds(sizes["slender"]) < factor_seconds(sizes["cube"])
    between = (factor_seconds(sizes["slender"]) + factor_seconds(sizes["cube"])) / 2
    monkeypatch.setattr("tactsim.fem.solvers.solver_choice.SMALLEST_ITERATED", 0)
    monkeypatch.setattr("tactsim.fem.solvers.solver_choice.iteration_seconds", lambda unknowns: between)
    assert isinstance(solver_for(slender).current, ReusedFactor)
    assert isinstance(solver_for(cube).current, BlockPreconditioned)
    monkeypatch.setattr("tactsim.fem.solvers.solver_choice.LARGEST_FACTOR", 10)
    assert isinstance(solver_for(slender), BlockPreconditioned)


def test_without_pardiso_small_bodies_get_a_factor_and_others_the_iteration(monkeypatch):
    monkeypatch.setattr("tactsim.fem.solvers.solver_choice.has_pardiso", lambda: False)
    body, matrix, right = system((4, 4, 3), contact=False)
    assert isinstance(solver_for(body), SuperLU)
    monkeypatch.setattr("tactsim.fem.solvers.solver_choice.LARGEST_SUPERLU", 10)
    monkeypatch.setattr("tactsim.fem.solvers.block_preconditioner.RESTART", 2)
    solver = solver_for(body)
    assert isinstance(solver.current, BlockPreconditioned)
    computed = solved(solver, matrix, right, 1e-8)
    assert solver.name == "superlu, reused"
    assert np.linalg.norm(matrix @ computed - right) <= 2e-8 * np.linalg.norm(right)


@pytest.mark.skipif(direct_solver().name != "pardiso", reason="only Pardiso has two phases")
def test_what_was_analysed_is_factored():
    body, matrix, right = system((3, 3, 2), contact=False)
    factor = QuasiDefinitePardiso(giving_way(body))
    size = analysed(factor, body)
    assert matrix.nnz / 2 < size.entries < matrix.shape[0] ** 2 / 2
    assert size.operations > size.entries
    computed, expected = (solved(factored(one), matrix, right, 1e-10) for one in (factor, QuasiDefinitePardiso(giving_way(body))))
    np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.skipif(direct_solver().name != "pardiso", reason="only Pardiso tells the size of a factor")
def test_a_factor_that_costs_more_solutions_serves_more_systems():
    """Block and ball of 121 811 unknowns, `benchmarks/peers.py`: the factor takes 3.4 s, a solution with it 47 ms."""
    body, matrix, right = system((3, 3, 2), contact=False)
    large = FactorSize(entries=1.3e8, operations=3.1e11)
    assert solutions_per_factor(large) == pytest.approx(3.4 / 0.047, rel=0.15)
    disorder = np.random.default_rng(1).uniform(-0.005, 0.005, matrix.nnz)
    changed = [csr_matrix((matrix.data * (1 + number * disorder), matrix.indices, matrix.indptr)) for number in range(10)]
    made = {}
    for size in (None, FactorSize(entries=9e6, operations=1e9), large):  # unknown, of few operations, of many
        solver = factored(QuasiDefinitePardiso(giving_way(body)), size)
        for one in changed:
            solved(solver, one, right, 1e-4)
        made[size] = solver.current.factorisations
        assert solver.current.solutions > WORTH_A_FACTOR
        solver.close()
    assert list(made.values()) == [2, 2, 1]
