"""The finite element model of an indentation: tissue section, rigid bodies, and one step of the path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tactsim.contact.penalty import Regularisation
from tactsim.contact.traction import ContactPair
from tactsim.fem.body import Body, PastStress
from tactsim.fem.newton import Problem
from tactsim.fem.space import Measure, TaylorHood
from tactsim.fem.surface import SurfaceAssembly
from tactsim.interfaces import ContactLaw, Material, RigidBody
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium, contact_equilibrium
from tactsim.mechanics.posed_contact import PosedContact
from tactsim.mesh.adaptation import Refinement, refined
from tactsim.mesh.axisymmetric import Size
from tactsim.mesh.quadratic import QuadraticMesh

Array = np.ndarray

DOWN = np.array([0.0, -1.0])


class IndentationModel:
    """Tissue on a base with rigid bodies above it that move down together.

    Parameters
    ----------
    mesh : section of an axisymmetric or, in plane strain, of a symmetric body; r >= 0
    materials : one per region of the mesh
    base : "fixed" or "slipping"
    top : (F, 3) facets of the tissue that may touch
    measure : what the section stands for; in plane strain forces are those of the half r >= 0 per m of depth
    """

    def __init__(
        self, mesh: QuadraticMesh, materials: Sequence[Material], *, base: str, top: Array, measure: Measure = "axisymmetric"
    ):
        self.mesh, self.top, self.base = mesh, top, base
        self.space = TaylorHood(mesh.nodes, mesh.elements, measure)
        self.body = Body(self.space, materials, mesh.regions)
        self.points = self.space.surface_points(top)
        self.surface = SurfaceAssembly(self.points, self.body.pattern, self.space.dim)
        self.reference = self.points.interpolate(mesh.nodes)
        self.base_nodes = np.flatnonzero(mesh.nodes[:, 1] <= mesh.nodes[:, 1].min() * (1 - 1e-9))
        axis = np.flatnonzero(mesh.nodes[:, 0] == 0.0)
        held = [2 * self.base_nodes + 1, 2 * axis]
        self.problem = Problem(self.body, np.concatenate([*held, 2 * self.base_nodes] if base == "fixed" else held))

    def touching_height(self, body: RigidBody) -> float:
        """Height in m of the body's reference point at which it first touches the undeformed surface."""
        low, high = -float(np.ptp(self.mesh.nodes[:, 1])), float(np.ptp(self.mesh.nodes[:, 1]))
        points = self._surface_samples()
        for _ in range(200):
            middle = (low + high) / 2
            gap = body.signed_distance(points - np.array([[0.0], [middle]]))[0].min()
            low, high = (low, middle) if gap > 0 else (middle, high)
        return high

    def _surface_samples(self) -> Array:
        """Points (2, n) on the undeformed top: nodes and quadrature points."""
        return np.hstack([self.mesh.nodes[np.unique(self.top)].T, self.reference])

    def start(
        self, bodies: Sequence[tuple[RigidBody, float]], law: ContactLaw, regularisation: Regularisation
    ) -> ContactEquilibrium:
        """The undeformed tissue under bodies, each with the height in m of its reference point."""
        contacts = tuple(self.contact(body, law, height) for body, height in bodies)
        unknowns = np.zeros(self.space.size)
        return ContactEquilibrium(0.0, unknowns, 0, 0.0, contacts, regularisation, self.body.kinematics(unknowns))

    def contact(self, body: RigidBody, law: ContactLaw, height: float) -> PosedContact:
        """A body above the tissue that has not touched it."""
        return PosedContact.apart(self.surface, self.reference, ContactPair(body, law), np.array([0.0, height]))

    def with_contact(self, state: ContactEquilibrium, contact: PosedContact) -> ContactEquilibrium:
        """A state with one more body, which starts from the points where the tissue is now."""
        committed = contact.committed(self.displacement(state.unknowns))
        return replace(state, contacts=(*state.contacts, committed))

    def advance(self, state: ContactEquilibrium, load: float, guess: Array) -> ContactEquilibrium:
        """Equilibrium with the bodies at displacement ``load``, its penetration below the tolerance.

        Raises
        ------
        ConvergenceError
            If Newton fails, or no penalty keeps the tissue out of the bodies.
        """
        return self.equilibrium(state, load, guess)

    def equilibrium(
        self, state: ContactEquilibrium, load: float, guess: Array, *, force: float | None = None, past: PastStress | None = None
    ) -> ContactEquilibrium:
        """As ``advance``; with a ``force`` in N the bodies move on from ``load`` until they press so hard.

        ``past`` is what materials that relax remember.
        """
        directions = (DOWN,) * len(state.contacts)
        return contact_equilibrium(self.problem, state, load, guess, directions=directions, force=force, past=past)

    def too_coarse(self, state: ContactEquilibrium, size: Size, factor: float) -> Array:
        """Elements (numbers) whose longest deformed edge exceeds ``factor`` times the size wanted where it is now."""
        place = state.contacts[0].place
        deformed = self.mesh.nodes + self.space.split(state.unknowns)[0] - place
        corners = deformed[self.mesh.elements[:, :3]]
        edges = corners - np.roll(corners, 1, axis=1)
        middles = corners - edges / 2
        wanted = size(middles.reshape(-1, 2)).reshape(-1, 3)
        return np.flatnonzero((np.linalg.norm(edges, axis=2) > factor * wanted).any(axis=1))

    def refined(self, state: ContactEquilibrium, marked: Array) -> tuple[IndentationModel, ContactEquilibrium, Refinement]:
        """A model with these elements split, and the same state on it: nested spaces lose nothing of the displacement."""
        u, p = self.space.split(state.unknowns)
        split = refined(self.mesh, marked, self.mesh.nodes + u)
        top = split.facets_on(self.mesh, self.top)
        model = IndentationModel(split.mesh, self.body.materials, base=self.base, top=top, measure=self.space.measure)
        unknowns = np.concatenate([(split.nodal @ u).ravel(), split.corner @ p])
        displacement = model.displacement(unknowns)
        contacts = tuple(contact.on(model.surface, model.reference, displacement) for contact in state.contacts)
        kinematics = model.body.kinematics(unknowns)
        return model, replace(state, unknowns=unknowns, contacts=contacts, kinematics=kinematics), split

    def displacement(self, unknowns: Array) -> Array:
        """Displacements (2, n) in m of the surface points."""
        return self.points.interpolate(self.space.split(unknowns)[0])

    def base_force(self, unknowns: Array, past: PastStress | None = None) -> Array:
        """Resultant (2,) in N of the internal forces on the base nodes."""
        internal = self.body.with_past(past).residual(unknowns)[: self.space.displacement_size].reshape(-1, 2)
        return internal[self.base_nodes].sum(axis=0)

    def highest(self, unknowns: Array, radius: float) -> tuple[float, float]:
        """Largest height of the tissue within ``radius`` of the axis, and its height on the axis, in m.

        Exact for the quadratic edges: their vertices of parabola count beside the nodes.
        """
        positions = self.mesh.nodes + self.space.split(unknowns)[0]
        first, second, middle = (positions[self.top[:, k]] for k in range(3))
        slope = 4 * middle - 3 * first - second
        bend = 2 * first + 2 * second - 4 * middle
        flat = np.abs(bend[:, 1]) < 1e-300
        at = np.clip(np.where(flat, 0.0, -slope[:, 1] / np.where(flat, 1.0, 2 * bend[:, 1])), 0.0, 1.0)[:, None]
        candidates = np.vstack([first, second, middle, first + at * (slope + at * bend)])
        inside = candidates[candidates[:, 0] <= radius]
        return float(inside[:, 1].max()), float(inside[np.argmin(inside[:, 0]), 1])
