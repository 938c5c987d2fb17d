"""Newton's method ends in an equilibrium or in an error that says why."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from solids import body_of, box, facets_where, held, on_plane

from tactsim.deadline import time_limit
from tactsim.errors import ConvergenceError, OutOfTime
from tactsim.experiments.boundary_value.posing import EXACT_STEPS
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.dead_load import DeadLoad
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium import newton
from tactsim.fem.equilibrium.balance import ExternalForces
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.equilibrium.newton_step import NewtonStep
from tactsim.fem.solvers.linear import IterativeSolver, direct_solver
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
MATERIALS = {
    "incompressible": MooneyRivlin2(c10=80.0, c01=20.0),
    "compressible": MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=1e3),
    "linear": LinearElastic(youngs_modulus=600.0, poisson_ratio=0.3),
}


def block(dim, material, *, held_axes):
    """A unit block whose bottom is held along the given axes, and the pull of 20 Pa on its top as nodal forces in N."""
    mesh = box([1.0] * dim, [2] * dim, jitter=0.1)
    body = body_of(mesh, "plane_strain" if dim == 2 else "solid", material)
    fixed = np.concatenate([np.zeros(0, int), *[held(mesh, axis, on_plane(dim - 1, 0.0)) for axis in held_axes]])
    points = body.space.surface_points(facets_where(mesh, on_plane(dim - 1, 1.0)))
    traction = np.zeros((dim, len(points.weights)))
    traction[-1] = 20.0
    return body, fixed, SurfaceAssembly(points, body.pattern, dim).force(traction)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("name", MATERIALS)
def test_newton_ends_below_its_tolerance_and_says_how_it_got_there(dim, name):
    body, fixed, force = block(dim, MATERIALS[name], held_axes=range(dim))
    solved = Problem(body, fixed).solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    assert solved.history[-1] < NewtonOptions().tolerance < solved.history[0]
    assert solved.iterations == len(solved.history) - 1 <= (1 if name == "linear" else 6)
    assert (solved.unknowns[fixed] == 0.0).all()
    assert body.space.split(solved.unknowns)[0][:, -1].max() > 0.01


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("solver", ["pardiso", "superlu"])
def test_a_body_without_a_boundary_condition_is_an_error_with_a_diagnosis(dim, name, solver):
    body, fixed, force = block(dim, MATERIALS[name], held_axes=())
    with pytest.raises(ConvergenceError, match="is the body held"):
        Problem(body, fixed, solver=direct_solver(solver)).solve(np.zeros(body.space.size), loads=[DeadLoad(force)])


@pytest.mark.parametrize(
    ("residual", "unbalanced", "forces"),
    [
        (0.05, 0.05, "at the guess"),
        (0.05, 0.5, "of the last state"),
        (0.5, 0.05, "of the last state"),
        (0.05, 0.0, "at the guess"),
    ],
)
def test_newton_begins_with_the_forces_at_a_guess_only_where_little_beside_them_is_unbalanced(residual, unbalanced, forces):
    """Largest force of the body and force of the contact are 1 N each. A contact that presses with nothing, of a body that goes
    back, is never little beside itself: `tests/unit/mechanics/test_retreat.py` shows what it would come to."""
    interface = SimpleNamespace(start=lambda: "of the last state", iterate_at=lambda displacement: "at the guess")

    def begun(contact_force):
        state = SimpleNamespace(residual=residual, unbalanced=unbalanced, contact_force=contact_force, displacements=[None])
        body = SimpleNamespace(kinematics=lambda _: SimpleNamespace(J=np.ones(1)), oriented_volume_ratio=lambda after: after.J)
        balance = SimpleNamespace(body=body, forces=ExternalForces(interfaces=[interface]), at=lambda *_: state)
        solution = newton._Solution(balance, direct_solver(), NewtonOptions(), 1e-10, None)
        solution._start(np.zeros(1), 0.0)
        return solution._iterates

    assert begun(1.0) == [forces]
    assert begun(0.0) == ["of the last state"]


@pytest.mark.parametrize("dim", [2, 3])
def test_too_few_iterations_raise_with_the_history(dim):
    body, fixed, force = block(dim, MATERIALS["incompressible"], held_axes=range(dim))
    problem = Problem(body, fixed, options=NewtonOptions(max_iterations=2, polished=0.0))
    with pytest.raises(ConvergenceError, match="did not converge in 3 iterations") as caught:
        problem.solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    assert len(caught.value.history) == 3
    assert np.isfinite(caught.value.history).all()


@pytest.mark.parametrize("dim", [2, 3])
def test_a_load_far_too_large_for_one_step_raises_and_leaves_the_guess_alone(dim):
    body, fixed, force = block(dim, MATERIALS["incompressible"], held_axes=range(dim))
    guess = np.zeros(body.space.size)
    with pytest.raises(ConvergenceError, match=r"Newton|element"):
        Problem(body, fixed).solve(guess, loads=[DeadLoad(-1e4 * force)])
    assert not guess.any()


@pytest.mark.parametrize("dim", [2, 3])
def test_a_guess_with_an_element_inside_out_is_refused(dim):
    body, fixed, force = block(dim, MATERIALS["compressible"], held_axes=range(dim))
    guess = np.zeros(body.space.size)
    body.space.split(guess)[0][-1] = 5.0
    with pytest.raises(ConvergenceError, match="inside out"):
        Problem(body, fixed).solve(guess, loads=[DeadLoad(force)])


def test_a_section_on_the_other_side_of_its_axis_is_inside_out_though_it_keeps_its_volume():
    body = body_of(box([1.0, 1.0], [2, 2]), "axisymmetric", MATERIALS["compressible"])
    guess = np.zeros(body.space.size)
    u, _ = body.space.split(guess)
    u[:, 0] = -2 * body.space.nodes[:, 0]
    assert body.kinematics(guess).J.min() > 0.99
    with pytest.raises(ConvergenceError, match=r"inside out.*passes the axis of revolution"):
        Problem(body, np.zeros(0, int)).solve(guess)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_forces_that_are_not_finite_raise(dim, bad):
    body, fixed, force = block(dim, MATERIALS["compressible"], held_axes=range(dim))
    force[-body.space.corner_count - 1] = bad
    with np.errstate(invalid="ignore"), pytest.raises(ConvergenceError):
        Problem(body, fixed).solve(np.zeros(body.space.size), loads=[DeadLoad(force)])


@pytest.mark.parametrize("dim", [2, 3])
def test_newton_converges_quadratically_under_a_follower_pressure(dim):
    body, fixed, _ = block(dim, MATERIALS["compressible"], held_axes=range(dim))
    mesh = box([1.0] * dim, [2] * dim, jitter=0.1)
    load = FollowerPressure(body.space, facets_where(mesh, on_plane(dim - 1, 1.0)), body.pattern, 30.0)
    problem = Problem(body, fixed, options=NewtonOptions(polished=0.0))  # every step with a new tangent
    history = problem.solve(np.zeros(body.space.size), loads=[load]).history
    assert len(history) <= 7
    contraction = [later / earlier**2 for earlier, later in itertools.pairwise(history) if 1e-6 < earlier < 1e-1]
    assert contraction
    assert max(contraction) < 100  # linear convergence would make it grow without bound


class Snaps:
    """Springs at a surface whose force in Pa is the arc tangent of how far beyond a place the points are, over a width in m."""

    def __init__(self, surface, *, strength=100.0, place=0.05, width=0.01):
        self.surface, self._strength, self._place, self._width = surface, strength, place, width

    def start(self):
        return None

    def iterate_at(self, displacement):
        return None

    def advanced(self, now, iterate, step, damping):
        return None

    def converged(self, displacement):
        traction = np.zeros_like(displacement)
        traction[-1] = -self._strength * np.arctan((displacement[-1] - self._place) / self._width)
        return traction

    def rounding(self, displacement):
        return np.zeros(displacement.shape[1])

    def linearised(self, displacement, iterate):
        derivative = np.zeros((len(displacement), *displacement.shape))
        derivative[-1, -1] = -self._strength / self._width / (1 + ((displacement[-1] - self._place) / self._width) ** 2)
        return SimpleNamespace(traction=self.converged(displacement), derivative=derivative, coupling=np.zeros_like(derivative))


def snapped(dim, halvings, start_patience=None):
    """Newton's solution under springs between whose branches it jumps to and fro, with so many halvings of a step at most."""
    body, fixed, _ = block(dim, MATERIALS["linear"], held_axes=range(dim))
    mesh = box([1.0] * dim, [2] * dim, jitter=0.1)
    points = body.space.surface_points(facets_where(mesh, on_plane(dim - 1, 1.0)))
    problem = Problem(body, fixed, options=NewtonOptions(search_halvings=halvings, start_patience=start_patience))
    return problem.solve(np.zeros(body.space.size), interfaces=[Snaps(SurfaceAssembly(points, body.pattern, dim))])


@pytest.mark.parametrize("dim", [2, 3])
def test_forces_that_jump_to_and_fro_are_caught_by_shorter_steps(dim):
    assert snapped(dim, NewtonOptions().search_halvings).history[-1] < NewtonOptions().tolerance


@pytest.mark.parametrize("dim", [2, 3])
def test_without_shorter_steps_they_jump_for_ever(dim):
    with pytest.raises(ConvergenceError, match="did not converge"):
        snapped(dim, 0)


@pytest.mark.parametrize("dim", [2, 3])
def test_newton_gives_up_a_start_that_brings_nothing_if_asked(dim):
    with pytest.raises(ConvergenceError) as patient:
        snapped(dim, 0)
    with pytest.raises(ConvergenceError) as hasty:
        snapped(dim, 0, start_patience=3)
    assert len(hasty.value.history) == 4 < len(patient.value.history)
    assert min(hasty.value.history) > 0.5 * hasty.value.history[0]


@pytest.mark.parametrize(
    ("volumes", "growth", "astray"),
    [((0.7, 1.05), 5.0, True), ((0.98, 1.5), 5.0, True), ((0.7, 1.05), 3.0, False), ((0.8, 1.3), 100.0, False)],
    ids=["crushed", "blown up", "forces hardly more", "contact that changes its state"],
)
def test_a_step_has_gone_astray_if_elements_and_forces_say_so(volumes, growth, astray):
    """What it is for, a sheet that is limp while flat, is blown up in `test_limit_load`, and is not without the halving."""

    def state(volumes, unbalanced):
        return SimpleNamespace(kinematics=SimpleNamespace(J=np.array([volumes])), unbalanced=unbalanced)

    assert newton._gone_astray(state((0.98, 1.05), 1.0), state(volumes, growth)) is astray


def test_solving_ends_with_an_error_once_its_time_has_passed_and_only_then():
    body, fixed, force = block(2, MATERIALS["incompressible"], held_axes=range(2))
    problem = Problem(body, fixed)
    with pytest.raises(OutOfTime, match=r"took longer than the 1e-09 s"), time_limit(1e-9):
        problem.solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    with pytest.raises(OutOfTime), time_limit(1e-9), time_limit(None):
        problem.solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    with time_limit(60.0):
        inside = problem.solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    after = problem.solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    np.testing.assert_array_equal(inside.unknowns, after.unknowns)


def test_the_last_factor_spares_tangents_and_ends_at_the_same_equilibrium():
    """Each iteration counted is a tangent and a factor; steps with the last factor come between them, down to the tolerance."""
    body, fixed, force = block(2, MATERIALS["incompressible"], held_axes=range(2))
    guess = np.zeros(body.space.size)
    exact = Problem(body, fixed, options=NewtonOptions(polished=0.0)).solve(guess, loads=[DeadLoad(force)])
    problem = Problem(body, fixed)
    spared = problem.solve(guess, loads=[DeadLoad(force)])
    assert spared.history[-1] < NewtonOptions().tolerance
    assert spared.iterations <= 2 < exact.iterations
    assert spared.unknowns == pytest.approx(exact.unknowns, abs=1e-8 * np.abs(exact.unknowns).max())
    again = problem.solve(spared.unknowns, loads=[DeadLoad(1.001 * force)])
    assert again.iterations == 0, "the factor of the solution before is good enough for a small change"


def test_a_linear_part_that_is_inside_out_lets_no_other_part_turn_so():
    """J says nothing of small strains; its least value of the others bounds a step."""
    mesh = box([1.0, 1.0], [2, 2])
    left = mesh.nodes[mesh.elements[:, :3], 0].mean(axis=1) < 0.5
    space = TaylorHood(mesh.nodes, mesh.elements, "plane_strain", left.astype(int))
    body = Body(space, [MATERIALS["compressible"], MATERIALS["linear"]], left.astype(int))
    guess, step = np.zeros(space.size), np.zeros(space.size)
    x = mesh.nodes[:, 0]
    space.split(guess)[0][:, 0] = np.where(x < 0.5, -2 * x, -1.0)  # turns the linear half over
    space.split(step)[0][:, 0] = np.where(x > 0.5, -1.05 * (x - 0.5), 0.0)
    before = body.kinematics(guess)
    assert before.J.min() < -0.9
    balance = Problem(body, np.zeros(0, int)).balance(ExternalForces())
    solution = newton._Solution(balance, direct_solver(), NewtonOptions(), 1e-10, None)
    damping, after = solution._damped(balance.at(guess, before, 0.0), NewtonStep(step, 0.0))
    assert damping == 0.5
    assert body.oriented_volume_ratio(after).min() > 0.2


def test_a_factor_that_failed_polishes_no_later_solution(monkeypatch):
    body, fixed, force = block(2, MATERIALS["compressible"], held_axes=range(2))
    problem, zero = Problem(body, fixed, solver=direct_solver("superlu")), np.zeros(body.space.size)
    solved = problem.solve(zero, loads=[DeadLoad(force)])

    def failing(matrix):
        problem.solver.close()
        raise ConvergenceError("a zero pivot")

    with monkeypatch.context() as patched:
        patched.setattr(problem.solver, "factor", failing)
        with pytest.raises(ConvergenceError, match="a zero pivot"):
            problem.solve(zero, loads=[DeadLoad(force)])
    assert problem.solve(solved.unknowns, loads=[DeadLoad(1.01 * force)]).history[-1] < NewtonOptions().tolerance


class AsWrongAsAllowed(IterativeSolver):
    """Solves exactly, then adds the error that Newton allows, all on one unknown's side; keeps what it was asked for."""

    name = "as wrong as allowed"

    def __init__(self):
        self._direct, self.asked = direct_solver("superlu"), []

    def factor(self, system):
        self._matrix = system.matrix
        self._direct.factor(system.matrix)

    def solve(self, right, accuracy=0.0):
        self.asked.append(accuracy)
        wrong = np.where(np.arange(len(right)) % 2, right, -right)
        wrong *= accuracy * np.linalg.norm(right) / max(np.linalg.norm(wrong), 1e-300)
        return self._direct.solve(right + wrong)

    def close(self):
        self._direct.close()


@pytest.mark.parametrize("goal", [4.5e-2, 1e-3, 1e-6])
def test_the_last_linear_step_is_as_exact_as_the_goal_needs_and_newton_ends_there(goal):
    body, fixed, force = block(2, MATERIALS["incompressible"], held_axes=range(2))
    solver = AsWrongAsAllowed()
    problem = Problem(body, fixed, solver=solver, options=NewtonOptions(tolerance=goal))
    solved = problem.solve(np.zeros(body.space.size), loads=[DeadLoad(force)])
    assert solved.history[-1] < goal
    for residual, asked in zip(solved.history, solver.asked, strict=False):
        assert asked * residual <= max(0.1 * goal, min(0.5 * residual**2, 0.01 * residual)) * (1 + 1e-12)
    last = solved.history[-2]
    assert solver.asked[-1] >= min(0.05, 0.1 * goal / last)


def test_steps_that_are_to_be_exact_are_so_at_the_end_too():
    asked = [EXACT_STEPS.inexactness(residual, 1e-3) for residual in (1.0, 1e-2, 2e-3)]
    assert asked == [1e-9] * 3
    assert NewtonOptions().inexactness(2e-3, 1e-3) == 0.05
