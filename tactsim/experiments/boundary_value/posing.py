"""From the words of a case to the finite element model: faces to nodes and facets, conditions to motions and loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.contact.penalty import Augmentation, Regularisation
from tactsim.contact.traction import ContactPair
from tactsim.contact.turned import Turned
from tactsim.errors import InputError
from tactsim.experiments.boundary_value.asked import place_in_words
from tactsim.experiments.boundary_value.conditions import (
    SIDES,
    AnyCondition,
    ClampCondition,
    ContactCondition,
    DisplacementCondition,
    FaceCondition,
    ForceCondition,
    PointCondition,
    PressureCondition,
    RotationCondition,
    TractionCondition,
)
from tactsim.experiments.boundary_value.geometry import AXES
from tactsim.experiments.boundary_value.setup import BoundaryValueSetup
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.dead_load import DeadTraction
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.assembly.space import Measure, SurfacePoints, TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.mechanics.contact.first_touch import first_touch
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.models.loaded_body import Conditions, FactoredForce, LoadedBody, MovedContact
from tactsim.mechanics.models.prescribed_motion import PrescribedMotion, PrescribedMotions, Rotation, Translation
from tactsim.mechanics.models.solid_model import PATIENCE
from tactsim.mesh.graded.mapped import Domain
from tactsim.units import format_quantity

MEASURES: dict[str, Measure] = {"3d": "solid", "plane_strain": "plane_strain", "axisymmetric": "axisymmetric"}
AT_NODE = 1e-9
"""Distance from a corner of the mesh, over the body's size, that is round-off."""
SWITCH_SHARE = 0.03
"""Length over which a violated contact counts as much as the largest pressure, as a part of the body's size."""
SOFTNESS = 2.5e-3
"""Penetration that the penalty of friction would leave without multipliers, over the body's size: a part of a small cell."""
FAR = 2.0
"""Distance from which a rigid body approaches, over the body's size."""


@dataclass(frozen=True)
class PosedProblem:
    """The model, the faces of its mesh, the size of the body in m, and for each factor the condition that it belongs to.

    ``followed`` holds the conditions of the case in the order of the factors; None is one that nothing moves.
    """

    model: LoadedBody
    domain: Domain
    size: float
    followed: tuple[FaceCondition | PointCondition | None, ...]


def posed(problem: BoundaryValueSetup) -> PosedProblem:
    """The model of a problem.

    Raises
    ------
    InputError
        If a face, a part of it or a point is not there, or two conditions contradict each other.
    """
    return _Posing(problem).posed()


class _Posing:
    """Looks up what the conditions of a problem name."""

    def __init__(self, problem: BoundaryValueSetup):
        self._problem, self._axes = problem, AXES[problem.dimension]
        self._domain = problem.geometry.domain(problem.dimension)
        mesh = self._domain.mesh
        self._mesh, self._dim = mesh, mesh.dim
        self._body = Body(TaylorHood(mesh.nodes, mesh.elements, MEASURES[problem.dimension]), [problem.material], mesh.regions)
        self._size = float(np.ptp(mesh.nodes, axis=0).max())

    def posed(self) -> PosedProblem:
        """The whole model."""
        motions, moved = self._motions()
        forces = [
            one for one in self._problem.conditions if isinstance(one, (PressureCondition, TractionCondition, ForceCondition))
        ]
        loads, units = zip(*map(self._load, forces), strict=True) if forces else ((), ())
        contacts = tuple(map(self._contact, self._problem.contacts))
        prescribed = PrescribedMotions(motions, self._size)
        conditions = Conditions(prescribed, len(motions), loads, units, contacts)
        options = PATIENCE if contacts else NewtonOptions()
        model = LoadedBody(self._mesh, self._body, conditions, self._regularisation(contacts), options=options)
        return PosedProblem(model, self._domain, self._size, (*moved, *forces, *self._problem.contacts))

    def _regularisation(self, contacts: Sequence[MovedContact]) -> Regularisation:
        """A penalty as stiff as the penetration asks; a soft one and multipliers where a whole face is about to stick or slip.

        Why: under faces that meet all at once every point chooses between stick and slip in the same step, and Newton cycles with
        a stiff penalty; where a round body rolls on, points close one by one, and multipliers lag behind.
        """
        tolerance, modulus = self._problem.largest_penetration(self._size), self._problem.material.shear_modulus
        rubbing = [contact.posed for contact in contacts if contact.posed.pair.has_friction]
        if rubbing and all(self._conforms(contact) for contact in rubbing):
            return Augmentation(tolerance, modulus, SWITCH_SHARE * self._size, softness=SOFTNESS * self._size)
        return Regularisation(tolerance, modulus, SWITCH_SHARE * self._size)

    def _conforms(self, contact: PosedContact) -> bool:
        """Whether all points of a face are as far from the rigid body."""
        gap = contact.pair.body.signed_distance(contact.reference - contact.place[:, None])[0]
        return float(np.ptp(gap)) <= AT_NODE * self._size

    def _motions(self) -> tuple[list[PrescribedMotion], list[FaceCondition | PointCondition | None]]:
        """Motions, and the condition that each comes from: the symmetry of the whole first."""
        motions: list[PrescribedMotion] = []
        origins: list[FaceCondition | PointCondition | None] = []
        for name, axis in self._domain.mirrors.items():
            motions.append(Translation(f"the symmetry about {name}", self._unknowns(self._domain.faces[name], axis), 0.0))
        if self._problem.dimension == "axisymmetric" and (on_axis := np.flatnonzero(self._mesh.nodes[:, 0] == 0.0)).size:
            motions.append(Translation("the symmetry about the axis", self._dim * on_axis, 0.0))
        origins += [None] * len(motions)
        for number, condition in enumerate(self._problem.conditions, 1):
            new = self._motion(f"condition {number} ({condition.kind})", condition)
            motions += new
            origins += [condition] * len(new)
        return motions, origins

    def _motion(self, name: str, condition: AnyCondition) -> list[PrescribedMotion]:
        """What a condition prescribes of the displacement."""
        if isinstance(condition, PointCondition):
            node = self._node(condition.at)
            given = condition.along(self._axes)
            return [Translation(name, np.array([self._dim * node + axis]), value) for axis, value in given.items()]
        if isinstance(condition, DisplacementCondition):
            facets, given = self._facets(condition), condition.along(self._axes)
            return [Translation(name, self._unknowns(facets, axis), value) for axis, value in given.items()]
        if isinstance(condition, ClampCondition):
            facets = self._facets(condition)
            return [Translation(name, self._unknowns(facets, axis), 0.0) for axis in range(self._dim)]
        if isinstance(condition, RotationCondition):
            facets = self._facets(condition)
            nodes = np.unique(facets)
            turned: list[PrescribedMotion] = [Rotation(name, nodes, self._mesh.nodes[nodes], condition.angle)]
            return turned + ([Translation(name, self._unknowns(facets, 2), 0.0)] if condition.axial == "held" else [])
        return []

    def _load(self, condition: PressureCondition | TractionCondition | ForceCondition) -> tuple[FactoredForce, float]:
        """A load, and its size at the factor one."""
        facets = self._facets(condition)
        if isinstance(condition, PressureCondition) and condition.follows:
            return FollowerPressure(self._body.space, facets, self._body.pattern, condition.pressure), condition.pressure
        points = self._body.space.surface_points(facets)
        if isinstance(condition, PressureCondition):
            traction = -condition.pressure * points.normals
        else:
            area = float(points.weights.sum()) if isinstance(condition, ForceCondition) else 1.0
            traction = np.zeros_like(points.normals)
            for axis, value in condition.along(self._axes).items():
                traction[axis] = value / area
        return DeadTraction(self._surface(points), traction, len(self._body.pattern.indices)), 1.0

    def _contact(self, condition: ContactCondition) -> MovedContact:
        """A rigid body at first touch."""
        points = self._body.space.surface_points(self._facets(condition))
        axis = SIDES[self._problem.dimension][condition.side]
        body = condition.body if axis[-1] == 1.0 else Turned.of(condition.body, axis)
        away, origin = np.array(axis), np.zeros(self._dim) if condition.at is None else np.array(condition.at)
        nodes = self._mesh.nodes[np.unique(self._facets(condition))].T
        reference = points.interpolate(self._mesh.nodes)
        begin = origin + (FAR * self._size + float((away @ nodes).max()) - away @ origin) * away
        place = first_touch(body, np.hstack([nodes, reference]), begin=begin, direction=-away, size=self._size)
        if place is None:
            raise InputError(f"the {condition.body.kind} that comes from the {condition.side} does not meet {condition.face}")
        contact = PosedContact.apart(self._surface(points), reference, ContactPair(body, condition.law), place)
        displacement = np.zeros(self._dim)
        for number, value in (condition.along(self._axes) if condition.moves else {}).items():
            displacement[number] = value
        return MovedContact(contact, displacement)

    def _surface(self, points: SurfacePoints) -> SurfaceAssembly:
        return SurfaceAssembly(points, self._body.pattern, self._dim)

    def _facets(self, condition: FaceCondition) -> Array:
        """The facets of a face, or of the part of it that the condition means."""
        facets = face_of(self._domain, condition.face)
        for name, (low, high) in (condition.within or {}).items():
            if name not in self._axes:
                raise InputError(f"within: there is no coordinate {name}; allowed: {', '.join(self._axes)}")
            along, slack = self._mesh.nodes[facets][..., self._axes.index(name)], AT_NODE * self._size
            facets = facets[((along >= low - slack) & (along <= high + slack)).all(axis=1)]
        if not len(facets):
            raise InputError(
                f"no facet of {condition.face} lies within {condition.within}; let cells end there, or take a wider part"
            )
        return facets

    def _unknowns(self, facets: Array, axis: int) -> Array:
        return self._dim * np.unique(facets) + axis

    def _node(self, place: Sequence[float]) -> int:
        """The node at a place in m."""
        check_place(place, self._axes)
        distance = np.linalg.norm(self._mesh.nodes - np.asarray(place), axis=1)
        node = int(distance.argmin())
        if distance[node] > AT_NODE * self._size:
            away = format_quantity(float(distance[node]), "m")
            raise InputError(
                f"no node of the mesh lies at {place_in_words(place)}; the nearest is {away} away: let cells end there"
            )
        return node


def face_of(domain: Domain, name: str) -> Array:
    """Facets of a face by its name.

    Raises
    ------
    InputError
        If there is no such face.
    """
    if name not in domain.faces:
        raise InputError(f"the body has no face {name!r}; it has {', '.join(domain.faces)}")
    return domain.faces[name]


def check_place(place: Sequence[float], axes: tuple[str, ...]) -> None:
    """Check that a place has as many coordinates as the problem.

    Raises
    ------
    InputError
        If it has not.
    """
    if len(place) != len(axes):
        raise InputError(f"the point {place_in_words(place)} has {len(place)} coordinates; needed: {', '.join(axes)}")
