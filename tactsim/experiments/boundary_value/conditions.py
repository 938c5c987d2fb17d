"""What is prescribed of a body: displacements, rotations, pressures, tractions and forces of faces, weight, and rigid bodies."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from tactsim.contact.any_law import AnyLaw
from tactsim.contact.coulomb import Coulomb
from tactsim.errors import InvalidQuantity, shown
from tactsim.interfaces import RigidBody
from tactsim.mechanics.paths.loading import Loading, pieces_of
from tactsim.model import FrozenModel
from tactsim.registry import Registered
from tactsim.units import Angle, Force, ForcePerVolume, Length, Pressure, format_quantity, parse_quantity

AnyBody: Any = Annotated[RigidBody, Registered(RigidBody)]


class Amplitude(Loading):
    """Factor over time by which a condition is multiplied, one piece after the other, from zero."""

    pieces: pieces_of(float, "Factor", __name__)  # type: ignore[valid-type]
    """Ramps, jumps, holds, sines or samples of the factor; 1 is the condition as it is written."""


Within = dict[str, tuple[Length, Length]]
"""Two values of some coordinates, by their names."""


def within_in_words(within: Within) -> str:
    """The part between two values of each coordinate, such as ``z from 0 m to 9 mm``."""
    return ", ".join(f"{name} from {' to '.join(format_quantity(end, 'm') for end in ends)}" for name, ends in within.items())


class Condition(FrozenModel):
    """Something prescribed that follows a course in time."""

    amplitude: Amplitude | None = None
    """Course in time; by default that of the whole problem."""

    @property
    def varies(self) -> bool:
        """Whether it prescribes anything but zero, so that its course in time matters."""
        slopes = (slope for along in getattr(self, "slopes", {}).values() for slope in along.values())
        return any((*(getattr(self, name, None) for name in ("x", "y", "z", "r", "angle", "pressure")), *slopes))


class FaceCondition(Condition):
    """Something prescribed on a face or on a part of it."""

    face: str
    """Name of the face, as the geometry has it."""
    within: Within | None = None
    """The part of the face between two values of a coordinate, such as ``{r: [0 mm, 1 mm]}``; by default all of it.

    A round body has the distance ``r`` from its axis in 3D and in plane strain, too."""


class Components(FrozenModel):
    """Components of a vector; those that are not given are left free; those of a traction or a force are zero."""

    def along(self, axes: tuple[str, ...]) -> dict[int, float]:
        """Number of the axis -> component in SI, of those that are given.

        Raises
        ------
        ValueError
            If a component is given that the problem does not have, or none is given.
        """
        given = {name: getattr(self, name) for name in ("x", "y", "z", "r") if getattr(self, name) is not None}
        if unknown := [name for name in given if name not in axes]:
            raise ValueError(f"there is no component {', '.join(unknown)}; allowed: {', '.join(axes)}")
        if not given:
            raise ValueError(f"no component is given; allowed: {', '.join(axes)}")
        return {axes.index(name): value for name, value in given.items()}

    def vector(self, axes: tuple[str, ...]) -> list[float]:
        """All components in SI, zero where none is given.

        Raises
        ------
        ValueError
            As ``along`` does.
        """
        given = self.along(axes)
        return [given.get(axis, 0.0) for axis in range(len(axes))]


class Displacement(Components):
    """Components of a displacement."""

    x: Length | None = None
    """Displacement along x; free if not given."""
    y: Length | None = None
    """Displacement along y; free if not given."""
    z: Length | None = None
    """Displacement along z; free if not given."""
    r: Length | None = None
    """Radial displacement of an axisymmetric body; free if not given."""


class DisplacementCondition(FaceCondition, Displacement):
    """Prescribed components of the displacement of a face, the same everywhere or linear in the undeformed coordinates.

    With the same linear displacements on every face but those across it, a block is sheared or stretched evenly.
    """

    kind: Literal["displacement"]
    slopes: dict[str, dict[str, float]] = {}
    """By how much a given component grows per length along a coordinate, such as ``x: {y: 0.5}``; the component itself is then
    that of a point at the origin."""

    def slopes_along(self, axes: tuple[str, ...]) -> dict[int, list[float]]:
        """Number of the axis -> slopes along all coordinates, of every given component.

        Raises
        ------
        ValueError
            As ``along`` does, or if a slope is that of a component that is not given, or along no coordinate; the message begins
            with its key.
        """
        given = self.along(axes)
        for name, slopes in self.slopes.items():
            if name not in axes or axes.index(name) not in given:
                raise ValueError(f"slopes.{name}: the component {name} is not given; give it, too: that of a point at the origin")
            if unknown := [along for along in slopes if along not in axes]:
                raise ValueError(f"slopes.{name}: there is no coordinate {', '.join(unknown)}; allowed: {', '.join(axes)}")
        return {axis: [self.slopes.get(axes[axis], {}).get(name, 0.0) for name in axes] for axis in given}


class ClampCondition(FaceCondition):
    """No displacement of a face."""

    kind: Literal["clamped"]


class PointCondition(Condition, Displacement):
    """Prescribed components of the displacement of the node of the mesh at a point."""

    kind: Literal["point"]
    at: tuple[Length, ...]
    """Undeformed coordinates of the point."""


class RotationCondition(FaceCondition):
    """A face that turns about an axis along z, its shape in the plane kept or free to change; in 3D it is held along z, or free.

    In plane strain the axis stands on the plane: two faces that turn against each other bend the body between them. On an
    axisymmetric body a face of the section turns in the plane of r and z, such as half a turn of both ends of a tube everts it.
    """

    kind: Literal["rotation"]
    angle: Angle
    """Angle, right-handed; from r towards z on an axisymmetric body."""
    axial: Literal["held", "free"] = "held"
    """Whether in 3D the points of the face keep their heights, as if glued to a rigid plate, or each moves freely along z."""
    about: tuple[Length, Length] = (0.0, 0.0)
    """Coordinates x and y of the axis, such as the middle of a block, which has a corner at the origin; r and z on an
    axisymmetric body."""
    sliding: Literal["none", "in_plane", "radial"] = "none"
    """How the points of the face may move on what turns them: not at all, as if glued to a rigid plate; without friction in the
    plane of the face, which must be flat, so that the ends of a bent strip may thin; or towards the axis and away from it, each
    at its angle, so that a tube may widen as it is twisted."""


class PressureCondition(FaceCondition):
    """A pressure on a face, pushing into the body."""

    kind: Literal["pressure"]
    pressure: Pressure
    """Pressure; negative pulls."""
    follows: bool = True
    """Whether it follows the deformed face; a dead one keeps direction and size as on the undeformed face."""


class TractionCondition(FaceCondition, Components):
    """A dead traction: force per undeformed area of a face, in a fixed direction."""

    kind: Literal["traction"]
    x: Pressure | None = None
    """Component along x."""
    y: Pressure | None = None
    """Component along y."""
    z: Pressure | None = None
    """Component along z."""
    r: Pressure | None = None
    """Radial component on an axisymmetric body."""


class ForceCondition(FaceCondition, Components):
    """A dead force spread evenly over the undeformed area of a face; per metre of depth in plane strain."""

    kind: Literal["force"]
    x: Force | None = None
    """Component along x."""
    y: Force | None = None
    """Component along y."""
    z: Force | None = None
    """Component along z."""
    r: Force | None = None
    """Radial component on an axisymmetric body, the sum around the axis."""

    @field_validator("x", "y", "z", "r", mode="before")
    @classmethod
    def _of_a_metre(cls, value: Any) -> Any:
        if isinstance(value, str):
            with suppress(InvalidQuantity):
                parse_quantity(value, "N/m")
                raise ValueError(
                    f"{shown(value)} is a force per length; needed: a force, in plane strain that of a metre of depth"
                )
        return value


class BodyForceCondition(Condition, Components):
    """A dead force on the whole body per undeformed volume, such as its weight."""

    kind: Literal["body_force"]
    x: ForcePerVolume | None = None
    """Component along x."""
    y: ForcePerVolume | None = None
    """Component along y."""
    z: ForcePerVolume | None = None
    """Component along z; a weight has minus the density times 9.81 m/s^2."""
    r: ForcePerVolume | None = None
    """Radial component on an axisymmetric body."""


AnyCondition = Annotated[
    DisplacementCondition
    | ClampCondition
    | PointCondition
    | RotationCondition
    | PressureCondition
    | TractionCondition
    | ForceCondition
    | BodyForceCondition,
    Field(discriminator="kind"),
]
Side = Literal["left", "right", "bottom", "top", "front", "back"]
SIDES: Mapping[str, Mapping[str, tuple[float, ...]]] = {
    "3d": {
        "left": (-1.0, 0.0, 0.0),
        "right": (1.0, 0.0, 0.0),
        "front": (0.0, -1.0, 0.0),
        "back": (0.0, 1.0, 0.0),
        "bottom": (0.0, 0.0, -1.0),
        "top": (0.0, 0.0, 1.0),
    },
    "plane_strain": {"left": (-1.0, 0.0), "right": (1.0, 0.0), "bottom": (0.0, -1.0), "top": (0.0, 1.0)},
    "axisymmetric": {"bottom": (0.0, -1.0), "top": (0.0, 1.0)},
}
"""Unit vector from the tissue to a body that comes from a side, by the dimension."""


class Motion(Condition, Displacement):
    """A displacement of a rigid body with its own course in time."""


class ContactCondition(FaceCondition, Displacement):
    """A rigid body that touches a face; it begins at first touch, and moves by the displacement whose components are given."""

    body: AnyBody
    """The body; its axis points away from the tissue."""
    law: AnyLaw = Coulomb(friction=0.0)
    """Friction."""
    side: Side
    """Side from which it comes."""
    at: tuple[Length, ...] | None = None
    """Where its axis meets the body, in undeformed coordinates; by default the origin, which is on the axis of a round body and a
    corner of a block, whose middle is at half its size. A plane needs none."""
    motions: tuple[Motion, ...] = ()
    """Further displacements that are added to it, such as one that slides after the body was pressed."""

    @property
    def moving(self) -> dict[str, ContactCondition | Motion]:
        """Every displacement that it is given by the beginning of its key, its own first; none of a body that stands still."""
        given = any(component is not None for component in (self.x, self.y, self.z, self.r))
        own: dict[str, ContactCondition | Motion] = {"": self} if given else {}
        return own | {f"motions.{number}.": motion for number, motion in enumerate(self.motions)}
