"""A boundary value problem of a body of one material."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, StringConstraints, model_validator

from tactsim.experiments.boundary_value.asked import AnyAsked, AskedForce, AskedStress
from tactsim.experiments.boundary_value.conditions import (
    SIDES,
    Amplitude,
    AnyCondition,
    ClampCondition,
    ContactCondition,
    DisplacementCondition,
    RotationCondition,
)
from tactsim.experiments.boundary_value.geometry import AXES, AnyGeometry, BlockGeometry, Dimension, Span
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mechanics.step_policy import TimeSettings
from tactsim.units import Length, format_quantity

AskedName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
RECORDED = {
    "time": "s",
    "min_volume_ratio": "1",
    "unstable_volume_fraction": "1",
    "poor_volume_fraction": "1",
    "penetration_force_error": "1",
    "max_penetration": "m",
}
"""Units of what every step records beside what is asked for."""
PENETRATION_SHARE = 1e-6
"""Largest penetration over the body's size, if a case gives none."""


def _history_units(problem: BoundaryValueProblem) -> dict[str, str]:
    """Unit of every value that a step records."""
    return RECORDED | {name: one.unit for name, one in problem.asked.items()}


def ramp() -> Amplitude:
    """From zero to one within a second."""
    return Amplitude.model_validate({"pieces": [{"kind": "ramp", "to": 1.0, "duration": 1.0}]})


class BoundaryValueProblem(Experiment):
    """A body of a simple shape under what is prescribed on its faces, and the numbers that are asked of it."""

    kind: Literal["boundary_value_problem"] = "boundary_value_problem"
    dimension: Dimension
    """A body in space, a long one in plane strain, or one of revolution about z."""
    geometry: AnyGeometry
    """Shape and mesh of the body."""
    material: AnyMaterial
    """What it is made of; linear elastic, hyperelastic, compressible or not, relaxing or not."""
    conditions: tuple[AnyCondition, ...] = ()
    """What is prescribed on its faces; a face without a condition is free."""
    contacts: tuple[ContactCondition, ...] = ()
    """Rigid bodies that touch it."""
    amplitude: Amplitude = Field(default_factory=ramp)
    """Factor over time by which every condition without an amplitude of its own is multiplied; by default it rises evenly from
    0 to 1 within a second."""
    asked: Annotated[dict[AskedName, AnyAsked], Field(min_length=1)]
    """Name -> number that is asked for."""
    steps: Annotated[int, Field(ge=1, le=10_000)] = 10
    """Least number of steps of a ramp, and per period of a sine."""
    time: TimeSettings = TimeSettings()
    """Steps of time of a material that relaxes."""
    penetration_tolerance: Annotated[Length, Field(ge=1e-12)] | None = None
    """Largest penetration of a rigid body; by default a millionth of the body's size."""

    # The units follow from what is asked for, so that they replace the fixed ones of the interface.
    history_units: ClassVar[Any] = property(_history_units)  # type: ignore[misc]

    @classmethod
    def example(cls) -> Self:
        """A block of rubber between glued plates, sheared by half its height in plane strain."""
        span = (Span(length=10e-3, cells=4),)
        return cls(
            dimension="plane_strain",
            geometry=BlockGeometry(x=span, y=span),
            material=MooneyRivlin2(c10=1e5, c01=0.25e5),
            conditions=(
                ClampCondition(kind="clamped", face="bottom"),
                DisplacementCondition(kind="displacement", face="top", x=5e-3, y=0.0),
            ),
            asked={
                "shear_force": AskedForce(kind="force", face="top", component="x"),
                "shear_stress": AskedStress(kind="stress", at=(5e-3, 5e-3), component="xy"),
            },
        )

    def begin(self) -> Course:
        """Follow the amplitudes to their end."""
        from tactsim.experiments.boundary_value.record import boundary_value_course

        return boundary_value_course(self)

    @property
    def duration(self) -> float:
        """Time in s until the last amplitude ends."""
        given = [one.amplitude for one in (*self.conditions, *self.contacts) if one.amplitude is not None]
        return max(amplitude.duration for amplitude in (self.amplitude, *given))

    @property
    def extent(self) -> tuple[str, float]:
        """The time."""
        return "time", self.duration

    def largest_penetration(self, size: float) -> float:
        """Largest penetration in m that is allowed, of a body of this size in m."""
        return self.penetration_tolerance or PENETRATION_SHARE * size

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        axes = AXES[self.dimension]
        for condition in (*self.conditions, *self.contacts):
            if isinstance(condition, RotationCondition) and self.dimension != "3d":
                raise ValueError("a face turns about z in 3d only")
            if isinstance(condition, ContactCondition):
                self._check_contact(condition, axes)
            elif hasattr(condition, "along"):
                condition.along(axes)
        for name, one in self.asked.items():
            if name in RECORDED:
                raise ValueError(f"asked.{name}: every step records this already; take another name")
            component = getattr(one, "component", None)
            if component in ("x", "y", "z", "r") and component not in axes:
                raise ValueError(f"asked.{name}: there is no component {component}; allowed: {', '.join(axes)}")
            if one.kind == "torque" and self.dimension != "3d":
                raise ValueError(f"asked.{name}: a torque about z is asked of a body in 3d only")
            if one.kind == "contact_force" and one.contact > len(self.contacts):
                raise ValueError(f"asked.{name}: there are {len(self.contacts)} contacts, none is number {one.contact}")
            if one.time is not None and one.time > self.duration * (1 + 1e-9):
                given, end = format_quantity(one.time, "s"), format_quantity(self.duration, "s")
                raise ValueError(f"asked.{name}: the time {given} lies after the end at {end}")
        return self

    def _check_contact(self, condition: ContactCondition, axes: tuple[str, ...]) -> None:
        if len(axes) not in condition.body.dimensions:
            raise ValueError(f"a {condition.body.kind} is not defined in {self.dimension}")
        if condition.side not in SIDES[self.dimension]:
            raise ValueError(
                f"no body comes from the {condition.side} in {self.dimension}; allowed: {', '.join(SIDES[self.dimension])}"
            )
        if condition.at is not None and len(condition.at) != len(axes):
            raise ValueError(f"at of a contact needs {len(axes)} coordinates: {', '.join(axes)}")
        if condition.moves:
            condition.along(axes)
