"""How stiff the contact must be for its penetration to stay below a stated tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from tactsim.contact.traction import ContactPair, ContactState

TARGET_SHARE = 0.5
"""Part of the tolerance that the penetration should use at the pressure of the last step."""
EXPECTED_RISE = 1.3
"""By how much the largest pressure may grow in the next step without another adaptation."""
TANGENTIAL_SHARE = 0.1
"""Tangential over normal penalty: elastic slip is ten times the penetration at equal traction."""
SLIP_SHARE = 10.0
"""Largest elastic slip over the largest penetration."""
RELAXED_SHARE = 0.02
"""Part of the tolerance that the penetration uses at the present pressure once a failed step has made the contact of relaxing
tissue softer.

Why: tissue is stiffest and presses hardest at once after a jump, and a penalty never decreases by itself, as every change of it
moves the tissue. Atrial tissue relaxes to a hundred thousandth of its stiffness: under a force its contact ended a thousand times
stiffer than the tolerance asks, and points at the edge opened and closed by turns. With half of the tolerance instead, what the
change moves counts as an error in time."""
SOFTER = 2.0
"""Least factor by which it becomes softer."""
FLOWING_SOFTNESS = 3.0
"""Softness of the contact of tissue that flows, at most, over the tolerance. Of 13 atrial grasps 3 led 9 to the end, in 0.5 to
2 s; 0.5 led 8, 25 the same 9 in 1 to 6 s. With 25, penetration took more than 1 % of the force of three others."""
WIDER = 10.0
"""Factor between the tolerances through which a state is approached."""
ROUND_OFF = 1e-9
"""Logarithm of a factor between two tolerances that is none."""


@dataclass(frozen=True)
class Regularisation:
    """Penalty in Pa/m that bounds the penetration by ``tolerance`` in m, and the stiffness that decides the state of a point.

    ``softest`` in Pa is a pressure scale of the tissue (a small-strain modulus) that bounds the penalty from below,
    ``switch_length`` in m the pressure scale over the switch stiffness, ``widest`` in m the penetration from which on a state is
    approached where Newton does not find it at once; with none it is not.
    """

    tolerance: float
    softest: float
    switch_length: float
    largest_pressure: float = 0.0
    widest: float = 0.0
    flows: bool = False
    """Whether the tissue relaxes to next to nothing, so that its forces follow the rate of the motion."""

    augments = False
    """Whether the tractions of a solution become multipliers of the next one, instead of a stiffer penalty."""

    @property
    def penalty(self) -> float:
        """Penalty in Pa/m for the largest pressure seen so far."""
        return max(self.softest, EXPECTED_RISE * self.largest_pressure) / (TARGET_SHARE * self.tolerance)

    @property
    def reach(self) -> float:
        """Largest gap in m across which a point may press."""
        return 0.0

    @property
    def wider(self) -> tuple[Self, ...]:
        """The same with wider tolerances, from the widest on, each a tenth of the one before."""
        count = math.ceil(math.log10(self.widest / self.tolerance) - ROUND_OFF) if self.widest > self.tolerance else 0
        return tuple(replace(self, tolerance=self.widest / WIDER**number) for number in range(count))

    def excess(self, penetration: float, elastic_slip: float) -> float:
        """Penetration in m over the tolerance; at most one if it is small enough."""
        return penetration / self.tolerance

    def excess_in_words(self, penetration: float, elastic_slip: float) -> str:
        """Which of the two in m is beyond what is allowed, and by how much."""
        return f"the penetration {penetration:.2e} m stays above the tolerance {self.tolerance:.2e} m"

    def seen(self, pressure: float) -> Self:
        """Adapted to the largest contact pressure in Pa of a solution; the penalty never decreases."""
        return replace(self, largest_pressure=max(pressure, self.largest_pressure))

    def softened(self, pressure: float) -> Self | None:
        """As stiff as the largest pressure in Pa of the present asks, whatever was before; None if it is hardly stiffer."""
        needed = TARGET_SHARE / RELAXED_SHARE * pressure
        if not 0 < SOFTER * needed < max(self.softest, self.largest_pressure):
            return None
        return replace(self, softest=min(self.softest, needed), largest_pressure=min(self.largest_pressure, needed))

    def stiffer(self) -> Self:
        """The same for a step in which multipliers overshoot; nothing else without them."""
        return self

    def after_step_from(self, before: Self) -> Self:
        """What the next step begins with; ``before`` is what this one began with."""
        return self

    def applied(self, pair: ContactPair, state: ContactState | None = None) -> ContactPair:
        """The pair with this regularisation, given the state that the last solution left at its points."""
        penalty = self.penalty
        return pair.with_penalty(penalty, TANGENTIAL_SHARE * penalty, self._switch)

    @property
    def _switch(self) -> float:
        return max(self.softest, self.largest_pressure) / self.switch_length


@dataclass(frozen=True)
class Augmentation(Regularisation):
    """A penalty so soft that Newton converges in 3D with friction, and multipliers that bring the penetration below the
    tolerance (augmented Lagrangian, Simo & Laursen 1992, doi:10.1016/0045-7949(92)90540-G).

    ``softness`` in m is the penetration at the largest pressure without multipliers.
    """

    softness: float = 1e-5

    augments = True

    def applied(self, pair: ContactPair, state: ContactState | None = None) -> ContactPair:
        """The pair with normal and tangential penalties in proportion to the last pressure at each point."""
        pressure = 0.0 if state is None else state.pressure
        penalty = np.maximum(self.softest, EXPECTED_RISE * pressure) / self.softness
        return pair.with_penalty(penalty, penalty, self._switch)

    @property
    def reach(self) -> float:
        """Largest gap in m across which a point may press: where its multiplier over its penalty ends."""
        return self.softness / EXPECTED_RISE

    def excess(self, penetration: float, elastic_slip: float) -> float:
        """Penetration and elastic slip in m over the largest allowed; at most one if both are small enough."""
        return max(penetration / self.tolerance, elastic_slip / (SLIP_SHARE * self.tolerance))

    def stiffer(self) -> Self:
        """Half as soft, down to a penetration within the tolerance without multipliers."""
        return replace(self, softness=max(self.softness / 2, min(self.softness, TARGET_SHARE * self.tolerance)))

    def over_step(self, stiffness: float) -> Self:
        """As stiff as the tissue is over the step, and no softer than ``FLOWING_SOFTNESS`` asks."""
        softness = min(self.softness, FLOWING_SOFTNESS * self.tolerance)
        return replace(self, softest=stiffness * self.softest, softness=softness)

    def after_step_from(self, before: Self) -> Self:
        """The same with the softness and the pressure scale from ``before``."""
        return replace(self, softest=before.softest, softness=before.softness)

    def excess_in_words(self, penetration: float, elastic_slip: float) -> str:
        """The larger one of the two in m over what is allowed of it."""
        allowed = SLIP_SHARE * self.tolerance
        if elastic_slip / allowed < penetration / self.tolerance:
            return super().excess_in_words(penetration, elastic_slip)
        return (
            f"the elastic slip {elastic_slip:.2e} m stays above {allowed:.2e} m, {SLIP_SHARE:g} times the penetration tolerance"
        )
