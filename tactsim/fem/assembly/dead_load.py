"""Tractions that keep their direction and their size per reference area, whatever the body does."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.surface import SurfaceAssembly


class DeadTraction:
    """A traction (d, n) in Pa of the reference area at the points of a surface: a dead load.

    Its resultant is what a force in N is that the surface bears from the beginning; on an axisymmetric body the radial
    components push outwards all around.
    """

    def __init__(self, surface: SurfaceAssembly, traction: Array, entries: int):
        self._force, self._entries = surface.force(traction), entries

    def at(self, factor: float) -> FactoredLoad:
        """The same traction times a factor."""
        return FactoredLoad(factor * self._force, self._entries)


class FactoredLoad:
    """Nodal forces (size,) in N that no displacement changes."""

    def __init__(self, force: Array, entries: int):
        self._force, self._entries = force, entries

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at any displacements."""
        return self._force

    def stiffness(self, displacement: Array) -> Array:
        """Tangent entries: none."""
        return np.zeros(self._entries)
