"""Which linear solver a body in space gets: a factor that is reused, or an iteration where that costs less."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.solvers.block_preconditioner import BlockPreconditioned, pressure_mass
from tactsim.fem.solvers.linear import LinearSolver, direct_solver
from tactsim.fem.solvers.pardiso import Pardiso, QuasiDefinitePardiso, SinglePardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import ReusedFactor

REFERENCE = 1e5
"""Unknowns at which the constants below hold. They are processor seconds of grasps with friction, on one core beside other work,
of 28 506 and 82 832 unknowns (``benchmarks/scale.py``); only their ratios decide."""
FACTOR, FACTOR_GROWTH = 5.9, 1.8
"""Seconds of a factor in single precision, 0.58 and 4.2 as measured, and the power of the unknowns by which they grow; the
limit is 2 (George 1973, doi:10.1137/0710032, nested dissection; in space)."""
SOLUTION, SOLUTION_GROWTH = 0.09, 1.2
"""Those of a solution with it, 0.020 and 0.073; the limit is 4/3."""
FACTORS, SOLUTIONS = 0.23, 7.0
"""Factors and solutions per system."""
PREPARATION, STEP = 0.75, 0.075
"""Seconds of the preconditioner and of one step of the iteration; both grow with the unknowns."""
STEPS = 8.0
"""Steps per system: 7 at 28 506 unknowns, 8 at 82 832. Whole systems took 0.35 and 1.05 s by iteration there, 0.36 and 1.60 s
by factor. The constants meet at 52 000, not where those do, for the factor alone gains from a second thread."""
LARGEST_FACTOR = 400_000
"""Unknowns up to which a factor takes over where the iteration fails; it takes some 10 GB there."""

FAILED = 1e-6
"""Residual over the right-hand side above which a guide has failed; round-off ends other iterations near 1e-12."""
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
    """A factor that is reused, or the iteration, whichever costs less; the iteration is relieved by the factor where it fails.

    ``largest_factor`` unknowns, if given, decide instead: a larger body gets the iteration.
    """
    if direct_solver().name != Pardiso.name:
        return direct_solver()
    size = body.space.size
    iterates = iteration_seconds(size) < factor_seconds(size) if largest_factor is None else size > largest_factor
    if not iterates:
        return Relay(_guided_factor(body), _matched_factor)
    factors = (lambda: _guided_factor(body), _matched_factor) if size <= LARGEST_FACTOR else ()
    return Relay(BlockPreconditioned(body), *factors)


def _guided_factor(body: Body) -> ReusedFactor:
    """Of what gives way a little: the fastest, whose pivots need not suffice."""
    return ReusedFactor(QuasiDefinitePardiso(giving_way(body)), largest_left=FAILED)


def _matched_factor() -> ReusedFactor:
    return ReusedFactor(SinglePardiso())


def giving_way(body: Body) -> Array:
    """What `QuasiDefinitePardiso` adds for the unknowns (size,) of a body: compliance times volume in m^3/Pa of each pressure."""
    moduli = np.array([material.shear_modulus for material in body.materials])[body.regions]
    volumes = np.asarray(pressure_mass(body, moduli).sum(axis=1)).ravel()
    return np.concatenate([np.zeros(body.space.displacement_size), GIVING_WAY * volumes])
