"""Where along a path an event happens: few equilibria, because each costs a Newton solution, and those of the path count too."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from tactsim.array import Array
from tactsim.fem.paths.states import PathState, between

MOST_ESTIMATES = 4
"""Interpolations in a row; if they have not found the root, every other step halves the bracket."""


State = TypeVar("State", bound=PathState)


def located(
    reach: Callable[[float, Array], State], value: Callable[[State], float], path: Mapping[float, State], tolerance: float
) -> State:
    """The state at which a value turns from negative to positive between the last two states of a path, given by their places.

    Parameters
    ----------
    reach : (place, guess) -> the equilibrium there
    value : of a state; negative before the event
    path : the two states around the event, and what is known before them
    tolerance : largest error of the place
    """
    states = dict(path)
    low, high = sorted(states)[-2:]

    def value_at(place: float) -> float:
        states[place] = reach(place, between(states, place))
        return value(states[place])

    return states[crossing(value_at, {place: value(state) for place, state in states.items()}, (low, high), tolerance)]


def crossing(
    value: Callable[[float], float], known: Mapping[float, float], bracket: tuple[float, float], tolerance: float
) -> float:
    """Place in the bracket where a value turns from negative to positive, the last one at which ``value`` was called.

    Inverse quadratic interpolation through the three places of smallest value (Brent 1973, Algorithms for Minimization without
    Derivatives, chapter 4), which the path before the bracket may hold, so that the first estimate is of third order already.
    The error left at a place is its value over the smaller of the slopes to both ends of the bracket.

    Parameters
    ----------
    value : at a place in the bracket
    known : values at places, those of both ends of the bracket among them
    bracket : a place with a negative value, and a later one with a value that is zero or positive
    tolerance : largest error of the place
    """
    values, (low, high), estimates = dict(known), bracket, 0
    if values[high] == 0:
        return high
    while True:
        estimates += 1
        place = _estimated(values, low, high)
        if not low < place < high or (estimates > MOST_ESTIMATES and estimates % 2):
            place = (low + high) / 2
        here = values[place] = value(place)
        slopes = [(here - values[end]) / (place - end) for end in (low, high)]
        low, high = (place, high) if here < 0 else (low, place)
        if abs(here) <= tolerance * min(slopes) or high - low <= tolerance:
            return place


def _estimated(values: Mapping[float, float], low: float, high: float) -> float:
    """Root of the parabola of the place over the value, or of the line between both ends where there is none in the bracket."""
    nearest = sorted(values, key=lambda place: abs(values[place]))[:3]
    if len({values[place] for place in nearest}) == 3:
        root = sum(a * _share([values[b] for b in nearest if b != a], values[a]) for a in nearest)
        if low < root < high:
            return root
    return low - values[low] * (high - low) / (values[high] - values[low])


def _share(others: list[float], own: float) -> float:
    """Lagrange's polynomial, at zero, that is one at ``own`` and zero at the ``others``."""
    share = 1.0
    for other in others:
        share *= other / (other - own)
    return share
