"""When Newton's method stops, and when it gives up."""

from __future__ import annotations

from dataclasses import dataclass

FORCING = 0.5
"""Error of a linear step over its size, over the residual that it starts from. In proportion to the residual it leaves Newton
quadratic (Dembo, Eisenstat & Steihaug 1982, doi:10.1137/0719025). Direct solvers are exact anyway."""
SHARE_OF_GOAL = 0.1
"""Part of the residual at which Newton stops that the error of the last linear step may leave."""


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
    last_inexactness: float = 0.05
    """The same of the step that may be the last, for which a share of the residual at which Newton stops suffices.

    Why more: between augmentations, and with a coarse balance, one step leads there from ten times that residual, and a few
    percent of its size are all that it has to be right to. Forty grasps of lumps took a tenth fewer solutions with the factor.
    Twice as much would pass for the answer of a singular system."""
    volume_floor: float = 0.2
    """A step is shortened until no J falls below this part of the smallest J before it."""
    polished: float = 0.1
    """Residual below which steps with the last factor of a direct solver follow a step; zero leaves every step to a new tangent.

    Near the solution the contact no longer changes, and an old tangent is good enough: such a step costs a quarter of one with a
    new tangent in a section of 10 000 unknowns (modified Newton; Kelley 1995, doi:10.1137/1.9781611970944, section 5.4).
    One that does not pay is known by its residual and dropped, so that the factor may be that of the solution before."""

    def inexactness(self, residual: float, goal: float, *, bordered: bool = False) -> float:
        """Error over its size that the linear step from a ``residual`` may have, if Newton stops at one of ``goal``.

        A ``bordered`` step, of which the difference of two solutions is left, has no errors to give away at its end.
        """
        last = self.largest_inexactness if bordered else self.last_inexactness
        on_the_way = min(FORCING * residual, self.largest_inexactness)
        return max(on_the_way, min(SHARE_OF_GOAL * goal / residual, last))
