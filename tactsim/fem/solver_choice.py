"""Which linear solver a body in space gets: a factor that is reused, and an iteration where no factor fits."""

from __future__ import annotations

from tactsim.fem.block_preconditioner import BlockPreconditioned
from tactsim.fem.body import Body
from tactsim.fem.linear import DirectSolver, SymmetricPardiso, direct_solver
from tactsim.fem.reused_factor import ReusedFactor

LARGEST_FACTOR = 300_000
"""Unknowns up to which a body is factored; one factor of so many takes 6 GB (``benchmarks/solvers.py``)."""


def solver_for(body: Body, *, largest_factor: int = LARGEST_FACTOR) -> DirectSolver:
    """A factor of the symmetric part that preconditions what follows, or the iteration above ``largest_factor`` unknowns."""
    if body.space.size > largest_factor:
        return BlockPreconditioned(body)
    solver = direct_solver()
    return ReusedFactor(direct_solver(SymmetricPardiso.name)) if solver.name == "pardiso" else solver
