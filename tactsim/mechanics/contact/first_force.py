"""The first state under a prescribed force, approached through states of prescribed displacements."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Protocol

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.mechanics.contact.posed_contact import PosedContact

ATTEMPTS = 12
"""Displacements that are tried."""
FIRST = 1e-3
"""The first of them over the size of the body."""
FARTHER = 2.0
"""Factor to the next one where Newton fails or nothing presses, and the largest where it presses too little."""
GENTLEST, STEEPEST = 1.0, 3.0
"""Bounds of the power of the displacement that the force is taken to grow with: 1 of flat bodies, 3/2 of rounded ones (Hertz
1881), 2 of jaws that lean, more where tissue is squeezed; it only guides the search."""
USUAL = 1.5
"""That power while one displacement is known."""
INSIDE = 0.2
"""Least distance of a displacement from those around it, over the distance between them, on a logarithmic scale."""
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
    search = _Search(force, FIRST * size)
    for _ in range(ATTEMPTS):
        try:
            reached = moved(search.displacement, guess)
        except ConvergenceError:
            search.failed()
            continue
        together = zip(reached.contacts, directions, strict=True)
        pressed = sum(float(e @ contact.surface.total(contact.state.traction)) for contact, e in together)
        if abs(pressed - force) <= NEAR * force:
            return reached
        if 0 < pressed < force:
            guess = reached.unknowns
        search.pressed(pressed)
    return None


class _Search:
    """Search of the ``displacement`` in m under which a ``force`` in N presses, between those that press less and more."""

    def __init__(self, force: float, first: float):
        self._force, self.displacement = force, first
        self._less: list[tuple[float, float]] = []
        self._more: tuple[float, float] | None = None

    def failed(self) -> None:
        """At the displacement there is no state: the next one is nearer to one that presses, or farther while none does."""
        pressing = self._less[-1][0] if self._less else 0.0
        self.displacement = math.sqrt(pressing * self.displacement) if pressing else FARTHER * self.displacement

    def pressed(self, force: float) -> None:
        """The rigid bodies press with this ``force`` in N at the displacement."""
        if force <= 0:
            self.failed()
            return
        if force < self._force:
            self._less = [*self._less[-1:], (self.displacement, force)]
        else:
            self._more = (self.displacement, force)
        self.displacement = self._between() if self._less and self._more else self._beyond(force)

    def _between(self) -> float:
        """A displacement between the two, where a power of it would give the force."""
        assert self._more is not None
        (low, less), (high, more) = self._less[-1], self._more
        share = math.log(self._force / less) / math.log(more / less)
        return low * (high / low) ** min(max(share, INSIDE), 1 - INSIDE)

    def _beyond(self, force: float) -> float:
        """A displacement on the other side of what presses with this ``force`` in N now, by the power of it between the last two
        that press too little."""
        power = USUAL
        if len(self._less) > 1:
            (before, less), (after, more) = self._less
            power = math.log(more / less) / math.log(after / before) if more > less and after > before else USUAL
        wanted = (self._force / force) ** (1 / min(max(power, GENTLEST), STEEPEST))
        return self.displacement * min(max(wanted, 1 / FARTHER), FARTHER)
