"""Tissue on a base with rigid bodies above it, in a section or in 3D: what both have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tactsim.array import Array
from tactsim.contact.penalty import Regularisation
from tactsim.contact.traction import ContactPair, ContactState
from tactsim.errors import InputError
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.external_forces import FollowerLoad
from tactsim.fem.assembly.space import Measure, TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.assembly.volume_stiffness import VOLUME_STIFFNESS
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.interfaces import ContactLaw, Material, RigidBody
from tactsim.materials.mirrored import check_in_plane
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.contact_solution import Action
from tactsim.mechanics.contact.first_touch import FAR, first_touch
from tactsim.mechanics.contact.guarantee import guaranteed_equilibrium
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.result import FieldFrame


class PressedModel(ABC):
    """Tissue on a base with rigid bodies above it that move down together, along the last coordinate.

    Parameters
    ----------
    mesh : its last coordinate is the height
    materials : one per region of the mesh
    base : "fixed" or "slipping"
    top : (F, n) facets of the tissue that may touch
    measure : what the mesh stands for
    mirrors : coordinates that are zero on planes of symmetry
    options : of Newton's method

    Raises
    ------
    InputError
        If the mesh is a section and a material shears it out of its plane.
    """

    def __init__(
        self,
        mesh: QuadraticMesh,
        materials: Sequence[Material],
        *,
        base: str,
        top: Array,
        measure: Measure,
        mirrors: Sequence[int],
        options: NewtonOptions | None = None,
    ):
        for material in materials if mesh.dim == 2 else ():
            check_in_plane(material)
        self.mesh, self.top, self.base = mesh, top, base
        self.space = TaylorHood(mesh.nodes, mesh.elements, measure, mesh.regions)
        self.body = Body(self.space, materials, mesh.regions, volume_stiffness=VOLUME_STIFFNESS)
        dim = self.space.dim
        self.points = self.space.surface_points(top)
        self.surface = SurfaceAssembly(self.points, self.body.pattern, dim)
        self.reference = self.points.interpolate(mesh.nodes)
        height = mesh.nodes[:, -1]
        self.base_nodes = np.flatnonzero(height <= height.min() * (1 - 1e-9))
        held = [dim * np.flatnonzero(mesh.nodes[:, axis] == 0.0) + axis for axis in mirrors]
        held += [dim * self.base_nodes + axis for axis in (range(dim) if base == "fixed" else (dim - 1,))]
        self.problem = Problem(self.body, np.unique(np.concatenate(held)), options=options or NewtonOptions())
        self.down = -np.eye(dim)[-1]

    @property
    @abstractmethod
    def images(self) -> Array:
        """What a force (d,) on the part that is computed is multiplied by for the whole tissue."""

    @abstractmethod
    def rise(self, state: ContactEquilibrium, radius: float) -> tuple[float, float]:
        """Largest height in m of the tissue within ``radius`` of the first body's axis above its face, and that on its axis."""

    @abstractmethod
    def frame(self, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None) -> FieldFrame:
        """Fields of a state for ParaView; ``time`` in s, ``isochoric`` (6, E, Q) in Pa; see `section_frame` and `solid_frame`."""

    def touching_place(self, body: RigidBody) -> Array:
        """Place (d,) in m of the body's reference point at which it first touches the undeformed surface.

        Raises
        ------
        InputError
            If it passes beside the tissue.
        """
        points = np.hstack([self.mesh.nodes[np.unique(self.top)].T, self.reference])
        size = float(np.ptp(self.mesh.nodes, axis=0).max())
        place = first_touch(body, points, begin=-FAR * size * self.down, direction=self.down, size=size)
        if place is None:
            raise InputError(f"the {body.kind} does not meet the tissue")
        return place

    def start(self, body: RigidBody, place: Array, law: ContactLaw, regularisation: Regularisation) -> ContactEquilibrium:
        """The undeformed tissue under a body with its reference point at ``place`` (d,) in m."""
        contact = PosedContact.apart(self.surface, self.reference, ContactPair(body, law), place)
        return ContactEquilibrium.at_rest(self.body, (contact,), regularisation)

    def with_body(self, state: ContactEquilibrium, body: RigidBody, law: ContactLaw, place: Array) -> ContactEquilibrium:
        """A state with one more body at ``place`` (d,) in m, clear of where the tissue is now."""
        points = self.reference + self.displacement(state.unknowns) - place[:, None]
        untouched = ContactState.untouched(points, body.signed_distance(points)[1])
        contact = PosedContact(self.surface, self.reference, ContactPair(body, law), place, untouched)
        return replace(state, contacts=(*state.contacts, contact))

    def equilibrium(
        self,
        state: ContactEquilibrium,
        load: float,
        guess: Array,
        *,
        force: float | None = None,
        relaxation: RelaxationStep | None = None,
        loads: Sequence[FollowerLoad] = (),
    ) -> ContactEquilibrium:
        """Equilibrium with the bodies moved down by ``load`` in m, their penetration below the tolerance.

        Parameters
        ----------
        guess : (size,) unknowns from which Newton starts
        force : in N; with it the bodies move on from ``load`` until they press so hard
        relaxation : coefficients of the time step of materials that relax
        loads : what else acts on the tissue

        Raises
        ------
        ConvergenceError
            If Newton fails, or no penalty keeps the tissue out of the bodies.
        """
        directions = (self.down,) * len(state.contacts)
        return guaranteed_equilibrium(self.problem, state, load, guess, Action(directions, force, relaxation, loads))

    def displacement(self, unknowns: Array) -> Array:
        """Displacements (d, n) in m of the surface points."""
        return self.points.interpolate(self.space.split(unknowns)[0])

    def force(self, traction: Array) -> Array:
        """Force (d,) in N of the whole tissue on the body that exerts a traction (d, n) in Pa on the surface points."""
        return -self.images * self.surface.total(traction) + 0.0

    def base_force(self, state: ContactEquilibrium) -> Array:
        """Force (d,) in N of the base on the whole tissue in an accepted state."""
        assert state.reactions is not None, "of accepted states only"
        return self.images * state.reactions.reshape(-1, self.space.dim)[self.base_nodes].sum(axis=0)
