"""Direct solvers agree, and a singular matrix is an error with a diagnosis, never a bad vector."""

from __future__ import annotations

import gc

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from solids import assert_close, body_of, box, held, on_plane

from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.solvers import pardiso
from tactsim.fem.solvers.linear import EXACT, LinearSystem, direct_solver, solved
from tactsim.fem.solvers.pardiso import QuasiDefinitePardiso, SinglePardiso, SymmetricPardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import MOST_OF_ONE, ReusedFactor
from tactsim.fem.solvers.solver_choice import giving_way, stiff_contact_solver
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
SOLVERS = ["pardiso", "superlu"]
ALL = [*SOLVERS, "pardiso_symmetric", "pardiso_single"]


def tangent_of(dim: int, *, axes: int, bulk_modulus: float | None = None) -> tuple[csr_matrix, np.ndarray]:
    """Tangent at rest of a unit box whose face at the origin is held along the first ``axes`` axes, and free random forces."""
    return held_tangent(*unit_box(dim, bulk_modulus), axes)


def unit_box(dim: int, bulk_modulus: float | None = None):
    """Mesh and body."""
    mesh = box([1.0] * dim, [3] * dim, jitter=0.2)
    material = MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=bulk_modulus)
    return mesh, body_of(mesh, "plane_strain" if dim == 2 else "solid", material)


def held_tangent(mesh, body, axes: int) -> tuple[csr_matrix, np.ndarray]:
    """Tangent at rest of a body held along axes, and forces."""
    fixed = np.array([held(mesh, axis, on_plane(0, 0.0)) for axis in range(axes)], int).ravel()
    constraints = Constraints(fixed, body.pattern)
    right = np.zeros(body.space.size)
    right[: body.space.displacement_size] = np.random.default_rng(5).normal(size=body.space.displacement_size)
    return body.pattern.matrix(constraints.apply(body.tangent(np.zeros(body.space.size)))), constraints.free(right)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("bulk_modulus", [None, 1e6])
def test_pardiso_and_superlu_agree(dim, bulk_modulus):
    matrix, right = tangent_of(dim, axes=dim, bulk_modulus=bulk_modulus)
    pardiso, superlu = (solved(direct_solver(name), matrix, right) for name in SOLVERS)
    assert_close(pardiso, superlu, 1e-9)  # condition number times round-off


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize(("dim", "axes"), [(2, 0), (2, 1), (3, 0), (3, 1)])
def test_a_body_that_is_not_held_is_an_error_with_a_diagnosis(name, dim, axes):
    matrix, right = tangent_of(dim, axes=axes)
    with pytest.raises(ConvergenceError, match="is the body held"):
        solved(direct_solver(name), matrix, right)


@pytest.mark.parametrize("name", SOLVERS)
def test_numbers_that_are_not_finite_are_an_error(name):
    matrix, right = tangent_of(2, axes=2)
    right[0] = np.nan
    with pytest.raises(ConvergenceError, match="singular"):
        solved(direct_solver(name), matrix, right)


@pytest.mark.parametrize("name", SOLVERS)
def test_the_same_solver_factors_again_with_other_numbers(name):
    solver = direct_solver(name)
    matrix, right = tangent_of(2, axes=2)
    first = solved(solver, matrix, right)
    assert_close(solved(solver, 2 * matrix, right), first / 2, 1e-9)
    assert_close(solver.solve(2 * right), first, 1e-9)


@pytest.mark.parametrize("name", SOLVERS)
def test_solving_before_factoring_or_after_closing_is_refused(name):
    solver = direct_solver(name)
    with pytest.raises(InputError, match="factor a matrix"):
        solver.solve(np.ones(3))
    matrix, right = tangent_of(2, axes=2)
    solved(solver, matrix, right)
    solver.close()
    with pytest.raises(InputError, match="factor a matrix"):
        solver.solve(right)


def test_a_closed_solver_takes_a_matrix_of_another_pattern():
    solver = direct_solver("pardiso")
    for dim in (2, 3):
        matrix, right = tangent_of(dim, axes=dim)
        assert_close(solved(solver, matrix, right), solved(direct_solver("superlu"), matrix, right), 1e-9)
        solver.close()


def test_pardiso_releases_its_memory_when_it_is_forgotten(monkeypatch):
    phases = []
    call = pardiso.call_pardiso

    def noted(solver, phase, system, right, written=None):
        phases.append(phase)
        return call(solver, phase, system, right, written)

    monkeypatch.setattr(pardiso, "call_pardiso", noted)
    solver = direct_solver("pardiso")
    solved(solver, *tangent_of(2, axes=2))
    assert phases == [12, 33]
    del solver
    gc.collect()
    assert phases == [12, 33, -1]


def test_an_unknown_solver_is_refused_by_name():
    with pytest.raises(InputError, match=r"'mumps'.*pardiso, superlu"):
        direct_solver("mumps")


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("bulk_modulus", [None, 1e6])
def test_the_symmetric_solver_is_as_exact(dim, bulk_modulus):
    matrix, right = tangent_of(dim, axes=dim, bulk_modulus=bulk_modulus)
    symmetric, general = (solved(direct_solver(name), matrix, right) for name in ("pardiso_symmetric", "pardiso"))
    assert_close(symmetric, general, 1e-9)


def test_a_single_precision_factor_is_nearly_as_exact():
    matrix, right = tangent_of(3, axes=3)
    single, double = (solved(direct_solver(name), matrix, right) for name in ("pardiso_single", "pardiso_symmetric"))
    assert_close(single, double, 1e-3)
    with pytest.raises(AssertionError):
        assert_close(single, double, 1e-9)  # it is not the double one


@pytest.mark.parametrize("worst", [np.nan, np.inf, 1e39])
def test_what_single_precision_cannot_hold_is_refused(worst):
    matrix, _ = tangent_of(2, axes=2)
    matrix.data[0] = worst
    with pytest.raises(ConvergenceError, match="not finite, or too large"):
        direct_solver("pardiso_single").factor(matrix)


def test_the_size_of_the_right_hand_side_does_not_matter_in_single_precision():
    matrix, right = tangent_of(2, axes=2)
    solver = direct_solver("pardiso_single")
    solver.factor(matrix)
    assert_close(1e60 * solver.solve(1e-60 * right), solver.solve(right), 1e-5)
    assert not solver.solve(0 * right).any()


def guided_by_what_gives_way(bulk_modulus=None, factor=1.0):
    """The solution for a unit box to 1e-8 guided by a quasi-definite factor, its matrix and right side, and the solver."""
    mesh, body = unit_box(3, bulk_modulus)
    matrix, right = held_tangent(mesh, body, 3)
    solver = ReusedFactor(QuasiDefinitePardiso(factor * giving_way(body)))
    return solved(solver, matrix, right, 1e-8), matrix, right, solver


@pytest.mark.parametrize("bulk_modulus", [None, 1e6])
def test_a_factor_of_tissue_that_gives_way_a_little_guides_to_what_does_not(bulk_modulus):
    computed, matrix, right, solver = guided_by_what_gives_way(bulk_modulus)
    assert np.linalg.norm(matrix @ computed - right) <= 2e-8 * np.linalg.norm(right)
    assert_close(computed, solved(direct_solver("pardiso"), matrix, right), 1e-4)  # accuracy times condition number
    exact = ReusedFactor(direct_solver("pardiso_single"))
    solved(exact, matrix, right, 1e-8)
    assert solver.solutions <= exact.solutions + 4
    # mutant: what gives way a thousand times as much guides badly
    *_, loose = guided_by_what_gives_way(bulk_modulus, factor=1e3)
    assert loose.solutions > exact.solutions + 4


class Misguiding(SinglePardiso):
    """A factor that leaves out half of every solution's entries, as one with wrong pivots may."""

    def solve(self, right):
        return np.where(np.arange(len(right)) % 2, super().solve(right), 0.0)


def test_where_a_guide_fails_a_sturdier_one_takes_over_for_good():
    matrix, right = tangent_of(3, axes=3)
    sturdier = ReusedFactor(SinglePardiso())
    alone = ReusedFactor(Misguiding(), largest_left=1e-6)
    helped = Relay(ReusedFactor(Misguiding(), largest_left=1e-6), lambda: sturdier)
    with pytest.raises(ConvergenceError, match="left"):
        solved(alone, matrix, right, 1e-8)
    with pytest.raises(ConvergenceError, match="singular"):
        solved(ReusedFactor(Misguiding()), matrix, right, 1e-8)
    computed = solved(helped, matrix, right, 1e-8)
    assert np.linalg.norm(matrix @ computed - right) <= 2e-8 * np.linalg.norm(right)
    assert (helped.current, sturdier.factorisations) == (sturdier, 1)
    solved(helped, changed(matrix, 1e-3), right, 1e-8)
    assert (helped.current, sturdier.factorisations) == (sturdier, 1)
    last = Relay(ReusedFactor(Misguiding(), largest_left=1e-6))
    with pytest.raises(ConvergenceError, match="left"):
        solved(last, matrix, right, 1e-8)
    with pytest.raises(InputError):
        Relay(sturdier).solve(right)


class Unfactored(ReusedFactor):
    """A solver whose factor fails."""

    def factor(self, system):
        raise ConvergenceError("a pivot is zero")


def test_a_sturdier_solver_takes_over_where_a_factor_fails():
    matrix, right = tangent_of(2, axes=2)
    system, sturdiest = LinearSystem(matrix), ReusedFactor(SinglePardiso())
    helped = Relay(Unfactored(SinglePardiso()), lambda: Unfactored(SinglePardiso()), lambda: sturdiest)
    assert np.linalg.norm(matrix @ solved(helped, system, right, 1e-8) - right) <= 2e-8 * np.linalg.norm(right)
    assert helped.current is sturdiest
    with pytest.raises(ConvergenceError, match="a pivot is zero"):
        Relay(Unfactored(SinglePardiso()), lambda: Unfactored(SinglePardiso())).factor(system)


def changed(matrix, amount, *, skew=0.0):
    """The matrix with its entries changed at random, symmetrically and not, in the same pattern."""
    noise = np.random.default_rng(4).normal(size=matrix.shape[0])
    rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    factors = 1 + amount * noise[rows] * noise[matrix.indices] + skew * (noise[rows] - noise[matrix.indices])
    return csr_matrix((matrix.data * factors, matrix.indices, matrix.indptr), shape=matrix.shape)


@pytest.mark.parametrize("kind", ["pardiso_symmetric", "pardiso_single"])
@pytest.mark.parametrize("skew", [0.0, 2e-3])
def test_an_old_factor_solves_what_changed_little_to_the_accuracy(kind, skew):
    matrix, right = tangent_of(3, axes=3)
    solver = ReusedFactor(direct_solver(kind))
    for amount in (0.0, 1e-3, 3e-3):
        now = changed(matrix, amount, skew=skew if amount else 0.0)
        computed = solved(solver, now, right, 1e-8)
        assert np.linalg.norm(now @ computed - right) <= 2e-8 * np.linalg.norm(right)
        assert_close(computed, solved(direct_solver("pardiso"), now, right), 1e-4)  # accuracy times condition number
    assert solver.factorisations == 1
    assert solver.solutions > 3


def test_an_iteration_refuses_forces_that_are_not_finite():
    matrix, right = tangent_of(2, axes=2)
    right[0] = np.nan
    with pytest.raises(ConvergenceError, match="not finite"):
        solved(ReusedFactor(direct_solver("pardiso_single")), matrix, right)


def test_a_factor_is_made_again_once_what_it_did_has_cost_as_much():
    matrix, right = tangent_of(3, axes=3)
    solver, factorisations = ReusedFactor(direct_solver("pardiso_symmetric")), []
    for amount in (0.0, *[3e-3] * 20):
        solved(solver, changed(matrix, amount), right, 1e-8)
        factorisations.append(solver.factorisations)
    assert factorisations[:3] == [1, 1, 1]
    assert factorisations[-1] == 2


def test_a_factor_too_old_is_made_again_and_closing_forgets_it():
    matrix, right = tangent_of(3, axes=3)
    solver = ReusedFactor(direct_solver("pardiso_symmetric"))
    solved(solver, matrix, right, 1e-8)
    solved(solver, changed(matrix, 0.2), right, 1e-8)
    assert solver.factorisations == 2
    assert not solved(solver, matrix, 0 * right, 1e-8).any()
    solver.close()
    with pytest.raises(InputError, match="factor a matrix"):
        solver.solve(right)


def test_a_new_factor_that_fails_guides_no_later_system(monkeypatch):
    matrix, right = tangent_of(3, axes=3)
    direct = direct_solver("pardiso_symmetric")
    solver = ReusedFactor(direct, most=2)
    solved(solver, matrix, right, 1e-8)

    def failing(_matrix):
        direct.close()
        raise ConvergenceError("a zero pivot")

    with monkeypatch.context() as patched:
        patched.setattr(direct, "factor", failing)
        with pytest.raises(ConvergenceError, match="a zero pivot"):
            solved(solver, changed(matrix, 0.2), right, 1e-8)
    assert left_over(matrix, solved(solver, matrix, right, 1e-8), right) < 1e-7


def test_the_nearby_matrix_is_made_only_where_it_is_factored():
    matrix, right = tangent_of(3, axes=3)
    solver, made = ReusedFactor(direct_solver("pardiso_single")), []

    def nearby():
        made.append(solver.factorisations)
        return matrix

    for amount in (0.0, 1e-3, 2e-3):
        solved(solver, LinearSystem(changed(matrix, amount), nearby), right, 1e-6)
    assert made == [0]


def test_an_iteration_that_an_old_factor_does_not_finish_goes_on_with_the_new_one():
    matrix, right = tangent_of(3, axes=3)
    now = changed(matrix, 0.2, skew=0.05)
    solver, fresh = (ReusedFactor(direct_solver("pardiso_single")) for _ in range(2))
    solved(solver, matrix, right, 1e-8)
    before = solver.solutions
    solved(solver, now, right, 1e-8)
    solved(fresh, now, right, 1e-8)
    assert solver.factorisations == 2
    assert solver.solutions - before - MOST_OF_ONE < fresh.solutions


def left_over(matrix: csr_matrix, solution: np.ndarray, right: np.ndarray) -> float:
    """Residual over the right-hand side."""
    return float(np.abs(matrix @ solution - right).max() / np.abs(right).max())


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("bulk_modulus", [None, 1e6])
def test_a_symmetric_matrix_gets_the_symmetric_factor_and_as_exact_a_solution(dim, bulk_modulus):
    matrix, right = tangent_of(dim, axes=dim, bulk_modulus=bulk_modulus)
    solver = stiff_contact_solver(dim)
    for scale in (1.0, 2.0):
        solver.factor(LinearSystem(scale * matrix))
        assert left_over(scale * matrix, solver.solve(right), right) < 1e-12  # round-off times the growth of pivots
        assert solver.name == "pardiso_symmetric"
        assert solver.exact


@pytest.mark.parametrize("first", ["symmetric", "not symmetric"])
@pytest.mark.parametrize(("dim", "name", "exact"), [(2, "pardiso_condensed", True), (3, "pardiso_single, reused", False)])
def test_a_matrix_that_is_not_symmetric_gets_another_solver_from_then_on(first, dim, name, exact):
    matrix, right = tangent_of(dim, axes=dim)
    skew = matrix.copy()
    rows = np.repeat(np.arange(skew.shape[0]), np.diff(skew.indptr))
    skew.data[np.argmax(np.where(rows != skew.indices, np.abs(skew.data), 0.0))] *= 1 + 1e-6
    solver = stiff_contact_solver(dim)
    if first == "symmetric":
        solver.factor(LinearSystem(matrix))
        solver.solve(right)
    for each in (skew, matrix):
        solver.factor(LinearSystem(each))
        assert left_over(each, solver.solve(right), right) < 1e-11
        assert (solver.name, solver.exact) == (name, exact)
    symmetric = direct_solver(SymmetricPardiso.name)
    symmetric.factor(skew)  # the mutant: it halves the difference
    assert left_over(skew, symmetric.solve(right), right) > 1e-11


@pytest.mark.parametrize(("dim", "name"), [(2, "pardiso"), (3, "pardiso_single, reused")])
def test_a_symmetric_factor_that_is_not_exact_gives_way(dim, name, monkeypatch):
    matrix, right = tangent_of(dim, axes=dim)
    exact = SymmetricPardiso.solve
    monkeypatch.setattr(SymmetricPardiso, "solve", lambda self, right: exact(self, right) * (1 + 10 * EXACT))
    solver = stiff_contact_solver(dim)
    solver.factor(LinearSystem(matrix))
    assert left_over(matrix, solver.solve(right), right) < 1e-11
    assert solver.name == name


def test_a_body_in_space_whose_guide_fails_gets_general_factors(monkeypatch):
    matrix, right = tangent_of(3, axes=3)
    monkeypatch.setattr(SinglePardiso, "solve", lambda self, right: np.zeros_like(right))
    solver = stiff_contact_solver(3)
    solver.factor(LinearSystem(changed(matrix, 0.0, skew=0.05)))
    assert left_over(changed(matrix, 0.0, skew=0.05), solver.solve(right), right) < 1e-11
    assert solver.name == "pardiso, reused"


def test_it_is_closed_and_takes_another_pattern_and_refuses_to_solve_before():
    solver = stiff_contact_solver(2)
    for dim in (2, 3):
        with pytest.raises(InputError, match="factor a matrix"):
            solver.solve(np.ones(3))
        matrix, right = tangent_of(dim, axes=dim)
        solver.factor(LinearSystem(matrix))
        assert left_over(matrix, solver.solve(right), right) < 1e-12
        solver.close()
