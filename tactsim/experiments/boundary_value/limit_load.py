"""Whether a path ended at a limit load: a largest load, above which the equilibrium that it followed goes no further."""

from __future__ import annotations

import numpy as np

from tactsim.mechanics.models.loaded_body import LoadedBody
from tactsim.mechanics.paths.history_path import TimedState
from tactsim.units import format_quantity

GIVES_WAY = 5.0
"""How many times as far as at its stiffest the same further load moves a body that has all but reached its limit load. There the
motion grows like one over the root of the load that is missing (Koiter 1945); steps that end a hundredth below it show ten."""


class LimitLoad:
    """Watches how far further loads move the body of a ``model``, along the accepted states from ``start`` on."""

    def __init__(self, model: LoadedBody, start: TimedState):
        self._model, self._before = model, start
        self._least, self._last = np.inf, 0.0

    def observe(self, state: TimedState) -> None:
        """Take in the next accepted state; only steps in which nothing but loads changes count."""
        before, self._before = self._before, state
        conditions = self._model.conditions
        now, then = conditions.split(state.loads), conditions.split(before.loads)
        led = conditions.motions.at(now[0]).differs(conditions.motions.at(then[0]))
        pushed = not np.array_equal(conditions.places(state.loads), conditions.places(before.loads))
        grown = float(np.abs(np.subtract(now[1], then[1])).max(initial=0.0))
        if grown == 0 or led or pushed:
            return
        u, _ = self._model.space.split(state.contact.unknowns - before.contact.unknowns)
        self._last = float(np.abs(u).max()) / grown
        self._least = min(self._least, self._last)

    def in_words(self) -> str:
        """That the path seems to have ended there, and what to do; empty if it does not."""
        if not self._last > GIVES_WAY * self._least:
            return ""
        times = f"{self._last / self._least:.2g} times"
        return (
            f"; up to {format_quantity(self._before.time, 's')} the body gave way more and more, at last {times} as far under "
            "the same further load as when it was stiffest: this seems to be a limit load, above which no equilibrium is near. "
            "Where the shape allows it, prescribe a displacement instead of the load; its force is then the answer"
        )
