"""What every indentation is given, and what follows from it: the body as it stands, what moves it, the model."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.contact.annulus import Annulus
from tactsim.contact.any_law import AnyLaw
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.punch import Punch
from tactsim.experiments.indentation.graded_section import GradedSection, MeshSettings
from tactsim.fem.paths.loading import StepControl
from tactsim.interfaces import RigidBody
from tactsim.mechanics.contact.penetration_bounds import check_penetration, default_penetration
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mechanics.paths.loading import DisplacementLoading, ForceLoading
from tactsim.mechanics.paths.step_policy import StepPolicy
from tactsim.model import FrozenModel
from tactsim.registry import Registered
from tactsim.results.result import Status
from tactsim.units import Length, Positive, format_quantity

if TYPE_CHECKING:
    from tactsim.fem.assembly.space import Measure
    from tactsim.mechanics.models.pressed_model import PressedModel

AnyBody: Any = Annotated[RigidBody, Registered(RigidBody, lambda cls: 2 in cls.dimensions)]
LARGEST_RATIO = 1e5
"""A specimen this many times larger than the body is a mistake in a unit."""


@dataclass(frozen=True)
class Drive:
    """What moves the body, and the words for a path that comes to its end."""

    stops_at_touch: bool
    """Whether the run is over when the tissue touches the inner sensor; a path without a touch has failed then."""
    reached: str
    """Reason of success."""
    missed: str
    """Reason of failure where the touch did not come."""

    def ending(self, *, touched: bool) -> tuple[Status, str]:
        """Status and reason of a path that came to its end, by whether the tissue has touched the inner sensor."""
        if self.stops_at_touch and not touched:
            return Status.FAILED, self.missed
        return Status.CONVERGED, self.reached


@dataclass(frozen=True)
class Displaced(Drive):
    """The body moves by ``displacement`` in m in load steps, without regard to time."""

    displacement: float
    control: StepControl


@dataclass(frozen=True)
class Timed(Drive):
    """The body follows a history of displacement or force."""

    loading: DisplacementLoading | ForceLoading
    policy: StepPolicy
    compare: Literal["half_space", "layer"] | None
    """Closed form that the answer is compared with."""
    compared_from: float
    """Time in s from which on the comparison counts."""

    @property
    def by_force(self) -> bool:
        """Whether the history is that of the force."""
        return self.loading.control == "force"


@dataclass(frozen=True, eq=False)
class Posed:
    """A body as it stands, in the coordinates of the tissue."""

    body: RigidBody
    axis: Array
    """Unit vector (d,) along its axis, away from the tissue."""
    inner_sensor: RigidBody | None = None
    """The sensor in the hole of an annulus."""
    offset: float = 0.0
    """Distance in m of its reference point from the axis of the specimen."""
    sectors: int = 1
    """Equal sectors around its axis by which its pressure is reported."""


class IndentationSetup(FrozenModel):
    """A rigid body, the specimen it is pressed into along its axis, and how finely that is computed."""

    measure: ClassVar[Measure] = "axisymmetric"
    """What the section stands for."""
    if_slow: ClassVar[str] = ""
    """What is added to the reason of a run whose time did not suffice: what takes less time than a tolerance of
    ``{tolerance}``."""
    specimen: Specimen
    """The tissue."""
    body: AnyBody = Annulus()
    """The rigid body; its reference point moves by the displacement."""
    contact: AnyLaw = Coulomb()
    """Friction between body and tissue."""
    recess: Positive[Length] | None = None
    """Depth L of the inner sensor below the face of an annulus: the tissue touches it when it has risen by L."""
    penetration_tolerance: Annotated[Length, Field(ge=1e-12)] | None = None
    """Largest penetration at any surface quadrature point; by default 1e-4 of the radius of the body, or of a narrower specimen,
    3e-4 where a body in 3D leans or is off the axis, at most 2e-3 of a prescribed displacement. At most a tenth of that
    displacement, of the contact's width, of a fillet and of the thinnest layer."""
    mesh: MeshSettings = MeshSettings()
    """Size of the elements."""

    @property
    @abstractmethod
    def depth(self) -> float:
        """Displacement in m that the mesh must serve."""

    @abstractmethod
    def drive(self) -> Displaced | Timed:
        """What moves the body: the clock of the simulation, or none."""

    def doubts(self) -> list[str]:
        """Sizes and materials that look like a wrong unit."""
        from tactsim.fem.assembly.material_forms import interpreted_warnings
        from tactsim.mechanics.outcome.plausibility import oddities

        layers = {f"specimen.layers.{k}": layer for k, layer in enumerate(self.specimen.layers)}
        materials = {f"specimen.{key}": material for key, material in self.specimen.materials_by_key.items()}
        tissue = {"specimen.thickness": self.specimen.thickness, "specimen.radius": self.specimen.radius}
        tissue |= {f"{name}.thickness": layer.thickness for name, layer in layers.items()}
        bodies = {f"body.{name}": radius for name, radius in self.body.contact_shape.radii.items()}
        return [*oddities(materials, tissue=tissue, bodies=bodies), *interpreted_warnings(materials)]

    def posed(self) -> Posed:
        """The body as it stands, upright on the axis; a sensor as high as any tissue in it fills the hole of an annulus."""
        sensor = Punch(radius=self.hole, height=self.specimen.thickness) if self.hole else None
        return Posed(self.body, np.array([0.0, 1.0]), sensor)

    @property
    def prescribed(self) -> float | None:
        """Largest displacement in m that is prescribed; None if a force is."""
        return None

    @model_validator(mode="after")
    def _fitting(self) -> Self:
        width = format_quantity(self.specimen.radius, "m")
        shape = self.body.contact_shape
        bounded = shape.tip is None or shape.tip.within_radius  # of a ball only a cap touches, however wide it is
        if shape.radius is not None and bounded and shape.radius >= self.specimen.radius:
            given = format_quantity(shape.radius, "m")
            raise ValueError(f"specimen.radius: {width} is too small for a body of radius {given}; allowed: more than that")
        largest = max(self.specimen.radius, self.specimen.thickness)
        if largest > LARGEST_RATIO * self.contact_radius:
            big, small = format_quantity(largest, "m"), format_quantity(self.contact_radius, "m")
            raise ValueError(f"specimen: {big} under a body of {small}: is one of the units wrong?")
        finest, narrowest = self.mesh.finest, self._narrowest
        if finest is not None and finest > narrowest / 2:
            given, width = format_quantity(finest, "m"), format_quantity(narrowest, "m")
            raise ValueError(f"mesh.finest: {given} is too coarse for a contact {width} wide; allowed: at most half of it")
        if self.recess is not None:
            self._check_recess(self.recess)
        self._check_penetration()
        return self

    def _check_penetration(self) -> None:
        fillet, layers = self.body.contact_shape.fillet, -np.diff(self.specimen.interfaces)
        lengths = {"displacement": self.prescribed, "width of the contact": self._narrowest, "body's fillet": fillet}
        check_penetration(self.penetration_tolerance, lengths | {"thickness of the thinnest layer": float(layers.min())})

    def _check_recess(self, recess: float) -> None:
        if not self.hole:
            raise ValueError(f"recess: only a body with a hole, such as an annulus, has one; a {self.body.kind} has none")
        if recess >= self.specimen.thickness:
            given, thickness = (format_quantity(length, "m") for length in (recess, self.specimen.thickness))
            raise ValueError(f"recess: {given} must be smaller than the specimen's thickness {thickness} (thesis, end of 3.1.1)")
        edge = self.hole + (self.body.contact_shape.fillet or 0.0)  # where the face begins, which a convex surface touches first
        rise = float(self.specimen.depth_of_cap(edge)) if self.specimen.surface == "convex" else 0.0
        if rise >= recess:
            given, stands = (format_quantity(length, "m") for length in (recess, rise))
            raise ValueError(
                f"recess: {given} is too shallow: the curved surface stands {stands} in the hole before it touches the annulus"
            )

    @property
    def contact_radius(self) -> float:
        """Radius in m that the body's size is measured by: its own, or that of the specimen if the body is wider."""
        return min(self.body.contact_shape.reach, self.specimen.radius)

    @property
    def hole(self) -> float:
        """Radius in m of the hole in the middle of the body; 0 if it has none."""
        return float(self.body.contact_shape.hole)

    @property
    def _narrowest(self) -> float:
        """Width in m of the contact that the mesh must resolve."""
        return self.contact_radius - self.hole

    @property
    def tolerance(self) -> float:
        """Largest penetration in m."""
        return self.penetration_tolerance or default_penetration(self._usual_penetration * self.contact_radius, self.prescribed)

    @property
    def _usual_penetration(self) -> float:
        """Penetration over the body's radius that is allowed where the case does not say."""
        return 1e-4

    def section(self) -> GradedSection:
        """The section of the specimen, its elements smallest at the edges of the body or around its tip."""
        specimen, shape, radius = self.specimen, self.body.contact_shape, self.contact_radius
        rims: tuple[float, ...] = ()
        if shape.tip is None:
            rims, reach = tuple(r for r in (shape.hole, radius) if 0 < r < specimen.radius), shape.fillet or 0.0
            usual = reach / 3 if reach > 0 else radius / 50
        else:
            reach = 1.5 * float(np.sqrt((shape.radius or radius) * self.depth))
            if shape.tip.within_radius:
                reach = min(reach, 1.5 * radius)
            usual, reach = reach / shape.tip.elements, min(reach, specimen.radius)
        return GradedSection(specimen, self.mesh, shape, rims=rims, reach=reach, usual=usual)

    def model(self) -> PressedModel:
        """The finite element model of the tissue.

        Raises
        ------
        InputError
            If the mesh would have too many elements.
        """
        from tactsim.mechanics.models.section_model import SectionModel

        section, specimen = self.section(), self.specimen
        mesh = section.mesh()
        return SectionModel(mesh, specimen.materials, base=specimen.base, top=section.top_edges(mesh), measure=self.measure)
