"""The inclusion of a case file: any registered kind; and what a set of them must satisfy."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import Solid, check_size
from tactsim.registry import Registered
from tactsim.units import format_quantity

AnyInclusion = Annotated[Inclusion, Registered(Inclusion)]
"""Pydantic type of every registered inclusion."""
SMALLEST = 0.01
"""Least diameter of an inclusion over the shortest side of the block: a smaller one is a mistaken unit."""
SAMPLES_ACROSS = 40
"""Sample triangles along the extent of a body when its distance from another is measured."""
FOUND = 1e-6
"""Error of the distance between two bodies that are too near, over the extent of one."""


def inclusion_name(number: int, inclusion: Inclusion) -> str:
    """How messages and results call the inclusion of a number, counted from 1."""
    return f"{inclusion.kind} {number}"


def check_inclusions(size: Array, inclusions: Sequence[Inclusion], gap: float) -> None:
    """Refuse inclusions that overlap, touch, protrude or do not suit a block of size (3,) in m.

    Parameters
    ----------
    gap : least distance in m between two inclusions, and between an inclusion and a face that it does not leave through

    Raises
    ------
    InputError
        Naming the inclusions, the face, the distance and what is allowed.
    """
    check_size(size)
    solids = []
    for number, inclusion in enumerate(inclusions, 1):
        name = inclusion_name(number, inclusion)
        body = checked_solids(inclusion, size)[0]
        _check_extent(body, size, name)
        inclusion.check_in_block(size, gap, name)
        solids.append(_Embedded(name, body, size, hollow=len(inclusion.solids(size)) > 1))
    for first, second in itertools.combinations(solids, 2):
        _check_apart(first, second, gap)


def checked_solids(inclusion: Inclusion, size: Array) -> tuple[Solid, ...]:
    """The solids of an inclusion in a block of size (3,) in m.

    Raises
    ------
    InvalidQuantity
        If they are no tuple of one, or of an outer and an inner one, or their numbers are refused.
    """
    name = type(inclusion).__name__
    try:
        solids: object = inclusion.solids(size)
    except ValueError as error:
        raise InvalidQuantity(f"solids() of {name} failed: {error}") from error
    if not isinstance(solids, tuple) or len(solids) not in (1, 2) or not all(isinstance(one, Solid) for one in solids):
        needed = "a tuple of a Solid, or of the outer and the inner one of a hollow body"
        raise InvalidQuantity(f"solids() of {name} returned {solids!r:.60}; needed: {needed}")
    return solids


@dataclass(frozen=True)
class _Embedded:
    """The outer body of an inclusion in a block of a size, with the inclusion's name and whether it is hollow."""

    name: str
    body: Solid
    size: Array
    hollow: bool

    @cached_property
    def samples(self) -> Array:
        """Points (n, 3) on the surface of the body in the block."""
        extent = float(np.ptp(self.body.bounds(), axis=0).max())
        vertices, triangles = self.body.triangles(extent / SAMPLES_ACROSS)
        points = np.vstack([vertices, vertices[triangles].mean(axis=1)])
        within = ((points >= 0) & (points <= self.size)).all(axis=1)
        return points[within] if within.any() else points


def _check_extent(body: Solid, size: Array, name: str) -> None:
    extent = np.ptp(body.bounds(), axis=0)
    if extent.min() < SMALLEST * size.min():
        small, least = format_quantity(float(extent.min()), "m"), format_quantity(float(SMALLEST * size.min()), "m")
        raise InvalidQuantity(f"{name} measures only {small}; allowed: at least {least} in this block; is its unit right?")
    if extent.min() > size.max():
        large, most = format_quantity(float(extent.min()), "m"), format_quantity(float(size.max()), "m")
        raise InvalidQuantity(f"{name} measures {large}; allowed: less than the block, {most}; is its unit right?")


def _check_apart(first: _Embedded, second: _Embedded, gap: float) -> None:
    """Refuse two bodies that are nearer than ``gap`` in m."""
    for one, other in ((first, second), (second, first)):
        distance = one.body.signed_distance(other.samples)
        if distance.max() < 0:
            where = "beside" if one.hollow else "outside"
            raise InvalidQuantity(f"{other.name} lies inside {one.name}; allowed: inclusions {where} each other")
        if distance.min() < gap:
            apart = _apart(one.body, other.body, other.samples[distance.argmin()])
            nearest, allowed = format_quantity(abs(apart), "m"), format_quantity(gap, "m")
            how = f"overlap by {nearest}" if apart < 0 else f"are {nearest} apart"
            raise InvalidQuantity(f"{one.name} and {other.name} {how}; allowed: at least {allowed} between inclusions")


def _apart(one: Solid, other: Solid, start: Array) -> float:
    """Distance in m between two bodies, or, below zero, how far they must move apart to touch; convex ones, others from near.

    The least sum of the distances of a point (3,) from both, which is convex if the bodies are; ``start`` lies near it.
    """
    from scipy.optimize import minimize

    extent = float(np.ptp(one.bounds(), axis=0).max())

    def both(place: Array) -> float:
        return sum(float(body.signed_distance((start + extent * place)[None])[0]) for body in (one, other)) / extent

    least = minimize(both, np.zeros(3), method="Nelder-Mead", options={"xatol": FOUND, "fatol": FOUND}).fun
    return extent * round(float(least) / FOUND) * FOUND
