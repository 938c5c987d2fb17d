"""The finite element model of an indentation in space: the tissue or a part of it between mirror planes, and rigid bodies."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from enum import Enum

import numpy as np

from tactsim.contact.penalty import Regularisation
from tactsim.contact.tilted import Tilted
from tactsim.contact.traction import ContactPair, ContactState
from tactsim.fem.body import Body
from tactsim.fem.newton import NewtonOptions, Problem
from tactsim.fem.space import TaylorHood
from tactsim.fem.surface import SurfaceAssembly
from tactsim.interfaces import ContactLaw, Material
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium, contact_equilibrium
from tactsim.mechanics.posed_contact import PosedContact
from tactsim.mechanics.surface_peaks import surface_peaks
from tactsim.mesh.quadratic import QuadraticMesh

Array = np.ndarray

DOWN = np.array([0.0, 0.0, -1.0])
PATIENCE = NewtonOptions(max_iterations=40, patience=12)
"""Friction in space settles more slowly than in a section: the direction of slip is an unknown too."""


class SweepSymmetry(Enum):
    """The part of a body that is computed; its value names the axes that mirror planes are normal to."""

    WHOLE = ()
    HALF = (1,)
    QUARTER = (0, 1)

    @property
    def quarters(self) -> int:
        """Quarter turns of the part."""
        return 4 // 2 ** len(self.value)

    @property
    def mirrors(self) -> Array:
        """Signs (m, 3) of the coordinates of the m images that make up the whole."""
        choices = [(1.0, -1.0) if axis in self.value else (1.0,) for axis in range(3)]
        return np.array(list(itertools.product(*choices)))


class SpaceIndentationModel:
    """Tissue on a base with rigid bodies above it that move down together; the first touches at the origin of x and y.

    Parameters
    ----------
    mesh : tetrahedra, the top at z = 0 on the axis of the bodies
    materials : one per region of the mesh
    base : "fixed" or "slipping"
    top : (F, 6) facets of the tissue that may touch
    symmetry : the part of the body that the mesh is
    """

    def __init__(self, mesh: QuadraticMesh, materials: Sequence[Material], *, base: str, top: Array, symmetry: SweepSymmetry):
        self.mesh, self.top, self.symmetry = mesh, top, symmetry
        self.space = TaylorHood(mesh.nodes, mesh.elements, "solid")
        self.body = Body(self.space, materials, mesh.regions)
        self.points = self.space.surface_points(top)
        self.surface = SurfaceAssembly(self.points, self.body.pattern, 3)
        self.reference = self.points.interpolate(mesh.nodes)
        self.base_nodes = np.flatnonzero(mesh.nodes[:, 2] <= mesh.nodes[:, 2].min() * (1 - 1e-9))
        held = [3 * np.flatnonzero(mesh.nodes[:, axis] == 0.0) + axis for axis in symmetry.value]
        held += [3 * self.base_nodes + axis for axis in ((0, 1, 2) if base == "fixed" else (2,))]
        self.problem = Problem(self.body, np.unique(np.concatenate(held)), options=PATIENCE)

    def touching_height(self, body: Tilted) -> float:
        """Height in m of the body's reference point at which it first touches the undeformed surface."""
        size = float(np.ptp(self.mesh.nodes, axis=0).max())
        low, high = -size, size
        points = np.hstack([self.mesh.nodes[np.unique(self.top)].T, self.reference])
        while high - low > 1e-16 * size and low < (low + high) / 2 < high:
            middle = (low + high) / 2
            gap = body.signed_distance(points + middle * DOWN[:, None])[0].min()
            low, high = (low, middle) if gap > 0 else (middle, high)
        return high

    def start(
        self, bodies: Sequence[tuple[Tilted, Array]], law: ContactLaw, regularisation: Regularisation
    ) -> ContactEquilibrium:
        """The undeformed tissue under bodies, each with the place (3,) in m of its reference point."""
        contacts = tuple(self.contact(body, law, place) for body, place in bodies)
        unknowns = np.zeros(self.space.size)
        return ContactEquilibrium(0.0, unknowns, 0, 0.0, contacts, regularisation, self.body.kinematics(unknowns))

    def contact(self, body: Tilted, law: ContactLaw, place: Array) -> PosedContact:
        """A body above the tissue that has not touched it."""
        return PosedContact.apart(self.surface, self.reference, ContactPair(body, law), place)

    def with_contact(self, state: ContactEquilibrium, contact: PosedContact) -> ContactEquilibrium:
        """A state with one more body, which starts from the points where the tissue is now."""
        points = self.reference + self.displacement(state.unknowns) - contact.place[:, None]
        untouched = ContactState.untouched(points, contact.pair.body.signed_distance(points)[1])
        return replace(state, contacts=(*state.contacts, replace(contact, state=untouched)))

    def advance(self, state: ContactEquilibrium, load: float, guess: Array) -> ContactEquilibrium:
        """Equilibrium with the bodies moved down by ``load`` in m, their penetration below the tolerance.

        Raises
        ------
        ConvergenceError
            If Newton fails, or no penalty keeps the tissue out of the bodies.
        """
        return contact_equilibrium(self.problem, state, load, guess, directions=(DOWN,) * len(state.contacts))

    def displacement(self, unknowns: Array) -> Array:
        """Displacements (3, n) in m of the surface points."""
        return self.points.interpolate(self.space.split(unknowns)[0])

    def load_on(self, contact: PosedContact, unknowns: Array) -> tuple[Array, Array]:
        """Force (3,) in N of the whole tissue on a body, and its moment (3,) in N m about the body's reference point."""
        traction = -contact.at(self.displacement(unknowns)).traction
        arms = self.reference + self.displacement(unknowns) - contact.place[:, None]
        moment = np.cross(arms.T, traction.T).T @ self.points.weights
        mirrors = self.symmetry.mirrors
        turned = mirrors * mirrors.prod(axis=1)[:, None]
        return mirrors.sum(axis=0) * self.surface.total(traction) + 0.0, turned.sum(axis=0) * moment + 0.0

    def base_force(self, unknowns: Array) -> Array:
        """Resultant (3,) in N of the internal forces of the whole tissue on the base nodes."""
        internal = self.body.residual(unknowns)[: self.space.displacement_size].reshape(-1, 3)
        return self.symmetry.mirrors.sum(axis=0) * internal[self.base_nodes].sum(axis=0)

    def surroundings(self, contact: PosedContact, unknowns: Array, sectors: int) -> Array:
        """Force (sectors,) in N of the whole tissue along a body's axis, by the angle about it, from its own x axis on."""
        traction = -contact.at(self.displacement(unknowns)).traction
        points = self.reference + self.displacement(unknowns) - contact.place[:, None]
        found = np.zeros(sectors)
        for mirror in self.symmetry.mirrors:
            own = contact.pair.body.own_coordinates(mirror[:, None] * points)  # type: ignore[attr-defined]
            along = contact.pair.body.own_coordinates(mirror[:, None] * traction)[2]  # type: ignore[attr-defined]
            angle = np.arctan2(own[1], own[0]) % (2 * np.pi)
            sector = np.minimum((angle / (2 * np.pi) * sectors).astype(int), sectors - 1)
            found += np.bincount(sector, along * self.points.weights, sectors)
        return found

    def highest(self, unknowns: Array, contact: PosedContact, radius: float) -> tuple[float, float]:
        """Largest height in m of the tissue within ``radius`` of a body's axis above its face, and that nearest to the axis.

        Exact for the quadratic facets: their vertices of parabola count beside the nodes.
        """
        deformed = self.mesh.nodes + self.space.split(unknowns)[0] - contact.place
        own = contact.pair.body.own_coordinates(deformed.T).T  # type: ignore[attr-defined]
        candidates = surface_peaks(own[self.top])
        away = np.hypot(candidates[:, 0], candidates[:, 1])
        return float(candidates[away <= radius, 2].max()), float(candidates[np.argmin(away), 2])
