"""When Newton's method stops, and when it gives up."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class NewtonOptions:
    """Tolerance and patience."""

    tolerance: float = 1e-10
    """Largest residual over the largest nodal force (not below round-off), and over the mean nodal volume."""
    max_iterations: int = 25
    smallest_damping: float = 1 / 256
    search_halvings: int = 5
    """How often a step is halved at most because of the unbalanced forces that it leaves."""
    patience: int = 8
    """Newton gives up when this many iterations in a row have not halved the smallest residual before them."""
    start_patience: int | None = None
    """Newton gives up when the first so many iterations have not halved the residual: a shorter load step is cheaper. None means
    ``patience`` alone."""
    most_halvings: int = 10
    """Newton gives up when it has halved its steps so often in all: a shorter load step is cheaper."""
    largest_inexactness: float = 1e-2
    """Largest error of a linear step over its size, of a solver that iterates; nearer to equilibrium it is less anyway."""
    volume_floor: float = 0.2
    """A step is shortened until no J falls below this part of the smallest J before it."""
    polished: float = 0.1
    """Residual below which steps with the last factor of a direct solver follow a step; zero leaves every step to a new tangent.

    Near the solution the contact no longer changes, and an old tangent is good enough: such a step costs a quarter of one with a
    new tangent in a section of 10 000 unknowns (modified Newton; Kelley 1995, doi:10.1137/1.9781611970944, section 5.4).
    One that does not pay is known by its residual and dropped, so that the factor may be that of the solution before."""
