"""What a specimen and its mesh must know of the part of a rigid body that touches."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class RoundTip:
    """A tip without edges, around which the contact grows with the depth.

    Attributes
    ----------
    elements : along the radius of the contact, where they are finest
    within_radius : whether the contact stays within one and a half radii of the body
    """

    elements: int
    within_radius: bool = False


@dataclass(frozen=True)
class ContactShape:
    """Lengths in m.

    Attributes
    ----------
    radius : of the part that touches, by which the body is measured; None if it reaches beyond any specimen
    hole : radius of a hole in its middle
    fillet : radius of the rounding of its edges
    tip : how a body without edges ends; None if it has a face
    radii : by the names that a case gives them, for messages
    """

    radius: float | None = None
    hole: float = 0.0
    fillet: float | None = None
    tip: RoundTip | None = None
    radii: Mapping[str, float] = field(default_factory=dict)

    @property
    def reach(self) -> float:
        """The radius in m, infinite where there is none."""
        return math.inf if self.radius is None else self.radius

    @property
    def flat(self) -> bool:
        """Whether a disc or ring of this radius touches, whatever the depth."""
        return self.radius is not None and self.tip is None
