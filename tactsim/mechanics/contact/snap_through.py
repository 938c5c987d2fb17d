r"""Past a snap: where an equilibrium ends under a load that goes on, the body moves to another one, held back by viscous drag.

A contact point that opens or closes can leave the body unstable: with the point open, Newton closes it, and with it closed, opens
it, however short the step of the load is, for there is no equilibrium nearby. The motion to the next one is followed by steps of
an overdamped body in pseudo-time,

.. math:: f_{ext}(u_{n+1}) - f_{int}(u_{n+1}) = c\,(u_{n+1} - u_n),

with a drag c in proportion to the volume, which falls from step to step until the equilibrium without drag is reached.

Source: Kelley & Keyes 1998, doi:10.1137/S0036142996304796, for such continuation in pseudo-time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.external_forces import FollowerLoad
from tactsim.fem.assembly.regularising_springs import AnchoredSprings
from tactsim.fem.paths.states import PathState

FIRST_DRAG = 1e4
"""Stiffness of all drag together over that of the body, its shear modulus times its size: in an element of a fiftieth of the size
it begins four times as stiff as the tissue."""
LESS, MORE = 0.4, 3.0
"""Factors of the drag after a step that converged, and one that did not: a drag little above the negative stiffness of an
unstable body lets it move away fastest."""
MOST_STEPS = 30
"""Steps in pseudo-time before a snap counts as failed."""


State = TypeVar("State", bound=PathState)


def after_snap(body: Body, state: State, solve: Callable[[State, Sequence[FollowerLoad]], State]) -> State:
    """What ``solve`` gives without drag, reached from a ``state`` by steps with it.

    Parameters
    ----------
    solve : (state to start from, further loads) -> an equilibrium

    Raises
    ------
    ConvergenceError
        If no equilibrium without drag is reached.
    """
    drag, now, solutions = FIRST_DRAG, state, 0
    too_little = 2 * FIRST_DRAG
    for _ in range(MOST_STEPS):
        try:
            now = solve(now, [AnchoredSprings(body, drag, now.unknowns)])
        except ConvergenceError as error:
            solutions += error.solutions
            drag, too_little = drag * MORE, drag
            continue
        drag *= LESS
        if drag < LESS * too_little:
            try:
                return solve(now, [])
            except ConvergenceError as error:
                solutions += error.solutions
                too_little = drag
    raise ConvergenceError(f"no equilibrium after a snap in {MOST_STEPS} steps", solutions=solutions)
