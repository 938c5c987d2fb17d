"""Progress along a path of loads or times: whether the rest of the path can still be expected to be completed.

A path is given up by the number of linear solutions, never by the clock, so that a case ends the same way on every machine.
"""

from __future__ import annotations

import math
from collections import deque

from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.units import format_quantity

WINDOW = 100
"""Linear solutions over which progress is measured: more than half of the shipped cases need fewer in all, and a step that is cut
seven times before it converges needs no more."""
MOST_FURTHER = 600
"""Linear solutions that the rest of the path may need at the recent rate, besides those of the requested steps: twice
as many as the shipped cases need at most from beginning to end (13 to 357, measured). For a grasp that did converge the largest
estimate was 472; for those that stagnated it was thousands."""
PER_STEP = 60
"""Further ones for each requested step: a 3D step with friction takes 60 at most where nothing is wrong."""
SHORTEST_REST = 0.05
"""Least fraction of the path that the rest counts as, so that progress may not vanish just before the target."""
MOST_STEPS = 50_000
"""Most steps that may be requested. The shortest, of a section with few elements, take 10 ms: in all some ten minutes."""


def check_steps(count: float, what: str) -> None:
    """Refuse a path of too many requested steps.

    Raises
    ------
    InvalidQuantity
        Naming ``what`` requests them.
    """
    if not count <= MOST_STEPS:
        raise InvalidQuantity(f"{what} asks for {count:.3g} steps; allowed: up to {MOST_STEPS}; take longer or fewer ones")


class Headway:
    """Watches one path from ``start`` to ``target``, in ``unit`` in messages.

    Progress is measured by the logarithm of the distance covered: steps that begin very short and grow by a factor each, as
    after a sudden change, count as progress from the first one on.
    """

    def __init__(self, start: float, target: float, unit: str = ""):
        self._start, self._target, self._unit = start, target, unit
        self._marks: deque[tuple[int, float]] = deque([(0, 0.0)])

    def spent(self, solutions: int, place: float, steps: float, failure: ConvergenceError | None = None) -> None:
        """Count ``solutions`` more linear ones up to the ``place`` reached, with so many more ``steps`` requested.

        ``failure`` is the error of the last step if it was rejected.

        Raises
        ------
        ConvergenceError
            If the rest of the path would need too many at the recent rate.
        """
        total = self._marks[-1][0] + max(solutions, 1)
        share = (place - self._start) / (self._target - self._start)
        self._marks.append((total, share))
        while total - self._marks[1][0] >= WINDOW:
            self._marks.popleft()
        before, old = self._marks[0]
        if total - before < WINDOW or (old == 0 < share):
            return
        gained = math.log(share / old) if old > 0 else 0.0
        rest = max(-math.log(share) if share > 0 else math.inf, SHORTEST_REST)
        further = rest / gained * (total - before) if gained > 0 else math.inf
        if further > MOST_FURTHER + PER_STEP * steps:
            last = "" if failure is None else f"; the last step failed: {failure}"
            reached, end = (format_quantity(value, self._unit) for value in (place, self._target))
            raise ConvergenceError(
                f"gave up at {reached} of {end}, for there is hardly any headway: the last {total - before} "
                f"linear solutions brought {100 * (share - old):.2g} % of the way, so that the rest would take "
                f"{_count(further)} more; allowed: {MOST_FURTHER + PER_STEP * steps:.0f}. Another mesh, above all at corners "
                f"and edges of contacts, a wider tolerance or a smaller load may help{last}",
                () if failure is None else failure.history,
            )


def _count(number: float) -> str:
    """A number of solutions in words."""
    return "infinitely many" if math.isinf(number) else f"about {number:.2g}"
