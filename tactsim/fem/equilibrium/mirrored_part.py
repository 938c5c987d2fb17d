"""The part of a body that stands for the whole, where planes mirror the body onto itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from tactsim.array import Array
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.body_part import BodyPart
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.balance import ExternalForces
from tactsim.fem.equilibrium.prescribed_force import PrescribedForce

SAME_PLACE = 1e-9
"""Distance of a node from its image's place over the body's size up to which it is that image: far below any cell."""
SAME_FORCE = 1e-6
"""Difference of a nodal force from its image over the largest, up to which it is that image: far above round-off."""


@dataclass(frozen=True)
class SurfacePart:
    """What lies on the part of a surface of the whole, and its ``points`` (m,) among those of the whole."""

    assembly: SurfaceAssembly
    points: Array


@dataclass(frozen=True, eq=False)
class MirroredPart:
    """Half, a quarter or an eighth of a body on one side of planes that mirror the body onto itself.

    A state that is its own mirror image has the same equilibrium in the part as in the whole, if nothing moves across the planes.

    Attributes
    ----------
    whole, body : the whole and the part
    elements, nodes : (E',), (n',) elements and nodes of the part by their numbers in the whole
    images : (n,) number in the part of every node's image there
    signs : (n, d) of the displacements of every node relative to those of its image
    pressure_images : number in the part of the image of every pressure of the whole
    on_planes : (n', k) whether the nodes of the part lie on each of the k planes
    axes : (k,) across which the planes lie
    """

    whole: Body
    body: Body
    elements: Array
    nodes: Array
    images: Array
    signs: Array
    pressure_images: Array
    on_planes: Array
    axes: tuple[int, ...]

    @property
    def copies(self) -> int:
        """How many parts make up the whole."""
        return int(2 ** len(self.axes))

    @property
    def held(self) -> Array:
        """Unknowns (k,) of the part that are zero: displacements across a plane of nodes on it."""
        node, plane = np.nonzero(self.on_planes)
        return np.sort(self.body.space.dim * node + np.array(self.axes)[plane])

    @cached_property
    def counts(self) -> Array:
        """What makes forces on the part's unknowns (size',) those on the whole's: zero across planes, on them all their sides."""
        counts = self._sides.prod(axis=1).astype(float)
        counts[self.held] = 0.0
        return counts

    def unfolded(self, unknowns: Array) -> Array:
        """The unknowns of the whole (size,) of those of the part (size',)."""
        u, p = self.body.space.split(unknowns)
        return np.concatenate([(self.signs * u[self.images]).ravel(), p[self.pressure_images]])

    def folded(self, unknowns: Array) -> Array:
        """The unknowns of the part (size',) in those of the whole (size,), or nodal values alike."""
        return unknowns[self._unknowns]

    def mirrors(self, forces: Array) -> bool:
        """Whether nodal forces on the whole (size,) are their own mirror image."""
        return bool(np.abs(self.unfolded(self.folded(forces)) - forces).max() <= SAME_FORCE * np.abs(forces).max())

    def forces(self, forces: ExternalForces) -> ExternalForces:
        """What acts on the part of what acts on the whole; interfaces whose surface lies beside the part are left out."""
        surfaces = [self._surface(interface.surface) for interface in forces.interfaces]
        touched = {number: surface for number, surface in enumerate(surfaces) if surface is not None}
        control = forces.load_control
        if control is not None:
            control = PrescribedForce(tuple(control.directions[number] for number in touched), control.force / self.copies)
        return ExternalForces(
            tuple(forces.interfaces[number].of_part(surface.assembly, surface.points) for number, surface in touched.items()),
            tuple(load.of_part(self.own) for load in forces.loads),
            control,
        )

    def relaxation(self, step: RelaxationStep | None) -> RelaxationStep | None:
        """A step of time of the part's materials."""
        if step is None:
            return None
        stress = np.take(step.stress, self.elements, axis=1)  # an index would give an order that the loops are compiled for anew
        return RelaxationStep(step.scale[self.elements], stress)

    def _surface(self, surface: SurfaceAssembly) -> SurfacePart | None:
        """What lies on the part of a surface of the whole, the same object for the same surface; None if nothing does."""
        if surface not in self._surfaces:
            points, dim = surface.points, self.body.space.dim
            chosen, facets = self.own.facets(points.nodes[:: points.per_facet])
            numbers = (points.per_facet * chosen[:, None] + np.arange(points.per_facet)).ravel()
            on_part = self.body.space.surface_points(facets)
            assembly = SurfaceAssembly(on_part, self.body.pattern, dim) if len(chosen) else None
            self._surfaces[surface] = None if assembly is None else SurfacePart(assembly, numbers)
        return self._surfaces[surface]

    @cached_property
    def own(self) -> BodyPart:
        """Its unknowns and facets in the whole: at nodes on a plane each side bears half."""
        return BodyPart(self.body, self.nodes, self._unknowns, self._sides.prod(axis=1))

    @cached_property
    def _surfaces(self) -> dict[SurfaceAssembly, SurfacePart | None]:
        return {}

    @cached_property
    def _unknowns(self) -> Array:
        """Numbers (size',) in the whole of the part's unknowns."""
        space = self.whole.space
        displacements = (self.nodes[:, None] * space.dim + np.arange(space.dim)).ravel()
        pressures = np.empty(len(self.body.space.pressure_corners), int)
        pressures[self.body.space.pressures] = space.pressures[self.elements]
        return np.concatenate([displacements, space.displacement_size + pressures])

    @cached_property
    def _sides(self) -> Array:
        """Number of sides (size', k) of each plane on which an unknown of the part has a share: two if elements beyond use it."""
        space, shares = self.whole.space, []
        for axis in self.axes:
            beyond = np.zeros(space.size, bool)
            there = ~inside(space.nodes[space.elements[:, : space.dim + 1]].mean(axis=1), space.nodes, (axis,))
            beyond[space.element_unknowns()[there]] = True
            shares.append(1 + beyond[self._unknowns])
        return np.stack(shares, axis=1)


def mirrored_part(body: Body, axes: Sequence[int] = (0, 1, 2)) -> MirroredPart | None:
    """The smallest part of a body between middle planes that mirror its nodes, elements and materials; None without such a plane.

    ``axes`` are those across which a plane is looked for. What acts on the body is not looked at.
    """
    part = None
    for axis in axes:
        part = _part(body, (axis,) if part is None else (*part.axes, axis)) or part
    return part


def inside(places: Array, nodes: Array, axes: tuple[int, ...]) -> Array:
    """Whether places (m, d) in m lie below the middle planes of nodes (n, d) across these axes."""
    middle = (nodes.min(axis=0) + nodes.max(axis=0)) / 2
    return (places[:, list(axes)] < middle[list(axes)]).all(axis=1)


def _part(body: Body, axes: tuple[int, ...]) -> MirroredPart | None:
    """The part below the middle planes across these axes; None if one of them does not mirror the body."""
    space, chosen = body.space, list(axes)
    tolerance = SAME_PLACE * float(np.ptp(space.nodes, axis=0).max())
    low, high = space.nodes.min(axis=0), space.nodes.max(axis=0)
    above = space.nodes - (low + high) / 2
    if not _even(above[:, axes[-1]], tolerance):
        return None
    corners = space.elements[:, : space.dim + 1]
    elements = np.flatnonzero(inside(space.nodes[corners].mean(axis=1), space.nodes, axes))
    if 2 ** len(axes) * len(elements) != len(corners):
        return None
    nodes = np.unique(space.elements[elements])
    folded = space.nodes.copy()
    folded[:, chosen] = ((low + high) / 2 - np.abs(above))[:, chosen]
    distance, images = cKDTree(space.nodes[nodes]).query(folded, distance_upper_bound=2 * tolerance)
    if not np.isfinite(distance).all():
        return None
    part = TaylorHood(
        space.nodes[nodes], np.searchsorted(nodes, space.elements[elements]), space.measure, _regions_of(body, elements)
    )
    alike = _element_images(images[corners], part.elements[:, : space.dim + 1])
    if alike is None or not _same_materials(body, elements[alike]):
        return None
    signs = np.ones_like(space.nodes)
    signs[:, chosen] = np.where(above[:, chosen] > tolerance, -1.0, 1.0)
    on_planes = np.abs(above[nodes][:, chosen]) <= tolerance
    pressures = _pressure_images(space, part, images, alike)
    return MirroredPart(body, _restricted(body, part, elements), elements, nodes, images, signs, pressures, on_planes, axes)


def _restricted(body: Body, space: TaylorHood, elements: Array) -> Body:
    """The body of some ``elements`` (E',) in a space of their own; messages number them as before."""
    part = Body(space, body.materials, body.regions[elements], volume_stiffness=body.stabilisation[elements])
    part.numbers = body.numbers[elements]
    return part


def _even(above: Array, tolerance: float) -> bool:
    """Whether heights (n,) above a plane are as many as those below it."""
    return bool(np.abs(np.sort(above) + np.sort(above)[::-1]).max() <= tolerance)


def _regions_of(body: Body, elements: Array) -> Array | None:
    return None if body.space.regions is None else body.space.regions[elements]


def _element_images(folded: Array, corners: Array) -> Array | None:
    """The element of the part (E,) onto whose corners (E', V) those of each element of the whole fold, if all have one."""
    both, numbers = np.unique(np.sort(np.concatenate([corners, folded]), axis=1), axis=0, return_inverse=True)
    if len(both) != len(corners):
        return None
    owner = np.empty(len(both), int)
    owner[numbers.ravel()[: len(corners)]] = np.arange(len(corners))
    return owner[numbers.ravel()[len(corners) :]]


def _same_materials(body: Body, images: Array) -> bool:
    """Whether the elements have the materials of their images (E,)."""
    kinds = np.array([body.materials.index(material) for material in body.materials])[body.regions]
    return bool((kinds == kinds[images]).all())


def _pressure_images(space: TaylorHood, part: TaylorHood, nodes: Array, elements: Array) -> Array:
    """The image in the part of every pressure of the whole, given those of nodes (n,) and elements (E,)."""
    corners = space.elements[:, : space.dim + 1]
    here, there = np.argsort(nodes[corners], axis=1), np.argsort(part.elements[:, : space.dim + 1], axis=1)[elements]
    images = np.empty(len(space.pressure_corners), int)
    images[np.take_along_axis(space.pressures, here, 1)] = np.take_along_axis(part.pressures[elements], there, 1)
    return images
