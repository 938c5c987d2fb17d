"""The tissue of a grasp without its inclusions, closed on nearly as far: where Newton begins in the block with them.

It is solved once in a process for all grasps that differ in their inclusions alone, or little in friction and closing. What a
grasp begins with follows from its own case, so that it is the same wherever and after whatever it is computed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator, RegularGridInterpolator

from tactsim.array import Array
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.traction import ContactIterate
from tactsim.errors import Collapsed, ConvergenceError
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.regularisation import regularisation
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.experiments.grasp.time_settings import GraspTimeSettings
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.models.block_source import GradedSource
from tactsim.mechanics.models.first_guess import FIRST_PART
from tactsim.mechanics.paths.loading import close
from tactsim.model import FrozenModel

Part = TypeVar("Part", bound=FrozenModel)
RUNG = 1.25
"""Factor between the values of friction and of closings that are solved for."""
MORE_FRICTION = 1.25
"""Friction over that of the grasp.

Why: points that stick begin to slip in fewer systems than points that slip begin to stick, and the grasp's own limit cuts what
is too much. Over twelve samples at friction 0.6, that of 0.6 led to 76 systems and 548 solutions, 0.8 to 61 and 451."""
DIGITS = 9
"""Of a coordinate over the size of the block, by which nodes lie in one plane."""
KEPT = 64
"""Solutions that a process keeps, of some 100 kB each."""


@dataclass(frozen=True)
class TissueAlone:
    """Where tissue without inclusions goes, and what presses its faces, per closing in m.

    Attributes
    ----------
    displacements : from places (n, 3) in m to displacements (n, 3) in m
    forces : by side, from places (n, 2) in m on the face to pressure and tangential traction (n, 4) in Pa
    """

    displacements: RegularGridInterpolator
    forces: dict[str, _OnFace]

    def displacement(self, nodes: Array, closing: float) -> Array:
        """Displacements (n, 3) in m of nodes (n, 3) in m under a closing in m."""
        return closing * np.asarray(self.displacements(nodes))

    def expected_by(self, rest: ContactEquilibrium, closing: float) -> ContactEquilibrium:
        """The block at rest with contacts that expect these forces of the tissue after a closing in m."""
        contacts = (
            self._expecting(contact, self.forces[side], closing) for side, contact in zip(JAWS, rest.contacts, strict=True)
        )
        return replace(rest, contacts=tuple(contacts))

    @staticmethod
    def _expecting(contact: PosedContact, forces: _OnFace, closing: float) -> PosedContact:
        """A contact of an undeformed body with the forces on the points under the jaw, within the limit of its own law."""
        face = _under_jaw(contact)
        pressure, tangential = np.zeros(len(face)), np.zeros_like(contact.reference)
        tractions = closing * forces(contact.reference[:2, face].T)
        pressure[face], tangential[:, face] = np.maximum(tractions[:, 0], 0.0), tractions[:, 1:].T
        normals = contact.state.normals
        tangential -= np.einsum("in,in->n", tangential, normals) * normals
        tangential = contact.pair.within_limit(tangential, pressure)
        return replace(contact, growth=ContactIterate(pressure / closing, tangential / closing), grown_over=closing)


@dataclass(frozen=True)
class _OnFace:
    """Values between points of a face, and the nearest beyond them."""

    between: LinearNDInterpolator
    nearest: NearestNDInterpolator

    @classmethod
    def of(cls, points: Array, values: Array) -> _OnFace:
        """From values (n, k) at points (n, 2)."""
        return cls(LinearNDInterpolator(points, values), NearestNDInterpolator(points, values))

    def __call__(self, places: Array) -> Array:
        """Values (m, k) at places (m, 2)."""
        values = np.asarray(self.between(places))
        beyond = np.isnan(values[:, 0])
        values[beyond] = self.nearest(places[beyond])
        return values


def tissue_alone(experiment: GraspSetup, closing: float) -> TissueAlone | None:
    """The tissue of a grasp without its inclusions, at a closing in m near to this one and a friction near to its own.

    None where the case does not ask for it, where it does not act, or if Newton does not find it.
    """
    if experiment.solver.first_guess != "tissue" or why_not_tissue(experiment) is not None:
        return None
    contact, rung = experiment.contact, _rung(closing)
    if isinstance(contact, Coulomb) and contact.friction > 0:
        contact = _unchecked(contact, {"friction": _rung(MORE_FRICTION * contact.friction)})
    alone = {
        "inclusions": (),
        "contact": contact,
        "loading": close(to=rung, duration=1.0),
        "time": GraspTimeSettings(),
        "matrix": TaxelLayout(),
        "readout": None,
    }
    setup = _unchecked(experiment, alone)
    return _solved(_Alone(setup.model_dump_json(), rung, setup))


def why_not_tissue(experiment: GraspSetup) -> str | None:
    """Why Newton does not begin in the tissue without inclusions, asked for or not; None where it can."""
    if not experiment.inclusions:
        return "nothing is embedded"
    if experiment.loading.control == "force":
        return "the jaws follow a force"
    if any(shape.hollow for shape in experiment.shapes):
        return "the wall of a hollow tube gives way"
    if any(material.relaxation for material in experiment.materials):
        return "a material relaxes"
    return None if isinstance(experiment.source, GradedSource) else "the mesh is not of graded cells"


def _unchecked(value: Part, changes: dict[str, Any]) -> Part:
    """The same part of a case with some of its fields changed.

    Why unchecked: more friction, another closing and the usual taxels may be refused beside the rest of a case that is not.
    """
    return BaseModel.model_copy(value, update=changes)


def _rung(value: float) -> float:
    """The nearest of the values that are solved for."""
    return float(RUNG ** round(math.log(value) / math.log(RUNG)))


@dataclass(frozen=True)
class _Alone:
    """A grasp without inclusions, known by its case, to be closed by ``closing`` in m."""

    case: str
    closing: float
    setup: GraspSetup = field(compare=False)


@lru_cache(maxsize=KEPT)
def _solved(alone: _Alone) -> TissueAlone | None:
    """The tissue, None if Newton does not find it."""
    setup, closing = alone.setup, alone.closing
    model = grasp_model(setup, grasp_mesh(setup))
    rest = model.start(setup.contact, regularisation(setup))
    try:
        state = model.equilibrium(rest, closing, model.compressed(FIRST_PART * closing))
    except (ConvergenceError, Collapsed):
        return None
    displacement = model.space.split(state.unknowns)[0] / closing
    forces = {side: _face_forces(contact, closing) for side, contact in zip(JAWS, state.contacts, strict=True)}
    return TissueAlone(_between_nodes(model.mesh.nodes, displacement), forces)


def _between_nodes(nodes: Array, values: Array) -> RegularGridInterpolator:
    """Values between the nodes (n, 3) of cells that are a grid, from those (n, k) at them."""
    size = np.ptp(nodes, axis=0).max()
    lines, places = zip(*(np.unique(np.round(along / size, DIGITS), return_inverse=True) for along in nodes.T), strict=True)
    on_grid = np.empty((*map(len, lines), values.shape[1]))
    on_grid[places] = values
    return RegularGridInterpolator([size * line for line in lines], on_grid, bounds_error=False, fill_value=None)


def _under_jaw(contact: PosedContact) -> Array:
    """Whether surface points (n,) lie on the face under the jaw, not on those beside it."""
    return np.asarray(contact.pair.friction_mask) > 0


def _face_forces(contact: PosedContact, closing: float) -> _OnFace:
    """What presses the face under a jaw, per closing in m."""
    face = _under_jaw(contact)
    values = np.vstack([contact.state.pressure, contact.state.tangential]) / closing
    return _OnFace.of(contact.reference[:2, face].T, values[:, face].T)
