"""Newton's method of the programs that only assemble, on a column of springs with a closed form."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

PROGRAMS = Path(__file__).parents[3] / "benchmarks" / "peer_programs"
STIFFNESS, HARDENING = 2.0, 3e6
"""Force k s + h s^3 of a spring at the stretch s: N/m and N/m^3."""
HEIGHT = 0.02
ORDER = np.array([2, 0, 1])
"""Nodes of the problem, bottom to top, in the column's own order."""
LEVELS = np.array([-0.5e-3, -1e-3])
SLACK = 1e-8
"""The tolerance of the steps."""


class Column:
    """Three nodes on a line, alike springs between neighbours in every direction."""

    version = "1"

    def __init__(self, problem: dict[str, np.ndarray]) -> None:
        self.positions = np.empty((3, 3))
        self.positions[ORDER] = problem["nodes"]

    def forces(self, displacements):
        below, above = np.diff(displacements.reshape(3, 3)[ORDER], axis=0)
        first, second = (STIFFNESS * stretch + HARDENING * stretch**3 for stretch in (below, above))
        forces_ = np.empty((3, 3))
        forces_[ORDER] = [-first, first - second, second]
        return forces_.ravel()

    def correction(self, displacements, forces, held, moved):
        below, above = np.diff(displacements.reshape(3, 3)[ORDER], axis=0)
        first, second = (STIFFNESS + 3 * HARDENING * stretch**2 for stretch in (below, above))
        bottom, _, top = moved.reshape(3, 3)[ORDER]
        change = moved.reshape(3, 3).copy()
        change[ORDER[1]] = (first * bottom + second * top - forces.reshape(3, 3)[ORDER[1]]) / (first + second)
        return change.ravel()


@pytest.fixture
def clamped(monkeypatch) -> ModuleType:
    monkeypatch.syspath_prepend(PROGRAMS)
    return importlib.import_module("clamped_block")


@pytest.fixture
def problem() -> dict[str, np.ndarray]:
    nodes = np.array([[0.0, 0.0, z] for z in (0.0, HEIGHT / 2, HEIGHT)])
    sets = {"bottom": np.array([0]), "top": np.array([2])}
    return {"nodes": nodes, **sets, "levels": LEVELS, "tolerance": np.array(SLACK)}


def test_reaction_is_that_of_two_springs_in_a_row(clamped, problem):
    solution = clamped.solve(problem, Column)
    stretch = LEVELS[-1] / 2
    exact = STIFFNESS * stretch + HARDENING * stretch**3
    np.testing.assert_allclose(solution["forces"], [[0.0, 0.0, exact]], rtol=3 * SLACK)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(solution["forces"], [[0.0, 0.0, exact * (1 + 9 * SLACK)]], rtol=3 * SLACK)
    assert solution["unknowns"] == 9
    assert len(solution["step_seconds"]) == len(solution["iterations"]) == len(LEVELS)


def test_wrong_tangent_does_not_pass_for_a_solution(clamped, problem):
    class Blind(Column):
        def correction(self, displacements, forces, held, moved):
            return moved

    with pytest.raises(ValueError, match="after 25 iterations"):
        clamped.solve(problem, Blind)


def test_forces_that_are_not_numbers_stop_the_step(clamped, problem):
    class Broken(Column):
        def forces(self, displacements):
            return np.full(9, np.nan)

    with pytest.raises(ValueError, match="not finite after 1 "):
        clamped.solve(problem, Broken)


def test_numbering_finds_every_node_again(clamped):
    generator = np.random.default_rng(5)
    own = generator.permutation(np.stack(np.meshgrid(*[np.linspace(0, 0.04, 4)] * 3), axis=-1).reshape(-1, 3))
    order = generator.permutation(len(own))
    theirs = own[order] + 1e-14 * generator.standard_normal(own.shape)
    np.testing.assert_allclose(theirs[clamped.numbering(own, theirs)], own, atol=1e-12)


def test_other_nodes_are_refused(clamped, problem):
    nodes = problem["nodes"]
    for others in (nodes[:2], nodes + 1e-6):
        with pytest.raises(ValueError, match="are not the problem's 3"):
            clamped.numbering(nodes, others)
