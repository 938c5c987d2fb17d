"""What an indentation reports beside quantities and history: the body, its height at first touch, the inner sensor."""

from __future__ import annotations

from typing import Annotated, Literal

from tactsim.contact.tilted import Tilted
from tactsim.interfaces import RigidBody
from tactsim.model import FrozenModel
from tactsim.registry import Registered
from tactsim.results.scene import Scene, SolverReport


class PressedBodyScene(Scene):
    """A rigid body on tissue."""

    body: Annotated[RigidBody, Registered(RigidBody)]
    """The body."""
    starting_height: float
    """Height in m of its reference point at first touch, above the undeformed surface."""
    recess: float | None
    """Depth in m of the inner sensor below the face of an annulus; null without one."""
    solver: SolverReport
    """What the solution took."""

    @property
    def disc_share(self) -> float:
        """Area of the body's face over that of the full disc."""
        shape = self.body.contact_shape
        return 1 - (shape.hole / shape.reach) ** 2


class ContactProfile(FrozenModel):
    """The contact pressure on every edge of an element at the tissue's surface, from the axis outwards."""

    radius: tuple[float, ...]
    """Mean deformed radius in m."""
    pressure: tuple[float, ...]
    """Mean force per undeformed area in Pa; from point to point within an edge it varies more than the mesh resolves."""
    area: tuple[float, ...]
    """Undeformed area in m^2 that the edge sweeps."""


class IndentationScene(PressedBodyScene):
    """An elastic indentation of a section."""

    kind: Literal["indentation"] = "indentation"
    contact: ContactProfile | None = None
    """Of the body, and of the inner sensor once the tissue has reached it, at the last kept state; null where nothing touches."""


class TimedIndentationScene(PressedBodyScene):
    """An indentation of a section over time."""

    kind: Literal["timed_indentation"] = "timed_indentation"
    control: Literal["displacement", "force"]
    """What is prescribed."""
    compare: Literal["half_space", "layer"] | None
    """The closed form that it is compared with."""


class Indentation3dScene(PressedBodyScene):
    """An indentation in three dimensions."""

    kind: Literal["indentation_3d"] = "indentation_3d"
    body: Tilted
    """The body as it leans."""
    symmetry: Literal["quarter", "half", "whole"]
    """Part of the specimen that was computed."""
    offset: float
    """Distance in m of the body from the axis of the specimen, along x."""
