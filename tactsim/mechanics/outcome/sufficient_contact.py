"""Equilibria whose penetration takes away no more of the force than a success may: solved again with a tighter tolerance else."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.penetration_effect import PenetrationEffect
from tactsim.mechanics.outcome.success import LARGEST_FORCE_ERROR, sufficient_tolerance
from tactsim.mechanics.paths.history_path import EquilibriumProblem

MOST_TIGHTENINGS = 3
"""How often a state is solved again with a tighter tolerance."""
LEAST_TIGHTENING = 0.7
"""Largest factor of the tolerance by which it is tightened."""
LARGEST_LOAD = 1 - 1e-9
"""Part of the largest load from which on a state is one at the largest load."""


@dataclass(frozen=True)
class _Followed(ContactEquilibrium):
    """A state with the ``effect`` of penetration in it, beside the states that led there and no others."""

    effect: PenetrationEffect = field(default_factory=PenetrationEffect)


class SufficientContact:
    """A problem of equilibrium whose states at the largest load are held to the error of the force that a success may have.

    The states before are on the way there and stay as they are.

    Parameters
    ----------
    problem : whose states have a penetration within their tolerance
    largest : first of the prescribed values from which on states are held to it
    stiffest : as in `PenetrationEffect`
    """

    def __init__(self, problem: EquilibriumProblem, largest: float, stiffest: float = math.inf):
        self._problem, self._largest = problem, largest
        self._at_rest = PenetrationEffect(stiffest)

    @property
    def body(self) -> Body:
        """The body that deforms."""
        return self._problem.body

    def equilibrium(
        self, now: ContactEquilibrium, loads: tuple[float, ...], guess: Array, relaxation: RelaxationStep | None
    ) -> ContactEquilibrium:
        """The equilibrium at prescribed values, reached from ``now``; where no tighter one is reached, the last one stays.

        ``guess`` (size + 1,) is that of `EquilibriumProblem`.

        Raises
        ------
        ConvergenceError
            If there is none that Newton finds.
        """
        before = now.effect if isinstance(now, _Followed) else self._at_rest.after(now)
        reached = self._problem.equilibrium(now, loads, guess, relaxation)
        for _ in range(MOST_TIGHTENINGS if loads[0] >= LARGEST_LOAD * self._largest else 0):
            error = before.after(reached).share
            if error <= LARGEST_FORCE_ERROR:
                break
            start = _tightened(now, reached, error)
            try:
                reached = self._problem.equilibrium(start, loads, np.append(reached.unknowns, reached.load), relaxation)
            except ConvergenceError:
                break
        known = {one.name: getattr(reached, one.name) for one in fields(ContactEquilibrium)}
        return _Followed(**known, effect=before.after(reached))


def _tightened(now: ContactEquilibrium, reached: ContactEquilibrium, error: float) -> ContactEquilibrium:
    """The state before a step with a tighter tolerance, from which the forces that were ``reached`` are the expected ones."""
    old = reached.regularisation
    tolerance = min(LEAST_TIGHTENING * old.tolerance, sufficient_tolerance(reached.penetration, old.tolerance, error))
    return replace(now.expecting(reached.contacts), regularisation=replace(old, tolerance=tolerance))
