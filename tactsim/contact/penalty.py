"""How stiff the contact must be for its penetration to stay below a stated tolerance."""

from __future__ import annotations

from dataclasses import dataclass, replace

from tactsim.contact.traction import ContactPair

TARGET_SHARE = 0.5
"""Part of the tolerance that the penetration should use at the pressure of the last step."""
EXPECTED_RISE = 1.3
"""By how much the largest pressure may grow in the next step without another adaptation."""
TANGENTIAL_SHARE = 0.1
"""Tangential over normal penalty: elastic slip is ten times the penetration at equal traction."""


@dataclass(frozen=True)
class Regularisation:
    """Penalty in Pa/m that bounds the penetration by ``tolerance`` in m, and the stiffness that decides the state of a point.

    ``softest`` in Pa is a pressure scale of the tissue (a small-strain modulus) that bounds the penalty from below.
    """

    tolerance: float
    softest: float
    switch_length: float
    largest_pressure: float = 0.0

    @property
    def penalty(self) -> float:
        """Penalty in Pa/m for the largest pressure seen so far."""
        pressure = max(self.softest, EXPECTED_RISE * self.largest_pressure)
        return pressure / (TARGET_SHARE * self.tolerance)

    def seen(self, pressure: float) -> Regularisation:
        """Adapted to the largest contact pressure in Pa of an accepted step; it never softens."""
        return replace(self, largest_pressure=max(pressure, self.largest_pressure))

    def applied(self, pair: ContactPair) -> ContactPair:
        """The pair with this regularisation."""
        switch = max(self.softest, self.largest_pressure) / self.switch_length
        return pair.with_penalty(self.penalty, TANGENTIAL_SHARE * self.penalty, switch)
