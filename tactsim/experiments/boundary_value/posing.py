"""From the words of a case to the finite element model: faces to nodes and facets, conditions to motions and loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeGuard

import numpy as np

from tactsim.contact.penalty import Augmentation, Regularisation
from tactsim.contact.traction import ContactPair
from tactsim.experiments.boundary_value.conditions import (
    BodyForceCondition,
    Condition,
    ContactCondition,
    ForceCondition,
    PressureCondition,
    TractionCondition,
)
from tactsim.experiments.boundary_value.motions import Held, motions_of
from tactsim.experiments.boundary_value.parts import AT_NODE, Parts
from tactsim.experiments.boundary_value.setup import BoundaryValueSetup
from tactsim.experiments.boundary_value.touch import touch_of
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.dead_load import DeadLoad, weight_of
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.assembly.space import SurfacePoints
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.mechanics.contact.contact_steps import lying_on
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.models.loaded_body import Conditions, FactoredForce, LoadedBody, MovedContact
from tactsim.mechanics.models.prescribed_motion import PrescribedMotions
from tactsim.mechanics.models.solid_model import PATIENCE

SWITCH_SHARE = 0.03
"""Length over which a violated contact counts as much as the largest pressure, as a part of the body's size."""
SOFTNESS = 2.5e-3
"""Penetration that the penalty of friction would leave without multipliers, over the body's size: a part of a small cell."""
WIDEST = 1e-2
"""Penetration at which a state that Newton does not find at once is approached, over the body's size: with it Newton finds
round bodies on coarse cells from far away, and from there to a tenth of it hardly a point opens or closes."""
EXACT_STEPS = NewtonOptions(largest_inexactness=1e-9, last_inexactness=1e-9)
"""Of bodies without contact under a pressure that follows their faces. As a tension it makes a free face unstable, so that
uneven equilibria are near, and what an inexact step leaves leads to them: a uniform cube became uneven in its first step. Dead
loads do not; a block of 73 000 unknowns under one takes two thirds of the time with inexact steps."""

Load = PressureCondition | TractionCondition | ForceCondition | BodyForceCondition


@dataclass(frozen=True)
class PosedProblem:
    """The model, the parts of its mesh, the motions of their nodes, and the conditions that load them and touch them."""

    model: LoadedBody
    parts: Parts
    held: tuple[Held, ...]
    loads: tuple[Load, ...]
    contacts: tuple[ContactCondition, ...]

    @property
    def followed(self) -> tuple[Condition | None, ...]:
        """The condition that each factor of the model belongs to, None if nothing moves it."""
        return (
            *(one.condition for one in self.held),
            *self.loads,
            *(one for contact in self.contacts for one in contact.moving.values()),
        )


def posed(problem: BoundaryValueSetup) -> PosedProblem:
    """The model of a problem, which was checked as it was read: the body has what its conditions name."""
    return _Posing(problem).posed()


class _Posing:
    """Looks up what the conditions of a problem name."""

    def __init__(self, problem: BoundaryValueSetup):
        self._problem, self._parts = problem, problem.parts
        mesh = self._parts.domain.mesh
        self._mesh, self._dim = mesh, mesh.dim
        self._body = Body(self._parts.space, list(problem.materials.values()), mesh.regions)
        self._size = self._parts.size

    def posed(self) -> PosedProblem:
        """The whole model."""
        held = motions_of(self._parts, self._problem.conditions)
        forces = tuple(one for one in self._problem.conditions if isinstance(one, Load))
        loads, units = zip(*map(self._load, forces), strict=True) if forces else ((), ())
        contacts = tuple(map(self._contact, self._problem.contacts))
        prescribed = PrescribedMotions([one.motion for one in held], self._size)
        conditions = Conditions(prescribed, len(held), loads, units, contacts)
        model = LoadedBody(self._mesh, self._body, conditions, self._regularisation(contacts), options=self._options(forces))
        return PosedProblem(model, self._parts, tuple(held), forces, self._problem.contacts)

    def _options(self, forces: Sequence[Load]) -> NewtonOptions:
        """Of Newton's method, for a body under these forces."""
        if self._problem.contacts:
            return PATIENCE
        return EXACT_STEPS if any(map(_follows, forces)) else NewtonOptions()

    def _regularisation(self, contacts: Sequence[MovedContact]) -> Regularisation:
        """A penalty as stiff as the penetration asks; a soft one and multipliers where a whole face is about to stick or slip.

        Why: under faces that meet all at once every point chooses between stick and slip in the same step, and Newton cycles with
        a stiff penalty; where a round body rolls on, points close one by one, and multipliers lag behind.
        """
        tolerance, modulus = self._problem.largest_penetration(self._size), self._problem.stiffest
        rubbing = [contact.posed for contact in contacts if contact.posed.pair.has_friction]
        if rubbing and all(self._conforms(contact) for contact in rubbing):
            return Augmentation(tolerance, modulus, SWITCH_SHARE * self._size, softness=SOFTNESS * self._size)
        return Regularisation(tolerance, modulus, SWITCH_SHARE * self._size, widest=WIDEST * self._size)

    def _conforms(self, contact: PosedContact) -> bool:
        """Whether all points of a face are equally far from the rigid body."""
        gap = contact.pair.body.signed_distance(contact.reference - contact.place[:, None])[0]
        return float(np.ptp(gap)) <= AT_NODE * self._size

    def _load(self, condition: Load) -> tuple[FactoredForce, float]:
        """A load, and its size at the factor one."""
        if isinstance(condition, BodyForceCondition):
            return DeadLoad(weight_of(self._body, np.array(condition.vector(self._parts.axes)))), 1.0
        facets = self._parts.facets(condition)
        if _follows(condition):
            return FollowerPressure(self._body.space, facets, self._body.pattern, condition.pressure), condition.pressure
        points = self._body.space.surface_points(facets)
        if isinstance(condition, PressureCondition):
            traction = -condition.pressure * points.normals
        else:
            area = float(points.weights.sum()) if isinstance(condition, ForceCondition) else 1.0
            traction = np.zeros_like(points.normals) + np.array(condition.vector(self._parts.axes))[:, None] / area
        return DeadLoad(self._surface(points).force(traction)), 1.0

    def _contact(self, condition: ContactCondition) -> MovedContact:
        """A rigid body at first touch."""
        touch = touch_of(self._parts, condition)
        pair = ContactPair(touch.body, condition.law)
        contact = PosedContact.apart(self._surface(touch.points), touch.reference, pair, touch.place)
        if self._conforms(contact):  # and touches, as it is posed where it first does
            contact = lying_on(contact)
        displacements = [motion.vector(self._parts.axes) for motion in condition.moving.values()]
        return MovedContact(contact, np.reshape(displacements, (-1, self._dim)))

    def _surface(self, points: SurfacePoints) -> SurfaceAssembly:
        return SurfaceAssembly(points, self._body.pattern, self._dim)


def _follows(condition: Load) -> TypeGuard[PressureCondition]:
    """Whether it is a pressure that follows the deformed face."""
    return isinstance(condition, PressureCondition) and condition.follows
