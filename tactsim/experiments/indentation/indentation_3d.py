"""A rigid body pressed into tissue in 3D: the annulus off the axis and askew, up to the threshold of its inner sensor."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.contact.mirrored import body_mirrors
from tactsim.contact.tilt import Tilt
from tactsim.contact.tilted import Tilted
from tactsim.experiments.indentation.displaced import DisplacedSetup
from tactsim.experiments.indentation.graded_section import GradedSection, MeshSettings
from tactsim.experiments.indentation.history import history_units
from tactsim.experiments.indentation.setup import Posed
from tactsim.fem.paths.loading import StepControl
from tactsim.interfaces import Experiment
from tactsim.materials.mirrored import law_mirrors
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mesh.affordable import check_unknowns
from tactsim.mesh.revolved import SweepSymmetry, largest_offset, shifted_outside, swept
from tactsim.units import Length, NonNegative, Positive, format_quantity

if TYPE_CHECKING:
    from tactsim.fem.assembly.space import Measure
    from tactsim.mechanics.models.solid_model import SolidModel

COARSENING = 3.0
"""Element size at the edges of the body over that of the section's own model: a fillet instead of a third of one."""
LEAST_ACROSS = 6
"""Elements across the width of the contact, at least, however wide the fillet."""
UNSHIFTED = 1.2
"""The mesh keeps its circles within this many radii of the body."""
OBLIQUE_PENETRATION = 3e-4
"""Penetration over the radius that is allowed by default of a body that leans or is off the axis, around which points stick and
slip one by one: with a third of it a sensor that leans by 3 degrees on a thin layer does not come to its end in five minutes,
with it in one. Multipliers instead of a stiff contact take half the time, but then the force depends on the load path by 7e-4."""
FEW_ITERATIONS, MANY_ITERATIONS = 12, 20
"""Steps grow up to so many iterations of Newton, and shrink beyond so many: friction in 3D takes more than in a section."""


class MeshSettings3D(MeshSettings):
    """Size of the elements in the section, and the sectors in which it is swept around the body's axis."""

    finest: Positive[Length] | None = None
    """Element size at the edges; by default the fillet, or three fiftieths of the body's radius if its edge is sharp."""
    growth: Annotated[float, Field(gt=0, le=2)] = 1.0
    """Growth of the element size per distance from the edges, dimensionless."""
    adaptive: Literal[False] = False
    """Elements in 3D are not split on the way."""
    sectors: Annotated[int, Field(ge=2, le=90)] = 2
    """Sectors in a quarter turn about the body's axis, each one quadratic element wide."""


class Indentation3D(DisplacedSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen in 3D, its axis anywhere and leaning."""

    measure: ClassVar[Measure] = "solid"
    if_slow: ClassVar[str] = (
        "; with a larger penetration_tolerance than {tolerance}, a larger mesh.finest or fewer mesh.sectors it takes less"
    )
    kind: Literal["indentation_3d"] = "indentation_3d"
    offset: NonNegative[Length] = 0.0
    """Distance along x of the body's reference point from the axis of the specimen."""
    tilt_x: Tilt = 0.0
    """Rotation of the body about the x axis, right-handed, before that about y."""
    tilt_y: Tilt = 0.0
    """Rotation of the body about the y axis; a positive one leans its axis towards x and lowers its edge there."""
    mesh: MeshSettings3D = MeshSettings3D()
    """Size of the elements and number of sectors."""

    history_units: ClassVar[dict[str, str]] = history_units(clock=False, space=True)

    @classmethod
    def example(cls) -> Self:
        """A thin specimen under the sensor of chapter 3, with few elements."""
        specimen = Specimen(material="icf_stable", thickness=4e-3, radius=8e-3)
        mesh = MeshSettings3D(finest=0.25e-3, growth=1.0, sectors=2)
        return cls(specimen=specimen, recess=0.8e-3, displacement=0.5e-3, stop="displacement", mesh=mesh)

    @model_validator(mode="after")
    def _placed(self) -> Self:
        if self.offset == 0:
            return self
        given = format_quantity(self.offset, "m")
        most = largest_offset(self.specimen.radius, UNSHIFTED * self.contact_radius)
        if self.offset > most:
            allowed = format_quantity(max(most, 0.0), "m")
            raise ValueError(f"offset {given} is too close to the side of the specimen: at most {allowed}")
        if self.specimen.surface != "flat":
            raise ValueError(f"an offset of {given} needs a flat surface, not a {self.specimen.surface} one")
        return self

    @model_validator(mode="after")
    def _held(self) -> Self:
        if self.specimen.base == "slipping" and self.symmetry is not SweepSymmetry.QUARTER:
            raise ValueError("on a slipping base what is off the axis or oblique pushes the specimen away: set base: fixed")
        return self

    @property
    def symmetry(self) -> SweepSymmetry:
        """The part of the specimen that is computed: the largest symmetry that offset, tilts, body and materials leave."""
        if self.tilt_x != 0 or not self._mirrors(1):
            return SweepSymmetry.WHOLE
        return SweepSymmetry.HALF if self.offset != 0 or self.tilt_y != 0 or not self._mirrors(0) else SweepSymmetry.QUARTER

    def _mirrors(self, axis: int) -> bool:
        """Whether the body, upright, and all materials are their own mirror images along an axis."""
        laws = all(law_mirrors(material, axis) for material in self.specimen.materials)
        return laws and body_mirrors(lambda places: self.body.signed_distance(places)[0], axis, self.specimen.radius)

    def posed(self) -> Posed:
        """The body as it leans, off the axis."""
        tilts = {"tilt_x": self.tilt_x, "tilt_y": self.tilt_y}
        body, upright = Tilted(body=self.body, **tilts), super().posed().inner_sensor
        sensor = None if upright is None else Tilted(body=upright, **tilts)
        return Posed(body, body.rotation[:, 2], sensor, self.offset, 4 * self.mesh.sectors)

    @property
    def _usual_penetration(self) -> float:
        """Penetration over the body's radius that is allowed where the case does not say."""
        return super()._usual_penetration if self.symmetry is SweepSymmetry.QUARTER else OBLIQUE_PENETRATION

    def control(self) -> StepControl:
        """Lengths of the load steps in m."""
        return replace(super().control(), few_iterations=FEW_ITERATIONS, many_iterations=MANY_ITERATIONS)

    def model(self) -> SolidModel:
        """The finite element model in 3D, the body's axis at the origin of x and y.

        Raises
        ------
        InputError
            If the mesh would have too many elements or unknowns.
        """
        from tactsim.mechanics.models.solid_model import SolidModel

        section, symmetry = self.section(), self.symmetry
        mesh = section.mesh()
        swept_nodes = 2 * self.mesh.sectors * symmetry.quarters * len(mesh.nodes)
        check_unknowns(3 * swept_nodes, "mesh.finest, mesh.growth, mesh.refinement and mesh.sectors")
        sweep = swept(mesh, self.mesh.sectors * symmetry.quarters, np.pi / 2 * symmetry.quarters)
        top = sweep.facets_from(section.top_edges(mesh))
        nodes = sweep.mesh.nodes
        if self.offset != 0:
            rest = UNSHIFTED * self.contact_radius
            nodes = shifted_outside(nodes, -self.offset, radius=self.specimen.radius, rest=rest)
        return SolidModel(sweep.mesh.moved(nodes), self.specimen.materials, base=self.specimen.base, top=top, symmetry=symmetry)

    def section(self) -> GradedSection:
        """As that of a model in the section, with larger elements at the edges."""
        section = super().section()
        return replace(section, usual=max(section.usual, min(COARSENING * section.usual, self._narrowest / LEAST_ACROSS)))
