"""The finite element model of tissue in 3D, or of a part of it between mirror planes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.interfaces import Material
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.fields.solid_fields import solid_frame
from tactsim.mechanics.fields.surface_peaks import surface_peaks
from tactsim.mechanics.models.pressed_model import PressedModel
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.mesh.revolved import SweepSymmetry
from tactsim.results.result import FieldFrame

PATIENCE = NewtonOptions(max_iterations=40, patience=12)
"""Of contact in 3D, where friction settles slowly: the direction of slip is an unknown too."""


class SolidModel(PressedModel):
    """Tissue in 3D; the first body touches it at the origin of x and y, where the top is at z = 0.

    ``symmetry`` says which part of the body the mesh is.
    """

    def __init__(self, mesh: QuadraticMesh, materials: Sequence[Material], *, base: str, top: Array, symmetry: SweepSymmetry):
        self.symmetry = symmetry
        super().__init__(mesh, materials, base=base, top=top, measure="solid", mirrors=symmetry.value, options=PATIENCE)

    @property
    def images(self) -> Array:
        """Images of the part along each axis (3,), less those that cancel."""
        return self.symmetry.mirrors.sum(axis=0)

    def frame(self, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None) -> FieldFrame:
        """Fields of a state for ParaView; ``time`` in s, ``isochoric`` (6, E, Q) in Pa as in `cauchy_stress`."""
        return solid_frame(self.mesh, self.body, state, time=time, isochoric=isochoric)

    def moment(self, contact: PosedContact, unknowns: Array) -> Array:
        """Moment (3,) in N m of the force of the whole tissue on a body about the body's reference point."""
        traction = -contact.state.traction
        arms = self.reference + self.displacement(unknowns) - contact.place[:, None]
        moment = np.cross(arms.T, traction.T).T @ self.points.weights
        mirrors = self.symmetry.mirrors
        return (mirrors * mirrors.prod(axis=1)[:, None]).sum(axis=0) * moment + 0.0

    def surroundings(self, contact: PosedContact, unknowns: Array, sectors: int) -> Array:
        """Force (sectors,) in N of the whole tissue along a body's axis, by the angle about it, from its own x axis on."""
        traction = -contact.state.traction
        points = self.reference + self.displacement(unknowns) - contact.place[:, None]
        force = np.zeros(sectors)
        for mirror in self.symmetry.mirrors:
            place = contact.pair.body.own_coordinates(mirror[:, None] * points)  # type: ignore[attr-defined]
            along = contact.pair.body.own_coordinates(mirror[:, None] * traction)[2]  # type: ignore[attr-defined]
            angle = np.arctan2(place[1], place[0]) % (2 * np.pi)
            sector = np.minimum((angle / (2 * np.pi) * sectors).astype(int), sectors - 1)
            force += np.bincount(sector, along * self.points.weights, sectors)
        return force

    def rise(self, state: ContactEquilibrium, radius: float) -> tuple[float, float]:
        """Largest height in m of the tissue within ``radius`` of the first body's axis above its face, and that nearest to the
        axis.

        Exact for the quadratic facets: their vertices of parabola count beside the nodes.
        """
        contact = state.contacts[0]
        deformed = self.mesh.nodes + self.space.split(state.unknowns)[0] - contact.place
        surface = contact.pair.body.own_coordinates(deformed.T).T  # type: ignore[attr-defined]
        candidates = surface_peaks(surface[self.top])
        away = np.hypot(candidates[:, 0], candidates[:, 1])
        return float(candidates[away <= radius, 2].max()), float(candidates[np.argmin(away), 2])
