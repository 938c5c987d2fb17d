"""What the switch probe reports beside quantities and history: the array with its thresholds, and every closing of a switch."""

from __future__ import annotations

from typing import Literal

from tactsim.model import FrozenModel
from tactsim.results.scene import Scene


class SwitchClosing(FrozenModel):
    """A switch that closed."""

    switch: int
    """Its number, counted from 1 at the face."""
    time: float
    """In s."""
    force: float
    """That was read then, in N."""


class RecordedTouch(FrozenModel):
    """A touch of one tissue at one rate, as it was read; of several touches that with the most closings."""

    tissue: str
    """Name of the tissue."""
    rate: float
    """In m/s."""
    count: int
    """Number of touches that were read."""
    start: float | None = None
    """In s; null if none was read."""
    end: float | None = None
    """In s; null if none was read."""
    mean_rate: float | None = None
    """Mean rate in m/s between the first and the last switch; null if not every one closed."""
    closings: tuple[SwitchClosing, ...] = ()
    """In the order of time."""


class SwitchProbeScene(Scene):
    """The probe and what its array recorded."""

    kind: Literal["switch_probe"] = "switch_probe"
    model: Literal["fast", "fem"]
    """How the forces were computed."""
    sides: Literal["computed", "followed"]
    """How far the tissue touches the sides of the probe."""
    tissues: tuple[str, ...]
    """Names of the tissues."""
    rates: tuple[float, ...]
    """In m/s."""
    depth: float
    """Of the face at the turn, in m."""
    heights: tuple[float, ...]
    """Of the switches above the face, in m."""
    switch_sides: tuple[Literal["right", "left"], ...]
    """Side of each switch."""
    noise: float
    """Root mean square error of a reading without force, in N."""
    touch_threshold: float
    """Force in N above which the probe counts as touching."""
    switch_threshold: float
    """Rise of the force in N that closes a switch."""
    formula: Literal["corrected", "as_printed"]
    """Formula of the mean rate."""
    touches: tuple[RecordedTouch, ...]
    """By tissue and rate."""
