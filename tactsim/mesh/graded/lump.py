"""A sphere or an ellipsoid in a block, as graded cells see it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import BallImage


@dataclass(frozen=True)
class Lump:
    """A ball and its bounds (2, 3) in m."""

    ball: BallImage
    bounds: Array

    @property
    def half(self) -> Array:
        """Half widths (3,) in m."""
        return np.asarray(np.diff(self.bounds, axis=0)[0] / 2)

    @property
    def center(self) -> Array:
        """Its middle (3,) in m."""
        return self.ball.center

    def moved(self, displacement: Array) -> Lump:
        """The same, moved by a displacement (3,) in m."""
        return Lump(replace(self.ball, center=self.ball.center + displacement), self.bounds + displacement)
