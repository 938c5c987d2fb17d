"""What a boundary value problem is given: the fields of its case, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Self

import numpy as np
from pydantic import Field, StringConstraints, model_validator

from tactsim.contact.traction import ContactPair
from tactsim.errors import InputError
from tactsim.experiments.boundary_value.asked import AnyAsked, AskedDisplacement, AskedForce, AskedStress, AskedTorque
from tactsim.experiments.boundary_value.conditions import (
    SIDES,
    Amplitude,
    AnyCondition,
    Components,
    Condition,
    ContactCondition,
    RotationCondition,
    Within,
)
from tactsim.experiments.boundary_value.geometry import AXES, AnyGeometry, Dimension
from tactsim.experiments.boundary_value.motions import Held, motions_of
from tactsim.experiments.boundary_value.parts import Parts
from tactsim.experiments.boundary_value.rigid_motions import free_motions, in_words
from tactsim.experiments.boundary_value.symmetry import ELSEWHERE, check_contact, check_load, check_material
from tactsim.interfaces import Material
from tactsim.materials.any_material import AnyMaterial
from tactsim.mechanics.models.prescribed_motion import Disagreement, PrescribedMotions
from tactsim.mechanics.paths.step_policy import TimeSettings
from tactsim.model import FrozenModel
from tactsim.units import Length, format_quantity

AskedName = Annotated[
    str,
    StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,60}$"),
    Field(description="a name: a letter and up to 60 further letters, digits or underscores"),
]
RECORDED = {
    "time": "s",
    "min_volume_ratio": "1",
    "unstable_volume_fraction": "1",
    "poor_volume_fraction": "1",
    "penetration_force_error": "1",
    "max_penetration": "m",
}
"""Units of what every step records beside what is asked for."""
MOST_STEPS = 10_000
"""Most steps of a ramp, and of a period of a sine."""
PENETRATION_SHARE, WITH_FRICTION = 1e-6, 1e-5
"""Largest penetration over the body's size, if a case gives none: of smooth contacts, and where any has friction."""


def ramp() -> Amplitude:
    """From zero to one within a second."""
    return Amplitude.model_validate({"pieces": [{"kind": "ramp", "to": 1.0, "duration": 1.0}]})


class Region(FrozenModel):
    """A part of the body of another material, bonded to the rest."""

    within: Annotated[Within, Field(min_length=1)]
    """Where: between two values of some coordinates at which cells end, such as ``{z: [0 mm, 2 mm]}``; ``r`` is the distance from
    the axis of a round body in 3D and in plane strain, too."""
    material: AnyMaterial
    """What it is made of."""


class BoundaryValueSetup(FrozenModel):
    """A body of a simple shape under what is prescribed on its faces, and the numbers that are asked of it."""

    dimension: Dimension
    """A body in 3D, a long one in plane strain, or one of revolution about z."""
    geometry: AnyGeometry
    """Shape and mesh of the body."""
    material: AnyMaterial
    """What it is made of; linear elastic, hyperelastic, compressible or not, relaxing or not."""
    regions: tuple[Region, ...] = ()
    """Parts of other materials, such as layers; of those that overlap, the last one counts."""
    conditions: tuple[AnyCondition, ...] = ()
    """What is prescribed on its faces; a face without a condition is free."""
    contacts: tuple[ContactCondition, ...] = ()
    """Rigid bodies that touch it."""
    amplitude: Amplitude = Field(default_factory=ramp)
    """Factor over time by which every condition without an amplitude of its own is multiplied; by default it rises evenly from
    0 to 1 within a second, which lengthens no problem whose conditions without one are zero."""
    asked: Annotated[dict[AskedName, AnyAsked], Field(min_length=1)]
    """Name -> number that is asked for."""
    steps: Annotated[int, Field(ge=1, le=MOST_STEPS)] = 10
    """Least number of steps of a ramp, and per period of a sine."""
    time: TimeSettings = TimeSettings()
    """Steps of time of a material that relaxes."""
    penetration_tolerance: Annotated[Length, Field(ge=1e-12)] | None = None
    """Largest penetration of a rigid body; by default a millionth of the body's size, with friction a hundred-thousandth."""

    @property
    def materials(self) -> dict[str, Material]:
        """Every material by its key, that of the body first and then those of the regions."""
        return {"material": self.material} | {f"regions.{k}.material": one.material for k, one in enumerate(self.regions)}

    @property
    def relaxes(self) -> bool:
        """Whether any material relaxes."""
        return any(material.relaxation is not None for material in self.materials.values())

    @property
    def stiffest(self) -> float:
        """Largest shear modulus in Pa."""
        return max(material.shear_modulus for material in self.materials.values())

    @property
    def parts(self) -> Parts:
        """The meshed body, whose regions are those of its materials.

        Raises
        ------
        ValueError
            If it has no mesh in this dimension, or a region does not end between cells; the message begins with the key.
        """
        return Parts.of(self.geometry, self.dimension, tuple(tuple(one.within.items()) for one in self.regions))

    @property
    def _followed(self) -> list[Condition]:
        """All that may follow an amplitude of its own."""
        return [*self.conditions, *self.contacts, *(motion for contact in self.contacts for motion in contact.motions)]

    @property
    def _given(self) -> list[Amplitude]:
        """Every amplitude of a condition's own."""
        return [one.amplitude for one in self._followed if one.amplitude is not None]

    @property
    def common_amplitude(self) -> Amplitude:
        """That of every condition without its own; a given one instead of the default if all of these are held at zero."""
        needed = any(one.varies for one in self._followed if one.amplitude is None)
        return self.amplitude if needed or not self._given or self.amplitude != ramp() else self._given[0]

    @property
    def duration(self) -> float:
        """Time in s until the last amplitude ends."""
        return max(amplitude.duration for amplitude in (self.common_amplitude, *self._given))

    @property
    def begins_with_jump(self) -> bool:
        """Whether anything acts at once."""
        amplitudes = (one.amplitude or self.common_amplitude for one in self._followed)
        return any(amplitude.history().segments[0].at(0.0) != 0 for amplitude in amplitudes)

    def largest_penetration(self, size: float) -> float:
        """Largest penetration in m that is allowed, of a body of this size in m."""
        has_friction = any(ContactPair(one.body, one.law).has_friction for one in self.contacts)
        return self.penetration_tolerance or (WITH_FRICTION if has_friction else PENETRATION_SHARE) * size

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        axes = AXES[self.dimension]
        if not (self.conditions or self.contacts):
            raise ValueError("nothing acts on the body; give conditions on its faces, or contacts")
        for number, condition in enumerate(self.conditions):
            if isinstance(condition, RotationCondition):
                _blaming(f"conditions.{number}", _check_turn, condition, self.dimension)
            if isinstance(condition, Components):
                _blaming(f"conditions.{number}: ", condition.along, axes)
        for number, contact in enumerate(self.contacts):
            self._check_motions(f"contacts.{number}", contact, axes)
            _blaming(f"contacts.{number}.", self._check_contact, contact, axes)
        for name, one in self.asked.items():
            if name in RECORDED:
                raise ValueError(f"asked.{name}: every step records this already; take another name")
            component = getattr(one, "component", None)
            if component in ("x", "y", "z", "r") and component not in axes:
                raise ValueError(f"asked.{name}: there is no component {component}; allowed: {', '.join(axes)}")
            for material in self.materials.values():
                if one.kind == "energy" and not hasattr(material, "stored_energy"):
                    raise ValueError(
                        f"asked.{name}: the material {material.kind} gives no energy; write its method stored_energy(F) in "
                        "J/m^3, or ask for the force and the displacement of what does the work"
                    )
            if one.kind == "torque" and self.dimension == "axisymmetric":
                raise ValueError(f"asked.{name}: a torque about z is asked of a body in 3d or in plane_strain")
            if one.kind == "contact_force" and one.contact > len(self.contacts):
                raise ValueError(f"asked.{name}: there are {len(self.contacts)} contacts, none is number {one.contact}")
            if one.time is not None:
                self._check_time(name, one.time)
        self._check_parts()
        return self

    def _check_parts(self) -> None:
        """Check that the body has what the case names, with its mesh."""
        parts = self.parts
        held = motions_of(parts, self.conditions)
        for key, material in self.materials.items():
            check_material(parts, key, material)
        for number, condition in enumerate(self.conditions):
            _blaming(f"conditions.{number}.", check_load, parts, condition)
        for number, contact in enumerate(self.contacts):
            _blaming(f"contacts.{number}.", _check_touch, parts, contact)
        for name, one in self.asked.items():
            if isinstance(one, AskedForce | AskedTorque):
                _blaming(f"asked.{name}.", parts.face, one.face)
            if isinstance(one, AskedDisplacement | AskedStress):
                _blaming(f"asked.{name}.", self._check_point, one, parts)
        try:
            PrescribedMotions([one.motion for one in held], parts.size)
        except InputError as error:
            mirrors = {one.motion.name for one in held[: len(parts.domain.mirrors)]}  # which come first
            across = f"; {ELSEWHERE}" if isinstance(error, Disagreement) and mirrors.intersection(error.names) else ""
            raise ValueError(f"conditions: {error}{across}") from None
        if not self.contacts and (free := free_motions(parts, held)):
            raise ValueError(
                f"conditions: nothing holds the body against {in_words(free)}; prescribe such a displacement of a face or a point"
            )
        self._check_freedom(parts, held)

    def _check_freedom(self, parts: Parts, held: Sequence[Held]) -> None:
        """Check that an incompressible body may give way somewhere."""
        from tactsim.experiments.boundary_value.confinement import is_confined

        incompressible = all(material.bulk_modulus is None for material in self.materials.values())
        if incompressible and is_confined(parts, held):
            raise ValueError(
                "conditions: the body is confined on all sides and its material incompressible, so that its volume cannot change "
                "and its pressure is arbitrary; give the material a bulk_modulus, or a poisson_ratio below 0.5, or leave a face "
                "free"
            )

    def _check_point(self, one: AskedDisplacement | AskedStress, parts: Parts) -> None:
        """Check that the body has the point, and such a stress there."""
        from tactsim.mechanics.fields.point_values import containing

        parts.check_place(one.at)
        try:
            containing(parts.domain.mesh.nodes, parts.domain.mesh.elements, np.array(one.at))
        except InputError as error:
            raise ValueError(f"at: {error}") from None
        if isinstance(one, AskedStress):
            one.entries(self.dimension)

    def _check_time(self, name: str, time: float) -> None:
        """Check that there is a state at a time in s."""
        if time > self.duration * (1 + 1e-9):
            given, end = format_quantity(time, "s"), format_quantity(self.duration, "s")
            raise ValueError(f"asked.{name}: the time {given} lies after the end at {end}")
        if time == 0 and not self.begins_with_jump:
            raise ValueError(f"asked.{name}: nothing acts at the time 0, for no amplitude begins with a jump; take a later time")

    def _check_motions(self, key: str, contact: ContactCondition, axes: tuple[str, ...]) -> None:
        """Check the displacements that the rigid body of a contact is given."""
        for name, motion in contact.moving.items():
            place = f"{key}.{name}".removesuffix(".")
            _blaming(f"{place}: ", motion.along, axes)
            if self.dimension == "axisymmetric" and motion.r:
                raise ValueError(f"{place}.r: a rigid body moves along the axis only in axisymmetric, not away from it")

    def _check_contact(self, condition: ContactCondition, axes: tuple[str, ...]) -> None:
        """Check body, side and place of a contact; errors begin with its key."""
        if len(axes) not in condition.body.dimensions:
            raise ValueError(f"body: a {condition.body.kind} is not defined in {self.dimension}")
        if condition.side not in SIDES[self.dimension]:
            raise ValueError(
                f"side: no body comes from the {condition.side} in {self.dimension}; allowed: {', '.join(SIDES[self.dimension])}"
            )
        if condition.at is not None and len(condition.at) != len(axes):
            raise ValueError(f"at: at of a contact needs {len(axes)} coordinates: {', '.join(axes)}")
        if condition.at is not None and self.dimension == "axisymmetric" and condition.at[0] != 0:
            radius = format_quantity(condition.at[0], "m")
            raise ValueError(f"at: the axis of a rigid body is that of the body, r = 0, and not {radius} away in axisymmetric")


def _check_turn(condition: RotationCondition, dimension: str) -> None:
    """Check that a face can turn so."""
    if dimension != "3d" and condition.axial == "free":
        along = "z" if dimension == "plane_strain" else "the circle that it turns about"
        raise ValueError(f".axial: no face of a body in {dimension} moves along {along}")


def _check_touch(parts: Parts, contact: ContactCondition) -> None:
    """Check that a rigid body meets its face, and the planes of symmetry as one with its mirror images."""
    from tactsim.experiments.boundary_value.touch import touch_of  # not for a wrong word in a case

    check_contact(parts, contact, touch_of(parts, contact).distance)


def _blaming(key: str, check: Callable[..., object], *values: object) -> None:
    """Make a check, and put the key before what it refuses."""
    try:
        check(*values)
    except ValueError as error:
        raise ValueError(f"{key}{error}") from None
