"""What acts on each face of a body from outside: its loads, its rigid bodies and the reactions of what it prescribes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from tactsim.array import Array
from tactsim.experiments.boundary_value.conditions import ContactCondition, FaceCondition
from tactsim.experiments.boundary_value.posing import Load, PosedProblem
from tactsim.mechanics.paths.history_path import TimedState


class FaceForces:
    """Nodal forces of the faces of one problem, whose sum over all faces balances what acts on the volume of the body.

    A node at an edge belongs to several faces, so that the internal forces of the nodes of a face are not the force on it. Loads
    and rigid bodies act on the face of their condition, forces per volume on none. What else a prescribed displacement takes, its
    reaction, acts on the face that prescribes it, in equal parts on several. That of a point acts in equal parts on the faces
    through the point.

    Parameters
    ----------
    posed : the problem
    faces : names of those whose forces are asked for
    """

    def __init__(self, posed: PosedProblem, faces: Iterable[str]):
        self._posed, self._model = posed, posed.model
        shares = _shares(posed)
        self._shares = {name: shares[name] for name in faces}
        self._part_of_edges = {name: np.where(share < 1, share, 0.0) for name, share in self._shares.items()}

    def at(self, state: TimedState) -> dict[str, Array]:
        """Nodal forces (n, d) in N that act on each of the ``faces`` in a state."""
        if not self._shares:
            return {}
        own, reaction = self._acting(state)
        return {
            face: share * reaction
            + sum(force for condition, force in own if isinstance(condition, FaceCondition) and condition.face == face)
            for face, share in self._shares.items()
        }

    def of_edges(self, state: TimedState) -> dict[str, Array]:
        """The part of ``at`` (n, d) in N that is an equal share of a reaction of several faces: the true share is anything up
        to all.
        """
        if not any(part.any() for part in self._part_of_edges.values()):
            return {}
        _, reaction = self._acting(state)
        return {face: part * reaction for face, part in self._part_of_edges.items() if part.any()}

    def _acting(self, state: TimedState) -> tuple[list[tuple[Load | ContactCondition, Array]], Array]:
        """Nodal forces (n, d) in N of every load and rigid body, and the reaction to what is prescribed."""
        now, model = state.contact, self._model
        loads, contacts = model.load_forces(now.unknowns, state.loads), model.contact_forces(now)
        own = [*zip(self._posed.loads, loads, strict=True), *zip(self._posed.contacts, contacts, strict=True)]
        return own, model.internal_forces(now.unknowns, state.relaxation) - sum(force for _, force in own)


def _shares(posed: PosedProblem) -> dict[str, Array]:
    """Part (n, d) of the reaction at each unknown that acts on a face, by the name of the face."""
    nodes, faces = posed.parts.domain.mesh.nodes, posed.parts.domain.faces
    prescribes = {name: np.zeros(nodes.size, bool) for name in faces}
    through = {name: np.zeros(nodes.shape, bool) for name in faces}
    at_points = np.zeros(nodes.size, bool)
    for one in posed.held:
        if one.face is not None:
            prescribes[one.face][one.motion.unknowns] = True
            prescribes[one.face][one.motion.slides(0.0).unknowns] = True
        elif one.condition is not None:
            at_points[one.motion.unknowns] = True
    at_points &= ~np.any(list(prescribes.values()), axis=0)
    for name, facets in faces.items():
        if posed.parts.axes[0] != "r" or nodes[facets][..., 0].any():  # the axis is no face: nothing can act on it
            through[name][np.unique(facets)] = True
        prescribes[name] |= at_points & through[name].ravel()
    count = np.maximum(np.sum(list(prescribes.values()), axis=0), 1)
    return {name: (share / count).reshape(nodes.shape) for name, share in prescribes.items()}
