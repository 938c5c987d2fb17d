"""What a grasp is given: the block and what is in it, two jaws with their matrices of taxels, the history, the mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.contact.any_law import AnyLaw
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.jaw import Jaw
from tactsim.contact.tilt import Tilt
from tactsim.errors import InvalidQuantity, Refused
from tactsim.experiments.grasp.lumen_pressure import AnyLumenPressure, PulsePressure
from tactsim.experiments.grasp.solver_settings import GraspSolverSettings
from tactsim.experiments.grasp.time_settings import GraspTimeSettings
from tactsim.experiments.grasp.wedge import sliding_out
from tactsim.interfaces import Inclusion, Material
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.materials.any_material import AnyMaterial
from tactsim.mechanics.contact.penetration_bounds import check_penetration, default_penetration
from tactsim.mechanics.models.any_block_source import AnyBlockSource, AnySource, AutomaticSource
from tactsim.mechanics.models.block_source import TOUCHING
from tactsim.mechanics.paths.loading import AnyLoading, check_periods
from tactsim.mesh.any_inclusion import AnyInclusion, check_inclusions, inclusion_name
from tactsim.model import FrozenModel
from tactsim.progress import Extent
from tactsim.sensors.matrix_readout import MatrixReadout
from tactsim.units import Length, NonNegative, Positive, format_quantity

OVERHANG = 1.25
"""Size of a jaw over the block's, where none is given: tissue pressed by a fifth of its height stays below it."""
PENETRATION = 2e-4
"""Largest penetration over the height of the block, where none is given: with both jaws, 0.4 % of a closing by a tenth each."""
PENETRATION_OF_CLOSING = 1e-2
"""That over a small closing, at most: multipliers leave most points with a tenth of the largest penetration."""

SMALLEST_CLOSING = 1e-10
"""Smallest closing over the height of the block: five digits are left of it in the places of nodes."""


class Block(FrozenModel):
    """The block of tissue, from (0, 0, 0) on the lower jaw, x growing with the column of a taxel, y with its row.

    >>> import tactsim as ts
    >>> block = ts.Block(size=("40 mm", "40 mm", "20 mm"), tissue="icf_stable")
    >>> block.size, block.tissue.kind
    ((0.04, 0.04, 0.02), 'mooney_rivlin_3')
    """

    size: tuple[Positive[Length], Positive[Length], Positive[Length]] = (40e-3, 40e-3, 20e-3)
    """Along x, y and z; the thesis prints none."""
    tissue: AnyMaterial
    """Material around the inclusions."""


class Embedded(FrozenModel):
    """A body in the block.

    >>> import tactsim as ts
    >>> ball = ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius="4 mm")
    >>> ts.Embedded(shape=ball, material="lump").material.kind
    'neo_hookean'
    """

    shape: AnyInclusion
    """Its shape and place."""
    material: AnyMaterial
    """Its material."""
    lumen: AnyLumenPressure | None = None
    """Pressure in the empty space of a hollow one; null means none."""

    def unlike(self, tissue: Material) -> bool:
        """Whether it differs from the tissue around it: it is hollow or of another material."""
        return self.shape.hollow or self.material != tissue


class JawSettings(FrozenModel):
    """A jaw and how it stands."""

    width: Positive[Length] | None = None
    """Along x; by default a quarter wider than the block."""
    depth: Positive[Length] | None = None
    """Along y; by default a quarter deeper than the block."""
    fillet: NonNegative[Length] = 1e-3
    """Radius of the edges."""
    tilt_x: Tilt = 0.0
    """Rotation about the x axis, right-handed, before that about y."""
    tilt_y: Tilt = 0.0
    """Rotation about the y axis."""
    offset: tuple[Length, Length] = (0.0, 0.0)
    """Place of the middle of its face in x and y, from that of the block."""

    def jaw(self, side: str, size: Sequence[float]) -> Jaw:
        """The jaw for a block of this size in m, so thick that no tissue that bulges beside it comes to its back."""
        width, depth = (
            given or OVERHANG * size[axis] + 2 * abs(self.offset[axis]) for axis, given in enumerate((self.width, self.depth))
        )
        posed: dict[str, Any] = {"side": side, "tilt_x": self.tilt_x, "tilt_y": self.tilt_y, "fillet": self.fillet}
        return Jaw(width=width, depth=depth, thickness=max(width, depth, size[2]), **posed)

    def middle(self, size: Sequence[float]) -> Array:
        """Place (2,) in m of the middle of its face on a block of this size, whose corner is the origin."""
        return np.array(size[:2]) / 2 + self.offset


class GraspSetup(FrozenModel):
    """A block of tissue between two jaws that close by a history of displacement or force."""

    block: Block
    """The tissue."""
    inclusions: Annotated[tuple[Embedded, ...], Field(max_length=32)] = ()
    """Lumps and arteries in it, such as {shape: {kind: sphere, center: [20 mm, 20 mm, 12 mm], radius: 4 mm}, material: lump}."""
    upper: JawSettings = JawSettings()
    """The jaw above."""
    lower: JawSettings = JawSettings()
    """The jaw below."""
    matrix: TaxelLayout = TaxelLayout()
    """Taxels on each jaw."""
    contact: AnyLaw = Coulomb(friction=0.6)
    """Friction between jaws and tissue; the default is that of section 6.6."""
    loading: AnyLoading
    """What both jaws follow: closing from first touch, each by that much, or force, each by that much."""
    penetration_tolerance: Positive[Length] | None = None
    """Largest penetration at any surface quadrature point; by default 2e-4 of the block's height, at most 1e-2 of a prescribed
    closing. At most a tenth of that closing, of the block's height and of a jaw's fillet."""
    mesh: AnyBlockSource = AutomaticSource()
    """Where the mesh comes from."""
    time: GraspTimeSettings = GraspTimeSettings()
    """Steps of time."""
    solver: GraspSolverSettings = GraspSolverSettings()
    """How the equilibrium is found."""
    readout: MatrixReadout | None = None
    """Sensors and electronics of the taxels, from force to voltage and back; null ends at the force."""

    @property
    def extent(self) -> Extent:
        """The time of all histories."""
        return Extent("time", self.duration)

    @property
    def tolerance(self) -> float:
        """Largest penetration in m."""
        usual = PENETRATION * self.block.size[2]
        return self.penetration_tolerance or default_penetration(usual, self.loading.largest_displacement, PENETRATION_OF_CLOSING)

    @property
    def shapes(self) -> tuple[Inclusion, ...]:
        """The bodies in the block."""
        return tuple(embedded.shape for embedded in self.inclusions)

    @property
    def unlike_tissue(self) -> tuple[Embedded, ...]:
        """The inclusions that differ from the tissue around them."""
        return tuple(embedded for embedded in self.inclusions if embedded.unlike(self.block.tissue))

    @property
    def materials(self) -> tuple[Material, ...]:
        """One per region of the mesh, the tissue first."""
        return (self.block.tissue, *(embedded.material for embedded in self.inclusions))

    @property
    def lumens(self) -> dict[int, AnyLumenPressure]:
        """Pressure by the number of the inclusion, counted from 1."""
        return {k: embedded.lumen for k, embedded in enumerate(self.inclusions, 1) if embedded.lumen is not None}

    @property
    def duration(self) -> float:
        """Time in s at which the last of all histories ends."""
        return max([self.loading.duration, *(lumen.duration for lumen in self.lumens.values())])

    def jaw(self, side: str) -> Jaw:
        """The upper or the lower jaw."""
        settings: JawSettings = getattr(self, side)
        return settings.jaw(side, self.block.size)

    @property
    def flats(self) -> list[Array]:
        """Low and high corner (2, 2) in m of the flat of each jaw's face, seen along z in the block, whose corner is the origin;
        none if both jaws are at least as large as the block."""
        (x, y, _), jaws = self.block.size, {side: self.jaw(side) for side in JAWS}
        if all(jaw.width >= x and jaw.depth >= y for jaw in jaws.values()):
            return []
        return [jaw.flat(getattr(self, side).middle(self.block.size)) for side, jaw in jaws.items()]

    @property
    def source(self) -> AnySource:
        """Where the mesh comes from, as far as the case says without making it."""
        mesh = self.mesh
        return mesh.chosen(self.block.size, self.shapes, self.flats) if isinstance(mesh, AutomaticSource) else mesh

    @model_validator(mode="after")
    def _jaws_as_they_are_built(self) -> Self:
        for side in JAWS:
            try:
                self.jaw(side)
            except Refused as error:
                raise ValueError(f"{side}.{str(error).removeprefix('Jaw: ')}") from None
        return self

    @model_validator(mode="after")
    def _embedded(self) -> Self:
        size = np.array(self.block.size)
        try:
            gaps = {source.least_gap(self.block.size) for source in (self.mesh, self.source)}
            for gap in sorted(gaps):  # a body that is too near for any mesh is told the least that one needs
                check_inclusions(size, self.shapes, gap)
        except InvalidQuantity as error:
            names = [f"{inclusion_name(number, shape)} " for number, shape in enumerate(self.shapes, 1)]
            blamed = [f"inclusions.{k}.shape: " for k, name in enumerate(names) if str(error).startswith(name)]
            raise ValueError(f"{''.join(blamed)}{error}{self._nearer()}") from None
        for number, embedded in enumerate(self.inclusions, 1):
            name, hollow = inclusion_name(number, embedded.shape), embedded.shape.hollow
            if embedded.lumen is not None and not hollow:
                raise ValueError(f"inclusions.{number - 1}.lumen: {name} has no empty space; leave it out")
        if (misfit := self.mesh.misfit(self.block.size, self.shapes, self.flats)) is not None:
            raise ValueError(f"mesh.kind: {misfit}; take kind: tetrahedra")
        return self

    def _nearer(self) -> str:
        """What lets inclusions be nearer to each other and to faces, if a smaller distance is all that they need."""
        try:
            check_inclusions(np.array(self.block.size), self.shapes, TOUCHING)
        except InvalidQuantity:
            return ""
        return f", {self.mesh.nearer}" if self.mesh.nearer else ""

    @model_validator(mode="after")
    def _jaws_meet_the_block(self) -> Self:
        for side in JAWS:
            jaw, settings = self.jaw(side), getattr(self, side)
            for axis, (name, extent) in enumerate((("width", jaw.width), ("depth", jaw.depth))):
                most = (self.block.size[axis] + extent) / 2 - jaw.fillet
                if abs(settings.offset[axis]) >= most:
                    given, allowed = (format_quantity(v, "m") for v in (settings.offset[axis], most))
                    raise ValueError(f"{side}.offset: at {given} the jaw passes beside the block; allowed: less than {allowed}")
                needed = self.matrix.extent()[axis]
                if needed > extent * (1 + 1e-12):
                    wide, has = format_quantity(needed, "m"), format_quantity(extent, "m")
                    at = f"{wide} wide at a pitch of {self.matrix.given('pitch')}"
                    raise ValueError(f"matrix: {at}, more than {side}.{name} {has}; take a smaller pitch or a larger jaw")
        return self

    @model_validator(mode="after")
    def _held(self) -> Self:
        if not self.flats and (sliding := sliding_out(self.jaw("upper"), self.jaw("lower"), self.contact)) is not None:
            raise ValueError(f"contact: {sliding}")
        return self

    @model_validator(mode="after")
    def _beating(self) -> Self:
        for number, lumen in self.lumens.items():
            if isinstance(lumen, PulsePressure):
                try:
                    check_periods(lumen.rate, self.duration - lumen.rise)
                except ValueError as error:
                    raise ValueError(f"inclusions.{number - 1}.lumen: rate: {error}") from None
        return self

    @model_validator(mode="after")
    def _kept_out(self) -> Self:
        fillets = {f"{side} jaw's fillet": getattr(self, side).fillet for side in JAWS}
        lengths = {"closing": self.loading.largest_displacement, "block's height": self.block.size[2]}
        check_penetration(self.penetration_tolerance, lengths | fillets)
        return self

    @model_validator(mode="after")
    def _pressed(self) -> Self:
        least, most = self.loading.least_and_most()
        if self.loading.control == "force":
            if least <= 0:
                raise ValueError(
                    f"loading: the force falls to {format_quantity(least, 'N')}; it must press all the time, "
                    "or no closing answers it"
                )
            return self
        given, height = format_quantity(most, "m"), format_quantity(self.block.size[2], "m")
        if most >= self.block.size[2] / 2:
            raise ValueError(f"loading: each jaw closes by {given}; allowed: less than half the block's height {height}")
        if 0 < most < SMALLEST_CLOSING * self.block.size[2]:
            raise ValueError(
                f"loading: each jaw closes by {given}, which is lost in round-off beside the block's height {height}; allowed: "
                f"from {format_quantity(SMALLEST_CLOSING * self.block.size[2], 'm')} on"
            )
        if least < 0:
            raise ValueError(
                f"loading: the closing falls to {format_quantity(least, 'm')}, away from first touch; allowed: from 0"
            )
        if most == 0 and not self.lumens:
            raise ValueError("loading: the jaws do not close and no lumen has a pressure, so that nothing happens")
        return self
