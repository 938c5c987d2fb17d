"""How good the accepted states of a run with contact are: what penetration costs, and how volumes are kept."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tactsim.fem.assembly.body import Body
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.penetration_effect import PenetrationEffect
from tactsim.mechanics.fields.volume_ratios import VolumeRatios
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord


class ContactQuality:
    """Follows the accepted states of one run; ``stiffest`` as in ``PenetrationEffect``, ``finer`` says what refines the mesh."""

    def __init__(self, stiffest: float = math.inf, *, finer: str = "take smaller elements"):
        self._effect, self._volumes = PenetrationEffect(stiffest), VolumeRatios(finer)

    def values(self, body: Body, state: ContactEquilibrium) -> dict[str, float]:
        """History values of a state."""
        return {
            "penetration_force_error": self._effect.share(state),
            "poor_volume_fraction": self._volumes.poor_share(body, state),
        }

    def quantities(self, steps: Sequence[StepRecord]) -> dict[str, Quantity]:
        """Quantities of the accepted steps."""
        if not steps:
            return {}
        error = steps[-1].values["penetration_force_error"]
        return {
            "penetration_force_error": Quantity(
                error, "1", "part of the largest force that the penetration left takes away, estimated, at the last accepted step"
            ),
            "poor_volume_fraction": Quantity(
                self._volumes.worst, "1", "largest part of the volume with local volume ratios off by more than a tenth, any step"
            ),
        }

    def warnings(self) -> list[str]:
        """Warnings for the user."""
        return self._volumes.warnings()
