"""How good the accepted states of a run with contact are: what penetration costs, how volumes are kept, where material fails."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.penetration_effect import PenetrationEffect
from tactsim.mechanics.fields.ellipticity import elliptic_in
from tactsim.mechanics.fields.volume_ratios import VolumeRatios
from tactsim.mechanics.outcome.contact_history import WHOLE_RUN
from tactsim.mechanics.outcome.small_strains import SmallStrains
from tactsim.mesh.adaptation import Refinement
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.units import format_quantity

FINER = "take smaller elements"
"""How most cases make their mesh finer, in their own words."""

SMALL_CONTACTS = {1: 1.0, 2: 0.25, 4: 0.1, 6: 0.03}
"""Points of the surface that press at most -> largest error of the force.

Measured: a ball on a half-space against Hertz, on elements of 0.065 to 0.15 of its radius, pressed by 15e-6 to 0.02 of it; 0.99,
0.21, 0.09 and 0.02, with seven points and more 0.005."""
RESOLVED = max(SMALL_CONTACTS) + 1
"""Pressing points from which on nothing is said; nor is it where all points of a surface press, however few these are."""


def displacement_reached(step: StepRecord) -> str:
    """How far a step has come, in words."""
    return f"a displacement of {format_quantity(step.values['displacement'], 'm')}"


class ContactQuality:
    """Follows the accepted states of one run.

    Parameters
    ----------
    stiffest : as in ``PenetrationEffect``
    finer : what makes the mesh finer, in the words of the case
    reached : how far a step has come, in words
    """

    def __init__(
        self,
        stiffest: float = math.inf,
        *,
        finer: str = FINER,
        reached: Callable[[StepRecord], str] = displacement_reached,
    ):
        self._effect, self._volumes, self._reached = PenetrationEffect(stiffest), VolumeRatios(finer), reached
        self._strains, self._finer = SmallStrains(), finer
        self._unstable: Array | None = None
        self._touching, self._all_touch = 0, False

    def refined(self, before: Body, split: Refinement) -> None:
        """Go on with a finer mesh: a child has left ellipticity where the nearest point of its parent has."""
        old = before.points.pressure_values.T
        new = np.einsum("ekv,kq->evq", split.barycentric, old)
        nearest = np.linalg.norm(new[:, :, :, None] - old[None, :, None, :], axis=1).argmin(axis=2)
        if self._unstable is not None:
            self._unstable = np.take_along_axis(self._unstable[split.parents], nearest, axis=1)

    def values(self, body: Body, state: ContactEquilibrium) -> dict[str, float]:
        """History values of a state: how volumes are kept, what has left ellipticity until now, what penetration costs."""
        unstable, weights = ~elliptic_in(body, state.kinematics), body.points.weights
        self._unstable = unstable if self._unstable is None else self._unstable | unstable
        self._strains.observe(body, state.kinematics)
        self._effect = self._effect.after(state)
        pressing = [contact.state.pressure > 0 for contact in state.contacts]
        self._touching = max(self._touching, sum(int(points.sum()) for points in pressing))
        self._all_touch = self._all_touch or not pressing or any(points.all() for points in pressing)
        return {
            "min_volume_ratio": float(state.kinematics.J.min()),
            "unstable_volume_fraction": float(weights[self._unstable].sum() / weights.sum()),
            "penetration_force_error": self._effect.share,
            "poor_volume_fraction": self._volumes.poor_share(body, state),
        }

    def quantities(self, steps: Sequence[StepRecord]) -> dict[str, Quantity]:
        """Quantities of at least one accepted step."""
        last = steps[-1].values
        deepest = max(step.values["max_penetration"] for step in steps)
        least = min(step.values["min_volume_ratio"] for step in steps)
        effect = "part of the largest force that the penetration left takes away, estimated, at the last accepted step"
        poor = "largest part of the volume with local volume ratios off by more than a tenth, any step"
        return {
            "min_volume_ratio": Quantity(least, *WHOLE_RUN["min_volume_ratio"]),
            "max_penetration": Quantity(deepest, *WHOLE_RUN["max_penetration"]),
            "unstable_volume_fraction": Quantity(last["unstable_volume_fraction"], *WHOLE_RUN["unstable_volume_fraction"]),
            "penetration_force_error": Quantity(last["penetration_force_error"], "1", effect),
            "poor_volume_fraction": Quantity(self._volumes.worst, "1", poor),
        }

    @property
    def touched(self) -> bool:
        """Whether any point of a surface has pressed."""
        return self._touching > 0

    def _unresolved(self) -> list[str]:
        """The warning that hardly any points press, if so; that none does, each kind of case says in its words."""
        if self._all_touch or not 0 < self._touching < RESOLVED:
            return []
        points = f"{self._touching} points" if self._touching > 1 else "a single point"
        most = next(error for count, error in SMALL_CONTACTS.items() if self._touching <= count)
        return [
            f"the contact is no wider than {points} of the surface; its force may be off by {100 * most:.0f} %: {self._finer}"
        ]

    def warnings(self, steps: Sequence[StepRecord]) -> list[str]:
        """Warnings about the accepted steps: volumes that are not kept, and material that left strong ellipticity."""
        unstable = [step for step in steps if step.values["unstable_volume_fraction"] > 0]
        kept = [*self._volumes.warnings(), *self._strains.warnings(), *self._unresolved()]
        if not unstable:
            return kept
        share = steps[-1].values["unstable_volume_fraction"]
        return [
            *kept,
            f"{100 * share:.1f} % of the volume left strong ellipticity, first at {self._reached(unstable[0])}: "
            "there the answer depends on the mesh; take a stable material set",
        ]
