"""How much is solved for a grasp: counts of systems, factors and solutions, whatever the machine."""

from __future__ import annotations

import pytest

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.path import grasp_path
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import ReusedFactor

SYSTEMS, FACTORS, SOLUTIONS = 18, 4, 125
"""Most for the example, which closes in two steps. Without multipliers extrapolated from the first step, or with every system
factored, there are more; it takes 17, 4 and 115."""


def test_a_grasp_factors_rarely_and_solves_little(one_thread):
    grasp = Grasp.example()
    model = grasp_model(grasp, grasp_mesh(grasp))
    states = [state for state, _ in grasp_path(grasp, model).states()]
    if not isinstance(model.problem.solver, Relay):
        pytest.skip("without Pardiso every system is factored")
    solver = model.problem.solver.current
    assert isinstance(solver, ReusedFactor)
    assert sum(state.iterations for state in states) <= SYSTEMS
    assert solver.factorisations <= FACTORS
    assert solver.solutions <= SOLUTIONS
