"""What is asked of a boundary value problem: displacements and stresses at points, forces on faces, energy, volume."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tactsim.experiments.boundary_value.geometry import Dimension
from tactsim.model import FrozenModel
from tactsim.units import Length, NonNegative, Time, format_quantity

CARTESIAN = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "yz": (1, 2), "xz": (0, 2)}
AXISYMMETRIC = {"rr": (0, 0), "radial": (0, 0), "zz": (1, 1), "rz": (0, 1), "hoop": (2, 2)}
"""Entries of the stress by the component's name; on an axisymmetric body its rows are r, z and hoop."""
PER_DEPTH = {"N": "N/m", "N*m": "N*m/m", "J": "J/m", "m^3": "m^2"}
"""Unit of what a whole body has -> that of a metre of the depth of one in plane strain."""
StressComponent = Literal["xx", "yy", "zz", "xy", "yz", "xz", "rr", "rz", "radial", "hoop", "von_mises", "mean"]


class Asked(FrozenModel):
    """A number that is asked for: recorded at every step, reported at one time."""

    time: NonNegative[Time] | None = None
    """When; by default at the end."""
    factor: float = 1.0
    """What the number is multiplied by, such as 4 for the force on a quarter of a body."""


class AskedDisplacement(Asked):
    """A component of the displacement of a point."""

    kind: Literal["displacement"]
    at: tuple[Length, ...]
    """Undeformed coordinates of the point."""
    component: Literal["x", "y", "z", "r"]
    """Along which axis."""

    unit: ClassVar[str] = "m"
    """Metres."""

    @property
    def words(self) -> str:
        """What it is."""
        return f"displacement along {self.component} of the point {place_in_words(self.at)}"


class AskedStress(Asked):
    """A component of the Cauchy stress at a point, tension positive.

    ``radial`` and ``hoop`` are taken about the z axis, at the deformed place of the point; ``mean`` is a third of the trace.
    """

    kind: Literal["stress"]
    at: tuple[Length, ...]
    """Undeformed coordinates of the point."""
    component: StressComponent
    """Which one."""

    unit: ClassVar[str] = "Pa"
    """Pascal."""

    def entries(self, dimension: str) -> dict[str, tuple[int, int]]:
        """Row and column of every component that is an entry of the stress in a dimension.

        Raises
        ------
        ValueError
            If the component is none and does not follow from them at the point; the message begins with its key.
        """
        entries = AXISYMMETRIC if dimension == "axisymmetric" else CARTESIAN
        around = ("radial", "hoop") if any(self.at[:2]) else ()
        if self.component not in (*entries, "von_mises", "mean", *around):
            raise ValueError(
                f"component: there is no {self.component} stress at this point in {dimension}; "
                f"allowed: {', '.join(dict.fromkeys((*entries, *around, 'von_mises', 'mean')))}"
            )
        return entries

    @property
    def words(self) -> str:
        """What it is."""
        return f"Cauchy stress ({self.component}) at the point {place_in_words(self.at)}"


class AskedForce(Asked):
    """A component of what acts on a face from outside, of the part that is computed; all faces together balance,
    or balance the forces per volume.

    Pressures, tractions, forces and rigid bodies on the face, and the reaction to the displacements that are prescribed on it. Of
    an edge whose displacement several faces prescribe each takes an equal part; of a point, each face through it.
    """

    kind: Literal["force"]
    face: str
    """Name of the face."""
    component: Literal["x", "y", "z", "r"]
    """Along which axis."""

    unit: ClassVar[str] = "N"
    """Newton; N/m in plane strain."""

    @property
    def words(self) -> str:
        """What it is."""
        return f"force along {self.component} that acts on the face {self.face}"


class AskedTorque(Asked):
    """Moment about the z axis of what acts on a face from outside: of the same forces as those of ``force``.

    In plane strain the axis stands on the plane at the origin.
    """

    kind: Literal["torque"]
    face: str
    """Name of the face."""

    unit: ClassVar[str] = "N*m"
    """Newton metre; N*m/m in plane strain."""

    @property
    def words(self) -> str:
        """What it is."""
        return f"moment about z of what acts on the face {self.face}"


class AskedContactForce(Asked):
    """A component of the force of a rigid body on the part that is computed."""

    kind: Literal["contact_force"]
    contact: Annotated[int, Field(ge=1)] = 1
    """Which of the contacts, counted from one."""
    component: Literal["x", "y", "z", "r"]
    """Along which axis."""

    unit: ClassVar[str] = "N"
    """Newton; N/m in plane strain."""

    @property
    def words(self) -> str:
        """What it is."""
        return f"force along {self.component} of the rigid body {self.contact}"


class AskedEnergy(Asked):
    """Energy that the part computed would still store after full relaxation: without what fades.

    The energy of the volume change is that of the pressure, p^2 / (2 K), as the mixed form has it.
    """

    kind: Literal["energy"]

    unit: ClassVar[str] = "J"
    """Joule; J/m in plane strain."""

    @property
    def words(self) -> str:
        """What it is."""
        return "stored energy of the part that is computed"


class AskedVolume(Asked):
    """Deformed volume of the part that is computed."""

    kind: Literal["volume"]

    unit: ClassVar[str] = "m^3"
    """Cubic metres; m^2 in plane strain."""

    @property
    def words(self) -> str:
        """What it is."""
        return "deformed volume of the part that is computed"


AnyAsked = Annotated[
    AskedDisplacement | AskedStress | AskedForce | AskedTorque | AskedContactForce | AskedEnergy | AskedVolume,
    Field(discriminator="kind"),
]


def unit_of(asked: AnyAsked, dimension: Dimension) -> str:
    """SI unit of a number that is asked for; in plane strain per metre of depth."""
    return PER_DEPTH.get(asked.unit, asked.unit) if dimension == "plane_strain" else asked.unit


def place_in_words(place: Sequence[float]) -> str:
    """Coordinates in m with units."""
    return f"({', '.join(format_quantity(value, 'm') for value in place)})"
