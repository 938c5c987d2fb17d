"""What Newton asks of forces on a body that depend on its displacement."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar

from tactsim.array import Array
from tactsim.fem.assembly.body_part import BodyPart
from tactsim.fem.assembly.surface import SurfaceAssembly


class LinearisedTraction(Protocol):
    """Traction at the n points of a surface and its derivative with respect to their positions."""

    @property
    def traction(self) -> Array:
        """Traction (d, n) in Pa."""

    @property
    def derivative(self) -> Array:
        """Derivative (d, d, n) in Pa/m."""

    @property
    def coupling(self) -> Array:
        """The part (d, d, n) of the derivative in Pa/m without which it is symmetric but for curvature."""


class LinearisedContact(LinearisedTraction, Protocol):
    """The linearised traction of a rigid body that may be apart from the surface."""

    @property
    def gap(self) -> Array:
        """Gap (n,) in m, negative where the body is penetrated."""

    @property
    def points(self) -> Array:
        """Positions (d, n) in m in the frame of the body."""


Iterate = TypeVar("Iterate")
Now = TypeVar("Now", bound=LinearisedTraction)


class Interface(Protocol[Iterate, Now]):
    """Forces at the points of one surface that depend on where the points are, and on forces that Newton iterates as unknowns."""

    @property
    def surface(self) -> SurfaceAssembly:
        """The surface that the forces act on."""

    def of_part(self, surface: SurfaceAssembly, points: Array) -> Interface[Iterate, Now]:
        """The same forces on a part of the surface, of which the ``points`` (m,) are these."""

    def start(self) -> Iterate:
        """The iterated forces at the beginning."""

    def iterate_at(self, displacement: Array) -> Iterate:
        """The iterated forces in equilibrium with displacements (d, n) of the points."""

    def converged(self, displacement: Array) -> Array:
        """Traction (d, n) in Pa in equilibrium with displacements (d, n) of the points."""

    def rounding(self, displacement: Array) -> Array:
        """Traction (n,) in Pa that is lost in the round-off of the positions."""

    def linearised(self, displacement: Array, iterate: Iterate) -> Now:
        """Traction and derivative at displacements (d, n), as the iterated forces decide the state of each point."""

    def advanced(self, now: Now, iterate: Iterate, step: Array, damping: float) -> Iterate:
        """The iterated forces after the points moved by ``damping``, a share, of a ``step`` (d, n) in m."""


AnyInterface = Interface[Any, Any]
"""An interface whatever forces it iterates: Newton only hands them back to it."""


class FollowerLoad(Protocol):
    """Nodal forces that depend on the displacement of the surface they act on."""

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at nodal displacements (n, d)."""

    def add_stiffness(self, data: Array, displacement: Array) -> None:
        """Add minus the derivative of the force at displacements (n, d) to the entries ``data`` (nnz,) of the body's tangent."""

    def of_part(self, part: BodyPart) -> FollowerLoad:
        """The same load on a part of the body, as the share that the part bears of it."""
