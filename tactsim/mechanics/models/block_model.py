"""The finite element model of a grasp: a block of tissue with inclusions between two jaws that close along z."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from tactsim.array import Array
from tactsim.contact.jaw import Jaw
from tactsim.contact.penalty import Regularisation
from tactsim.contact.traction import ContactPair
from tactsim.errors import InputError
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.external_forces import FollowerLoad
from tactsim.fem.assembly.regularising_springs import RegularisingSprings
from tactsim.fem.assembly.space import FACET_POINTS, TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.assembly.volume_stiffness import block_volume_stiffness
from tactsim.fem.equilibrium.mirrored_part import SAME_PLACE, mirrored_part
from tactsim.fem.equilibrium.mirrored_problem import MirroredProblem, free_problem
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.interfaces import ContactLaw, Material
from tactsim.interfaces.solid import FACES
from tactsim.interfaces.taxel_layout import JAWS, OUTWARD, TaxelLayout
from tactsim.materials.mirrored import law_mirrors
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.contact_solution import Action
from tactsim.mechanics.contact.first_touch import FAR, first_touch
from tactsim.mechanics.contact.guarantee import guaranteed_equilibrium
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.contact.surface_forces import TaxelForces, taxel_forces
from tactsim.mechanics.contact.traction_recovery import recovered_forces
from tactsim.mechanics.fields.solid_fields import solid_frame
from tactsim.mechanics.models.first_guess import compressed, with_lumps
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.result import FieldFrame

CLOSING = {side: np.array([0.0, 0.0, -OUTWARD[side]]) for side in JAWS}
"""Directions in which the jaws close."""
START_PATIENCE = 6
"""Iterations in which Newton halves the residual where it finds to the equilibrium: three in most closings, five in few cells."""


class GraspModel:
    """A block from (0, 0, 0) to its size, a jaw above and one below it.

    Parameters
    ----------
    mesh : tetrahedra
    materials : one per region of the mesh
    facets : facets (F, 6) by name; a jaw may touch those of "upper" or "lower", and those of the other faces, as far as they are
        given, in its half of the block: free faces bulge out beside the jaws and roll onto them
    jaws : the upper and the lower jaw
    offsets : (2, 2) places of the middles of their faces in x and y, in m
    balance : residual at which Newton ends
    """

    def __init__(
        self,
        mesh: QuadraticMesh,
        materials: Sequence[Material],
        facets: Mapping[str, Array],
        *,
        jaws: Sequence[Jaw],
        offsets: Array,
        balance: float = NewtonOptions.tolerance,
    ):
        self.mesh, self.jaws, self.facets = mesh, dict(zip(JAWS, jaws, strict=True)), facets
        self.space = TaylorHood(mesh.nodes, mesh.elements, "solid", mesh.regions)
        pressed = min(min(jaw.width, jaw.depth) - 2 * jaw.fillet for jaw in jaws)
        stiffness = block_volume_stiffness(mesh.nodes, mesh.elements, pressed)
        self.body = Body(self.space, materials, mesh.regions, volume_stiffness=stiffness)
        self.touchable = touchable_facets(mesh.nodes, facets)
        points = {side: self.space.surface_points(self.touchable[side]) for side in JAWS}
        self.surfaces = {side: SurfaceAssembly(points[side], self.body.pattern, 3) for side in JAWS}
        self.references = {side: points[side].interpolate(mesh.nodes) for side in JAWS}
        self.offsets = {side: np.asarray(offset, float) for side, offset in zip(JAWS, offsets, strict=True)}
        self.problem = self._posed(NewtonOptions(tolerance=balance, start_patience=START_PATIENCE))
        self.springs = RegularisingSprings(self.body)

    def _posed(self, options: NewtonOptions) -> Problem:
        """The problem of the block, or of a part of it that stands for the whole."""
        part = mirrored_part(self.body, self._axes_across_mirrors())
        return free_problem(self.body, options) if part is None else MirroredProblem(part, options=options)

    def _axes_across_mirrors(self) -> list[int]:
        """Axes across which the middle plane mirrors the laws, and the jaws where they touch onto themselves or one another."""
        try:
            places = {side: self.touching_place(side)[:, None] for side in JAWS}
        except InputError:  # which the start says
            return []
        low, high = self.mesh.nodes.min(axis=0), self.mesh.nodes.max(axis=0)
        gaps = {side: self.jaws[side].signed_distance(self.references[side] - places[side])[0] for side in JAWS}

        def mirrors(axis: int) -> bool:
            apart = []
            for side, other in zip(JAWS, reversed(JAWS) if axis == 2 else JAWS, strict=True):
                mirrored = self.references[side].copy()
                mirrored[axis] = low[axis] + high[axis] - mirrored[axis]
                apart.append(np.abs(gaps[side] - self.jaws[other].signed_distance(mirrored - places[other])[0]).max())
            return bool(max(apart) <= SAME_PLACE * (high - low).max())

        laws = [axis for axis in range(3) if all(law_mirrors(material, axis) for material in self.body.materials)]
        return [axis for axis in laws if mirrors(axis)]

    def touching_place(self, side: str) -> Array:
        """Place (3,) in m of a jaw's middle at which it first touches the undeformed block.

        Raises
        ------
        InputError
            If it passes beside the block.
        """
        direction, size = CLOSING[side], float(np.ptp(self.mesh.nodes, axis=0).max())
        samples = np.hstack([self.mesh.nodes[np.unique(self.touchable[side])].T, self.references[side]])
        begin = np.array([*self.offsets[side], self.mesh.nodes[:, 2].mean()]) - FAR * size * direction
        place = first_touch(self.jaws[side], samples, begin=begin, direction=direction, size=size)
        if place is not None:
            return place
        raise InputError(f"the {side} jaw does not meet the block; its middle is at {self.offsets[side].tolist()} m in x and y")

    def start(self, law: ContactLaw, regularisation: Regularisation) -> ContactEquilibrium:
        """The undeformed block between jaws that just touch it.

        Raises
        ------
        InputError
            If a jaw does not meet the block.
        """
        contacts = tuple(
            PosedContact.apart(
                self.surfaces[side],
                self.references[side],
                ContactPair(self.jaws[side], law, friction_mask=self._friction_mask(side)),
                self.touching_place(side),
            )
            for side in JAWS
        )
        return ContactEquilibrium.at_rest(self.body, contacts, regularisation)

    def compressed(self, closing: float) -> Array:
        """Unknowns (size,) that Newton starts from in the undeformed block, each jaw's face closed by ``closing`` in m."""
        return self._moved(compressed(self.mesh, self.body.shear_moduli, closing))

    def begun_as(self, displacement: Array) -> Array:
        """Unknowns (size,) that Newton starts from where tissue without lumps has a ``displacement`` (n, 3) in m of the nodes."""
        return self._moved(with_lumps(self.mesh, self.body.shear_moduli, displacement))

    def _moved(self, displacement: Array) -> Array:
        unknowns = np.zeros(self.space.size)
        self.space.split(unknowns)[0][:] = displacement
        return unknowns

    def _friction_mask(self, side: str) -> Array:
        """One at the surface points (n,) of the face under a jaw, zero at those beside it, which roll onto it."""
        count = len(FACET_POINTS)
        friction_mask = np.zeros(len(self.touchable[side]) * count)
        friction_mask[: len(self.facets[side]) * count] = 1.0
        return friction_mask

    def equilibrium(
        self,
        state: ContactEquilibrium,
        closing: float,
        guess: Array,
        *,
        force: float | None = None,
        relaxation: RelaxationStep | None = None,
        loads: Sequence[FollowerLoad] = (),
    ) -> ContactEquilibrium:
        """The grasp with each jaw closed by ``closing`` in m, or on from there until each presses with a ``force`` in N.

        Newton starts from the ``guess`` (size,).

        Raises
        ------
        ConvergenceError
            If Newton fails, or no penalty keeps the tissue out of the jaws.
        """
        both = None if force is None else 2 * force
        action = Action([CLOSING[side] for side in JAWS], both, relaxation, [self.springs, *loads])
        return guaranteed_equilibrium(self.problem, state, closing, guess, action)

    def jaw_force(self, state: ContactEquilibrium, side: str) -> Array:
        """Force (3,) in N of the tissue on a jaw."""
        return -self.surfaces[side].total(self._traction(state, side))

    def taxels(self, state: ContactEquilibrium, side: str, layout: TaxelLayout) -> TaxelForces:
        """Forces in N of the tissue on the taxels of a jaw, in the jaw's own axes: z presses into its face."""
        jaw, surface = self.jaws[side], self.surfaces[side]
        traction = -jaw.rotation.T @ self._traction(state, side)
        count = len(FACET_POINTS)
        weights, facets = surface.points.weights.reshape(-1, count), self.touchable[side]
        forces = recovered_forces(facets, traction.reshape(3, -1, count) * weights, weights, FACET_POINTS)
        deformed = self.mesh.nodes + self.space.split(state.unknowns)[0]
        place = state.contacts[JAWS.index(side)].place
        faces = jaw.face_coordinates(deformed[facets.ravel()].T - place[:, None])
        return taxel_forces(layout, faces.T.reshape(-1, 6, 2), forces, FACET_POINTS)

    def frame(self, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None) -> FieldFrame:
        """Fields of a state for ParaView; ``time`` in s, ``isochoric`` (6, E, Q) in Pa as in `cauchy_stress`."""
        return solid_frame(self.mesh, self.body, state, time=time, isochoric=isochoric)

    def _traction(self, state: ContactEquilibrium, side: str) -> Array:
        """Traction (3, n) in Pa on the tissue at the surface points, that of the accepted state."""
        return state.contacts[JAWS.index(side)].state.traction


def touchable_facets(nodes: Array, facets: Mapping[str, Array]) -> dict[str, Array]:
    """Facets (F, 6) of a block that each jaw may touch, given nodes (n, 3) in m and facets by the names of their faces."""
    beside = np.concatenate([facets["upper"][:0], *(facets[name] for name, axis, _ in FACES if axis != 2 and name in facets)])
    higher = nodes[beside[:, :3], 2].mean(axis=1) > nodes[:, 2].mean()
    return {
        "upper": np.concatenate([facets["upper"], beside[higher]]),
        "lower": np.concatenate([facets["lower"], beside[~higher]]),
    }
