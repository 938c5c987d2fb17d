"""The first state under a prescribed force, approached through states of prescribed displacements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError, TooShort
from tactsim.mechanics.contact.posed_contact import PosedContact

ATTEMPTS = 12
"""Displacements that are tried."""
FIRST = 1e-3
"""The first of them over the size of the body."""
FARTHER = 2.0
"""Factor to the next one where Newton fails or nothing presses, and the largest where it presses too little."""
NEARER = 0.1
"""The smallest factor where it presses too much."""
POWER = 2 / 3
"""Of the force, to which the displacement of rounded bodies is in proportion (Hertz 1881); it only guides the search."""
NEAR = 0.2
"""Relative difference of the forces from which Newton finds the prescribed one."""


class Moved(Protocol):
    """A state after a displacement; a `ContactEquilibrium`."""

    @property
    def load(self) -> float:
        """Displacement in m of the rigid bodies."""

    @property
    def unknowns(self) -> Array:
        """Unknowns (size,)."""

    @property
    def contacts(self) -> tuple[PosedContact, ...]:
        """The contacts, with the forces that act there."""


def state_near(
    force: float, directions: Sequence[Array], size: float, moved: Callable[[float, Array], Moved], guess: Array
) -> Moved | None:
    """A state in which the rigid bodies press along unit vectors (d,) with about a ``force`` in N; None if none is found.

    Why: a block that two leaning jaws begin to hold at its edges is held by nothing else. The first iterates of Newton under a
    force throw it away, where under a displacement they cannot.

    Parameters
    ----------
    size : of the body in m
    moved : the state after a displacement in m, from a guess (size,) of the unknowns; raises ConvergenceError
    guess : (size,) of the unknowns
    """
    displacement = FIRST * size
    for _ in range(ATTEMPTS):
        factor = FARTHER
        try:
            reached = moved(displacement, guess)
        except TooShort:
            raise
        except ConvergenceError:
            displacement *= factor
            continue
        together = zip(reached.contacts, directions, strict=True)
        pressed = sum(float(e @ contact.surface.total(contact.state.traction)) for contact, e in together)
        if abs(pressed - force) <= NEAR * force:
            return reached
        if pressed > 0:
            factor, guess = float(np.clip((force / pressed) ** POWER, NEARER, FARTHER)), reached.unknowns
        displacement *= factor
    return None
