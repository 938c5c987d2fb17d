"""Which linear solver a body in space gets: a factor that is reused, or an iteration where that costs less."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.solvers.block_preconditioner import BlockPreconditioned, pressure_mass
from tactsim.fem.solvers.linear import LinearSolver, SuperLU, has_pardiso
from tactsim.fem.solvers.pardiso import FactorSize, QuasiDefinitePardiso, SinglePardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import FAILED, ReusedFactor
from tactsim.fem.solvers.section_solver import section_factors

OPERATIONS_PER_SECOND, ENTRIES_PER_SECOND = 4.2e10, 1e9
"""Speeds of a factor in single precision and of solutions with it. Grasps of 28 506 and 82 832 unknowns
(``benchmarks/scale.py``): 2.2e10 and 1.6e11 operations in 0.54 and 3.6 s, 1.8e7 and 7.7e7 entries in 17 and 66 ms; plates of
66 642 and 173 802 (``benchmarks/stretch.py``): 2.3e10 and 9.5e10 in 0.61 and 2.7 s, 2.9e7 and 8.9e7 in 32 and 95 ms. All in
seconds of one core beside other work, as those below; only their ratios decide."""
FACTORS, SOLUTIONS = 0.23, 7.0
"""Factors and solutions per system."""
PREPARATION, STEP = 7.5e-6, 7.5e-7
"""Seconds of the preconditioner and of one step of the iteration for each unknown."""
STEPS = 12.0
"""Steps per system: 7 in the grasp of 28 506 unknowns and 8 in that of 82 832, which ask for few digits; some 20 without contact.
Whole systems of the grasps took 0.35 and 1.05 s by iteration, 0.36 and 1.60 s by factor; the path of the smaller plate 75 s by
iteration and 52 s by factor; that of a block of 121 811 unknowns (``benchmarks/peers.py``) 47 and 41 s."""
SMALLEST_ITERATED = 25_000
"""Unknowns below which a factor is cheaper in any body, so that none need be analysed."""
LARGEST_FACTOR = 400_000
"""Unknowns from which a factor would not fit: by the growth from the grasps above it would have 6e8 entries there."""
LARGEST_SUPERLU = 5_000
"""Unknowns up to which SuperLU serves where Pardiso is not installed: 10 023 take 7.5 s by factor, 1.5 s by iteration to 1e-8."""
GIVING_WAY = 1e-4
"""Compliance that the factor adds to that of the tissue, times the shear modulus. With 1e-3 solutions to 1e-8 take six steps
more, and the rounding of single precision, 6e-8, is 6e-4 of what 1e-4 leaves as a pivot at worst."""


def factor_seconds(size: FactorSize) -> float:
    """Seconds per system of a body whose factors are of this size, by a factor that is reused, on one core."""
    return FACTORS * size.operations / OPERATIONS_PER_SECOND + SOLUTIONS * size.entries / ENTRIES_PER_SECOND


def iteration_seconds(unknowns: float) -> float:
    """Seconds per system of a body of so many unknowns by the iteration, on one core."""
    return (PREPARATION + STEPS * STEP) * unknowns


def solver_for(body: Body) -> LinearSolver:
    """A factor that is reused, or the iteration, whichever costs less in this body by the size of its factor."""
    size = body.space.size
    if size > LARGEST_FACTOR:
        return BlockPreconditioned(body)
    if not has_pardiso():
        return iterated(body) if size > LARGEST_SUPERLU else SuperLU()
    guide = QuasiDefinitePardiso(giving_way(body))
    if size < SMALLEST_ITERATED or factor_seconds(guide.analyse(_ones(body))) <= iteration_seconds(size):
        return factored(guide)
    guide.close()
    return iterated(body)


def section_solver() -> LinearSolver:
    """The solver of sections of some ten thousand unknowns."""
    return section_factors() if has_pardiso() else SuperLU()


def factored(guide: QuasiDefinitePardiso) -> Relay:
    """The factor of what gives way a little, whose pivots need not suffice; after it the matched one."""
    return Relay(ReusedFactor(guide, largest_left=FAILED), _sturdiest)


def iterated(body: Body) -> Relay:
    """The iteration; after it the factor whose pivots suffice."""
    return Relay(BlockPreconditioned(body), _sturdiest)


def _sturdiest() -> ReusedFactor:
    """A factor whose pivots suffice for any tissue: the matched one, or SuperLU's without Pardiso."""
    return ReusedFactor(SinglePardiso() if has_pardiso() else SuperLU())


def _ones(body: Body) -> csr_matrix:
    """A matrix of the pattern of the body's tangents."""
    return body.pattern.matrix(np.ones(len(body.pattern.indices)))


def giving_way(body: Body) -> Array:
    """What `QuasiDefinitePardiso` adds for the unknowns (size,) of a body: compliance times volume in m^3/Pa of each pressure."""
    moduli = np.array([material.shear_modulus for material in body.materials])[body.regions]
    volumes = np.asarray(pressure_mass(body, moduli).sum(axis=1)).ravel()
    return np.concatenate([np.zeros(body.space.displacement_size), GIVING_WAY * volumes])
