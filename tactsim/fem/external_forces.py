"""What Newton asks of forces on a body that depend on its displacement."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from tactsim.fem.surface import SurfaceAssembly

Array = np.ndarray


class Interface(Protocol):
    """Forces at the points of one surface that depend on where the points are, and on forces carried by Newton's iterate."""

    @property
    def surface(self) -> SurfaceAssembly:
        """The surface that the forces act on."""

    def start(self) -> Any:
        """The carried forces at the beginning."""

    def settled(self, displacement: Array) -> Any:
        """The carried forces that hold at displacements (d, n) of the points."""

    def converged(self, displacement: Array) -> Array:
        """Traction (d, n) in Pa that holds at displacements (d, n) of the points."""

    def rounding(self, displacement: Array) -> Array:
        """Traction (n,) in Pa that is lost in the round-off of the positions."""

    def linearised(self, displacement: Array, carried: Any) -> Any:
        """An object with ``traction`` (d, n) in Pa, ``derivative`` (d, d, n) in Pa/m, and ``coupling``, the part of the
        derivative without which it is symmetric but for curvature."""

    def advanced(self, now: Any, carried: Any, step: Array, damping: float) -> Any:
        """The carried forces after the points moved by ``damping * step``."""


class FollowerLoad(Protocol):
    """Nodal forces that depend on the displacement of the surface they act on."""

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at nodal displacements (n, d)."""

    def stiffness(self, displacement: Array) -> Array:
        """Tangent entries, minus the derivative of the force."""
