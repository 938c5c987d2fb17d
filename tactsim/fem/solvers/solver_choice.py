"""Which linear solver a body in 3D gets: a factor that is reused, or an iteration where that costs less."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.solvers.block_preconditioner import BlockPreconditioned, pressure_mass
from tactsim.fem.solvers.linear import LinearSolver, SuperLU, has_pardiso
from tactsim.fem.solvers.pardiso import FactorSize, QuasiDefinitePardiso, SinglePardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import FAILED, WORTH_A_FACTOR, ReusedFactor
from tactsim.fem.solvers.stiff_contact import section_factors, solid_factors

OPERATIONS_PER_SECOND, ENTRIES_PER_SECOND = 9e10, 2.5e9
"""Speeds of a factor in single precision and of solutions with it, on two idle cores, as a single run has them. Blocks of 45 293
and 121 811 unknowns (``benchmarks/peers.py``): 4.2e10 and 3.1e11 operations in 0.58 and 3.4 s, 3.1e7 and 1.3e8 entries in 13 and
47 ms; a grasp of 93 660 (``benchmarks/scale.py``): 2.4e11 in 2.5 s, 9.5e7 in 38 ms. One core takes twice as long, and the
iteration 1.4 times as long, so that in a sweep the larger bodies would gain from iterating earlier; but what a body is solved by
depends on the body alone, so that its result does too."""
FACTORS, SOLUTIONS = 0.23, 7.0
"""Factors and solutions per system."""
PREPARATION, STEP = 4.5e-6, 4.7e-7
"""Seconds of the preconditioner and of one step of the iteration for each unknown."""
STEPS = 12.0
"""Steps per system: 7 in grasps, which ask for few digits; some 20 without contact. Whole paths by iteration and by factor: the
grasp of 93 660 unknowns 17.5 and 19.9 s, that of 33 334 6.6 and 4.7 s, the block of 121 811 21.9 and 13.6 s."""
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
    """Seconds per system of a body whose factors are of this size, by a factor that is reused."""
    return FACTORS * size.operations / OPERATIONS_PER_SECOND + SOLUTIONS * size.entries / ENTRIES_PER_SECOND


def solutions_per_factor(size: FactorSize) -> int:
    """How many solutions cost as much as the factor: 34, 38 and 66 at 26 000, 45 000 and 122 000 unknowns."""
    return round(size.operations / OPERATIONS_PER_SECOND / (size.entries / ENTRIES_PER_SECOND))


def iteration_seconds(unknowns: float) -> float:
    """Seconds per system of a body of so many unknowns by the iteration."""
    return (PREPARATION + STEPS * STEP) * unknowns


def solver_for(body: Body) -> LinearSolver:
    """A factor that is reused, or the iteration, whichever costs less in this body by the size of its factor."""
    size = body.space.size
    if size > LARGEST_FACTOR:
        return BlockPreconditioned(body)
    if not has_pardiso():
        return iterated(body) if size > LARGEST_SUPERLU else SuperLU()
    guide = QuasiDefinitePardiso(giving_way(body))
    if size < SMALLEST_ITERATED:
        return factored(guide)
    if factor_seconds(factor := analysed(guide, body)) <= iteration_seconds(size):
        return factored(guide, factor)
    guide.close()
    return iterated(body)


def stiff_contact_solver(dim: int) -> LinearSolver:
    """The solver of sections and of bodies in 3D under stiff contact, of some ten thousand unknowns."""
    if not has_pardiso():
        return SuperLU()
    return section_factors() if dim == 2 else solid_factors()


def analysed(guide: QuasiDefinitePardiso, body: Body) -> FactorSize:
    """Size of the factor that the guide will make of the body's tangents."""
    return guide.analyse(body.pattern.matrix(np.ones(len(body.pattern.indices))))


def factored(guide: QuasiDefinitePardiso, size: FactorSize | None = None) -> Relay:
    """The factor of what gives way a little, whose pivots need not suffice; after it the matched one.

    A factor of a known size is reused for as long as it pays by that size, any other as a factor of some 20 000 unknowns is.
    """
    worth = WORTH_A_FACTOR if size is None else max(WORTH_A_FACTOR, solutions_per_factor(size))
    return Relay(ReusedFactor(guide, largest_left=FAILED, worth=worth), _sturdiest)


def iterated(body: Body) -> Relay:
    """The iteration; after it the factor whose pivots suffice."""
    return Relay(BlockPreconditioned(body), _sturdiest)


def _sturdiest() -> ReusedFactor:
    """A factor whose pivots suffice for any tissue: the matched one, or SuperLU's without Pardiso."""
    return ReusedFactor(SinglePardiso() if has_pardiso() else SuperLU())


def giving_way(body: Body) -> Array:
    """What `QuasiDefinitePardiso` adds for the unknowns (size,) of a body: compliance times volume in m^3/Pa of each pressure."""
    volumes = np.asarray(pressure_mass(body, body.shear_moduli).sum(axis=1)).ravel()
    return np.concatenate([np.zeros(body.space.displacement_size), GIVING_WAY * volumes])
