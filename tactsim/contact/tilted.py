"""A rigid body turned about its reference point."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from tactsim.array import Array
from tactsim.contact.annulus import Annulus
from tactsim.contact.own_axes import BodyInOwnAxes
from tactsim.contact.tilt import Tilt, tilt_matrix
from tactsim.interfaces import RigidBody
from tactsim.registry import Registered

TiltableBody = Annotated[RigidBody, Registered(RigidBody, lambda cls: {2, 3} <= set(cls.dimensions))]
"""Any body that is defined both by its section and in 3D, which makes it a body of revolution."""


class Tilted(BodyInOwnAxes):
    """A body of revolution whose axis leans; its reference point, the middle of its face, stays at the origin."""

    dimensions: ClassVar[tuple[int, ...]] = (3,)
    kind: Literal["tilted"] = "tilted"
    body: TiltableBody
    """The body that is turned."""
    tilt_x: Tilt = 0.0
    """Rotation about the x axis, right-handed, before that about y."""
    tilt_y: Tilt = 0.0
    """Rotation about the y axis."""

    @classmethod
    def example(cls) -> Self:
        """The sensor of chapter 3, held a little askew."""
        return cls(body=Annulus.example(), tilt_x=0.05, tilt_y=-0.03)

    @property
    def rotation(self) -> Array:
        """Matrix (3, 3) that turns the body's own axes into those of the tissue."""
        return tilt_matrix(self.tilt_x, self.tilt_y)

    def own_coordinates(self, x: Array) -> Array:
        """Points (3, n) in m in the body's own axes, of which the third is that of its revolution."""
        return self.rotation.T @ x
