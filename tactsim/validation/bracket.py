"""Readings of a simulation that a bracket spans: threshold pressures over both areas of erratum E16."""

from __future__ import annotations

from typing import Literal

from tactsim.validation.study import RunOutcome

Area = Literal["annulus", "disc", "both"]


def readings(outcome: RunOutcome, quantity: str, area: Area = "both") -> list[float]:
    """The quantity in SI; a pressure over the annulus, over the full disc, or both.

    Source: the annular area is what turns the pressures of Table 3.3 into its forces; "total area, on the larger sensor" in 3.2
    may mean the disc.
    """
    value = outcome.quantities[quantity]
    if quantity != "threshold_pressure":
        return [value]
    over_disc = value * outcome.disc_share
    return {"annulus": [value], "disc": [over_disc], "both": [over_disc, value]}[area]
