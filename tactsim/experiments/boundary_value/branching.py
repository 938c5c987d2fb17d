"""Whether an equilibrium is stable: in the computer a perfect column stays straight far beyond the load that buckles it."""

from __future__ import annotations

import numpy as np

from tactsim.fem.solvers.inertia import Inertia
from tactsim.fem.solvers.linear import has_pardiso
from tactsim.mechanics.models.loaded_body import LoadedBody
from tactsim.mechanics.outcome.wrinkles import WRINKLED
from tactsim.mechanics.paths.history_path import TimedState

ROUND_OFF = 1e-9
"""Asymmetry of a tangent over its largest entry that counts as none."""
LARGEST = 60_000
"""Unknowns up to which a further factor costs little beside a path: 5 s of a block in 3D of 54 114."""


def lowering_motions(model: LoadedBody, state: TimedState) -> int:
    """Number of independent motions of a body that lower its energy in an equilibrium; 0 if it is stable, or none can say.

    The tangent [[A, B'], [B, -C]] of displacements and pressures has as many negative eigenvalues as there are pressures, and
    one more for each motion in which the second variation of the energy is negative (Haynsworth 1968, additivity of inertia).
    A linear law is always stable. Nothing is said of bodies that rigid ones touch, which may let go, of materials that relax and
    of pressures that follow a free edge, which have no energy, and of bodies of too many unknowns.
    """
    space = model.space
    has_energy = not state.contact.contacts and state.relaxation is None
    if not has_energy or model.body.linear.all() or space.size > LARGEST or not has_pardiso():
        return 0
    matrix = model.tangent(state.contact, state.loads)
    if abs(matrix - matrix.T).max() > ROUND_OFF * np.abs(matrix.data).max():
        return 0
    solver = Inertia()
    try:
        negative = solver.negative(matrix)
    finally:
        solver.close()
    return 0 if negative is None else max(negative - (space.size - space.displacement_size), 0)


def unstable_in_words(model: LoadedBody, state: TimedState) -> str:
    """That motions lower the energy of a state, and what to do; empty if none does, or none can say."""
    motions = lowering_motions(model, state)
    if not motions:
        return ""
    which = "a motion of the body lowers" if motions == 1 else f"{motions} motions of the body lower"
    words = (
        f"the equilibrium at the end is unstable: {which} its energy, as when a column buckles, and the least imperfection leads "
        "to another; add a small load across, such as a traction of a hundredth of what acts, a larger one or more steps until "
        "this warning is gone"
    )
    gradients = np.moveaxis(state.contact.kinematics.F, (0, 1), (-2, -1))
    shortest = float(np.linalg.svd(gradients, compute_uv=False)[..., -1].min())
    if shortest > WRINKLED:
        return words
    return (
        f"{words}. Or it is the mesh: parts are squeezed to {shortest:.2g} of their length, and at a free face elements wrinkle "
        f"from {WRINKLED} on, a rubber half-space only from 0.54 on (Biot 1963); if the number of motions grows on smaller "
        "elements, it is theirs, and the equilibrium may well be stable"
    )
