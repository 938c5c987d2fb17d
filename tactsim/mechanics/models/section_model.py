"""The finite element model of a section: of a body of revolution, or of one that is long out of the plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.space import Measure
from tactsim.interfaces import Material
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.contact_steps import transferred
from tactsim.mechanics.fields.point_values import cauchy_stress
from tactsim.mechanics.fields.section_fields import section_frame
from tactsim.mechanics.fields.surface_peaks import edge_peaks
from tactsim.mechanics.models.pressed_model import PressedModel
from tactsim.mesh.adaptation import Refinement, refined
from tactsim.mesh.axisymmetric import Size
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.fields import AXIAL_STRESS
from tactsim.results.result import FieldFrame


class SectionModel(PressedModel):
    """The section r >= 0 of an axisymmetric or, in plane strain, of a symmetric body.

    In plane strain forces are those of the half r >= 0 per m of depth.
    """

    def __init__(
        self, mesh: QuadraticMesh, materials: Sequence[Material], *, base: str, top: Array, measure: Measure = "axisymmetric"
    ):
        super().__init__(mesh, materials, base=base, top=top, measure=measure, mirrors=(0,))

    @property
    def images(self) -> Array:
        """One along each axis (2,): the section stands for all that it is a section of."""
        return np.ones(2)

    def frame(self, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None) -> FieldFrame:
        """Fields of a state for ParaView, with the normal stress in Pa along the motion, the mean of each element.

        ``time`` is in s, ``isochoric`` (6, E, Q) in Pa as in `cauchy_stress`.
        """
        frame = section_frame(self.mesh, self.body, state, time=time, isochoric=isochoric)
        stress = cauchy_stress(self.body, state.unknowns, state.kinematics, isochoric)[1, 1]
        return replace(frame, cell_data={**frame.cell_data, AXIAL_STRESS: stress.mean(axis=1)})

    def rise(self, state: ContactEquilibrium, radius: float) -> tuple[float, float]:
        """Largest height in m of the tissue within ``radius`` of the axis above the first body's face, and that on the axis."""
        face = float(state.contacts[0].place[1])
        highest, axis = self.highest(state.unknowns, radius)
        return highest - face, axis - face

    def too_coarse(self, state: ContactEquilibrium, size: Size, factor: float) -> Array:
        """Numbers (m,) of elements whose longest deformed edge exceeds ``factor`` times the size wanted where it is now."""
        place = state.contacts[0].place
        deformed = self.mesh.nodes + self.space.split(state.unknowns)[0] - place
        corners = deformed[self.mesh.elements[:, :3]]
        edges = corners - np.roll(corners, 1, axis=1)
        middles = corners - edges / 2
        wanted = size(middles.reshape(-1, 2)).reshape(-1, 3)
        return np.flatnonzero((np.linalg.norm(edges, axis=2) > factor * wanted).any(axis=1))

    def refined(self, state: ContactEquilibrium, marked: Array) -> tuple[SectionModel, ContactEquilibrium, Refinement]:
        """A model with the elements ``marked`` (m,) split, and the same state on it: nested spaces lose no displacement."""
        u, p = self.space.split(state.unknowns)
        split = refined(self.mesh, marked, self.mesh.nodes + u)
        top = split.facets_on(self.mesh, self.top)
        model = SectionModel(split.mesh, self.body.materials, base=self.base, top=top, measure=self.space.measure)
        pressure = np.empty(len(model.space.pressure_corners))
        pressure[model.space.pressures] = np.einsum("ecv,ev->ec", split.barycentric, p[self.space.pressures[split.parents]])
        unknowns = np.concatenate([(split.nodal @ u).ravel(), pressure])
        displacement = model.displacement(unknowns)
        contacts = tuple(transferred(contact, model.surface, model.reference, displacement) for contact in state.contacts)
        kinematics = model.body.kinematics(unknowns)
        return model, replace(state, unknowns=unknowns, contacts=contacts, kinematics=kinematics, reactions=None), split

    def highest(self, unknowns: Array, radius: float) -> tuple[float, float]:
        """Largest height of the tissue within ``radius`` of the axis, and on the axis, in m, at unknowns (size,).

        Exact for the quadratic edges: their vertices of parabola count beside the nodes.
        """
        positions = self.mesh.nodes + self.space.split(unknowns)[0]
        first, second, middle = (positions[self.top[:, k]] for k in range(3))
        candidates = np.vstack([first, second, middle, edge_peaks(first, second, middle)])
        inside = candidates[candidates[:, 0] <= radius]
        return float(inside[:, 1].max()), float(inside[np.argmin(inside[:, 0]), 1])
