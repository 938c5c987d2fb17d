"""The symmetric factor without the unknowns that friction makes unsymmetric solves as exactly as a general one."""

from __future__ import annotations

import numpy as np
import pytest
from solids import assert_close, body_of, box, held, on_plane

from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.solvers.condensed import CondensedFactors, CondensedPardiso
from tactsim.fem.solvers.linear import EXACT, LinearSystem, direct_solver, solved
from tactsim.fem.solvers.pardiso_binding import ORDER
from tactsim.fem.solvers.stiff_contact import section_factors
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
CELLS = (60, 4)
FRICTION = 40.0
"""Largest entry that friction makes, as large as those of the tissue."""


class Section:
    """A section held at its base, the unknowns of its top by their place along it, and a right-hand side."""

    def __init__(self, bulk_modulus: float | None = None):
        mesh = box([15.0, 1.0], list(CELLS), jitter=0.2)
        body = body_of(mesh, "plane_strain", MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=bulk_modulus))
        fixed = np.array([held(mesh, axis, on_plane(1, 0.0)) for axis in (0, 1)], int).ravel()
        constraints = Constraints(fixed, body.pattern)
        self._pattern = body.pattern
        self._data = constraints.apply(body.tangent(np.zeros(body.space.size)))
        right = np.random.default_rng(5).normal(size=body.space.size)
        right[body.space.displacement_size :] = 0.0
        self.right = constraints.free(right)
        top = np.flatnonzero(np.isclose(mesh.nodes[:, 1], 1.0))
        order = top[np.argsort(mesh.nodes[top, 0])]
        self.top = (2 * order[:, None] + np.arange(2)).ravel()

    def system(self, first: int, last: int) -> LinearSystem:
        """With friction at nodes ``first`` to ``last`` of the top: traction along it grows with the displacement across it."""
        across = self.top[1::2][first:last]
        data = self._data.copy()
        data[self._pattern.positions(across - 1, across)] += FRICTION
        return LinearSystem(self._pattern.matrix(data), make_surface=lambda: np.sort(self.top))


def left_over(system: LinearSystem, solution: np.ndarray, right: np.ndarray) -> float:
    """Residual over the right-hand side."""
    return float(np.abs(system.matrix @ solution - right).max() / np.abs(right).max())


@pytest.mark.parametrize("bulk_modulus", [None, 1e6])
def test_it_solves_as_exactly_as_a_general_factor(bulk_modulus):
    section, solver = Section(bulk_modulus), CondensedFactors()
    for first, last in ((30, 40), (30, 42), (2, 4), (5, 5)):  # it grows, moves away, and ends
        system = section.system(first, last)
        solution = solved(solver, system, section.right)
        assert left_over(system, solution, section.right) < 1e-13
        assert_close(solution, solved(direct_solver("pardiso"), system, section.right), 1e-10)


def test_a_contact_that_grows_within_the_margin_costs_no_new_choice(monkeypatch):
    made = []
    new = CondensedPardiso.__init__
    monkeypatch.setattr(CondensedPardiso, "__init__", lambda self, *given: (made.append(given), new(self, *given))[1])
    section, solver = Section(), CondensedFactors()
    for last, choices in ((31, 1), (35, 1), (40, 1), (45, 2)):  # six facets are twelve nodes
        solved(solver, section.system(30, last), section.right)
        assert len(made) == choices


def test_without_the_difference_the_solution_is_wrong():
    section = Section()
    system = section.system(30, 40)
    symmetric = direct_solver("pardiso_symmetric")  # the mutant: it halves the difference
    symmetric.factor(system.matrix)
    assert left_over(system, symmetric.solve(section.right), section.right) > 0.01


@pytest.mark.parametrize(("first", "last", "name"), [(0, 121, "pardiso"), (0, 10, "pardiso_condensed")])
def test_friction_on_many_unknowns_gets_general_factors(first, last, name):
    section, solver = Section(), section_factors()
    system = section.system(first, last)
    assert left_over(system, solved(solver, system, section.right), section.right) < 1e-12
    assert solver.name == name


def test_a_condensed_factor_that_is_not_exact_gives_way(monkeypatch):
    exact = CondensedPardiso.solve
    monkeypatch.setattr(CondensedPardiso, "solve", lambda self, right: exact(self, right) * (1 + 10 * EXACT))
    section, solver = Section(), section_factors()
    system = section.system(30, 40)
    assert left_over(system, solved(solver, system, section.right), section.right) < 1e-12
    assert solver.name == "pardiso"


def test_the_order_has_no_separators():
    """MKL's analysis reads beyond a table if it has, where memory may end: of 16 140 unknowns, 46 left out, at 32 235."""
    section, solver = Section(), CondensedFactors()
    solved(solver, section.system(30, 40), section.right)
    assert solver._direct._solver.iparm[ORDER] == 0


def test_without_friction_it_refuses_and_before_a_factor_too():
    section, solver = Section(), CondensedFactors()
    with pytest.raises(InputError, match="factor a matrix"):
        solver.solve(section.right)
    solver.factor(section.system(5, 5))
    with pytest.raises(ConvergenceError, match="friction acts on no unknown"):
        solver.solve(section.right)
    solver.close()
    with pytest.raises(InputError, match="factor a matrix"):
        solver.solve(section.right)
