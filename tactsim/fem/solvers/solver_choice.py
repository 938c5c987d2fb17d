"""Which linear solver a body in space gets: a factor that is reused, or an iteration where that costs less."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.solvers.block_preconditioner import BlockPreconditioned, pressure_mass
from tactsim.fem.solvers.linear import LinearSolver, direct_solver
from tactsim.fem.solvers.pardiso import QuasiDefinitePardiso, SinglePardiso
from tactsim.fem.solvers.reused_factor import ReusedFactor

REFERENCE = 1e5
"""Unknowns at which the constants below hold. They are processor seconds of grasps with friction, on one core beside other work,
of 28 506 and 82 832 unknowns (``benchmarks/scale.py``); only their ratios decide."""
FACTOR, FACTOR_GROWTH = 5.4, 1.8
"""Seconds of a factor in single precision, 0.58 and 3.9 as measured, and the power of the unknowns by which they grow; the
limit is 2 (George 1973, doi:10.1137/0710032, nested dissection; in space)."""
SOLUTION, SOLUTION_GROWTH = 0.09, 1.2
"""Those of a solution with it, 0.020 and 0.073; the limit is 4/3."""
FACTORS, SOLUTIONS = 0.3, 10.0
"""Factors and solutions per system."""
PREPARATION, STEP = 1.3, 0.16
"""Seconds of the preconditioner and of one step of the iteration; both grow with the unknowns."""
STEPS = 15.0
"""Steps per system: 11 at 28 506 unknowns, 14 at 82 832, 16 in the first ten systems at 321 114. Whole systems took 0.86 and
2.9 s by iteration there, 0.40 and 1.8 s by factor."""

GIVING_WAY = 1e-4
"""Compliance that the factor adds to that of the tissue, times the shear modulus. With 1e-3 solutions to 1e-8 take six steps
more, and the rounding of single precision, 6e-8, is 6e-4 of what 1e-4 leaves as a pivot at worst."""


def factor_seconds(unknowns: float) -> float:
    """Seconds per system of a body of this size by a factor that is reused, on one core."""
    size = unknowns / REFERENCE
    return FACTORS * FACTOR * size**FACTOR_GROWTH + SOLUTIONS * SOLUTION * size**SOLUTION_GROWTH


def iteration_seconds(unknowns: float) -> float:
    """Seconds per system of a body of this size by the iteration, on one core."""
    return (PREPARATION + STEPS * STEP) * unknowns / REFERENCE


def solver_for(body: Body, *, largest_factor: int | None = None) -> LinearSolver:
    """A factor of the symmetric part that preconditions what follows, or the iteration, whichever costs less.

    ``largest_factor`` unknowns, if given, decide instead: a larger body gets the iteration.
    """
    size = body.space.size
    iterates = iteration_seconds(size) < factor_seconds(size) if largest_factor is None else size > largest_factor
    if iterates:
        return BlockPreconditioned(body)
    solver = direct_solver()
    return ReusedFactor(QuasiDefinitePardiso(giving_way(body)), SinglePardiso) if solver.name == "pardiso" else solver


def giving_way(body: Body) -> Array:
    """What `QuasiDefinitePardiso` adds for the unknowns (size,) of a body: compliance times volume in m^3/Pa of each pressure."""
    moduli = np.array([material.shear_modulus for material in body.materials])[body.regions]
    volumes = np.asarray(pressure_mass(body, moduli).sum(axis=1)).ravel()
    return np.concatenate([np.zeros(body.space.displacement_size), GIVING_WAY * volumes])
