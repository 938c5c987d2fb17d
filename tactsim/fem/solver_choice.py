"""Which linear solver a body in space gets: a factor that is reused, and an iteration where no factor fits."""

from __future__ import annotations

from tactsim.fem.block_preconditioner import BlockPreconditioned
from tactsim.fem.body import Body
from tactsim.fem.linear import LinearSolver, direct_solver
from tactsim.fem.pardiso import SinglePardiso
from tactsim.fem.reused_factor import ReusedFactor

LARGEST_FACTOR = 600_000
"""Unknowns up to which a body is factored.

For one system the iteration is as fast from 110 000 unknowns on (28 s each) and 3.5 times faster at 295 000 (33 s and 2.4 GiB
against 114 s and 5.1 GiB), but it may need hundreds of steps and fail (``benchmarks/solvers.py``); a grasp solves some
thirteen systems with four factors. Memory is the bound: it grows like the unknowns to the power 1.2, to 12 GiB at this size. All
this was measured with factors in double precision; those in single precision take half."""


def solver_for(body: Body, *, largest_factor: int = LARGEST_FACTOR) -> LinearSolver:
    """A factor of the symmetric part that preconditions what follows, or the iteration above ``largest_factor`` unknowns."""
    if body.space.size > largest_factor:
        return BlockPreconditioned(body)
    solver = direct_solver()
    return ReusedFactor(direct_solver(SinglePardiso.name)) if solver.name == "pardiso" else solver
