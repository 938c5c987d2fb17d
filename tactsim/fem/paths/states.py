"""States along a path of loads or times, and the unknowns between two of them and beyond the last."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from tactsim.array import Array

FARTHEST = 2.0
"""Steps of the last one's length that the unknowns are extrapolated over at most."""


class PathState(Protocol):
    """An accepted state."""

    @property
    def unknowns(self) -> Array:
        """Unknowns (size,), from which the first guess of the next step is extrapolated."""

    @property
    def iterations(self) -> int:
        """Newton iterations it took."""


def between(states: Mapping[float, PathState], place: float) -> Array:
    """Unknowns (size,) at a place by interpolation between the nearest states on both sides of it, given by their places."""
    low, high = max(p for p in states if p < place), min(p for p in states if p > place)
    share = (place - low) / (high - low)
    return (1 - share) * states[low].unknowns + share * states[high].unknowns


def beyond(states: Mapping[float, PathState], step: float) -> Array:
    """Unknowns (size,) a ``step`` after the last of one or two states, by their places: extrapolated from one to the other."""
    before, now = min(states), max(states)
    if before == now:
        return states[now].unknowns
    return states[now].unknowns + min(step / (now - before), FARTHEST) * (states[now].unknowns - states[before].unknowns)
