"""Evaluates what is asked of a problem in a state of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.experiments.boundary_value.asked import (
    AnyAsked,
    AskedContactForce,
    AskedDisplacement,
    AskedEnergy,
    AskedForce,
    AskedStress,
    AskedTorque,
    AskedVolume,
)
from tactsim.experiments.boundary_value.face_forces import FaceForces
from tactsim.experiments.boundary_value.geometry import AXES
from tactsim.experiments.boundary_value.posing import PosedProblem
from tactsim.experiments.boundary_value.setup import BoundaryValueSetup
from tactsim.mechanics.fields.point_values import BodyPoint, cauchy_stress, von_mises
from tactsim.mechanics.outcome.success import LARGEST_FORCE_ERROR
from tactsim.mechanics.paths.history_path import TimedState


@dataclass(frozen=True)
class Present:
    """A state with the stress (3, 3, E, Q) in Pa and the nodal forces (n, d) in N on faces that belong to it."""

    timed: TimedState
    stress: Array
    forces: dict[str, Array]


Evaluation = Callable[[Present], float]


class Probes:
    """All that is asked of one problem."""

    def __init__(self, problem: BoundaryValueSetup, posed: PosedProblem):
        self._problem, self._posed, self._model = problem, posed, posed.model
        self._axes = AXES[problem.dimension]
        self._evaluations = {name: self._evaluation(one) for name, one in problem.asked.items()}
        faces = {one.face for one in problem.asked.values() if isinstance(one, AskedForce | AskedTorque)}
        self._forces = FaceForces(posed, faces)

    def values(self, state: TimedState) -> dict[str, float]:
        """Every number in SI, by its name."""
        now, body = state.contact, self._model.body
        stress = cauchy_stress(body, now.unknowns, now.kinematics, state.isochoric)
        present = Present(state, stress, self._forces.at(state))
        return {name: self._problem.asked[name].factor * evaluate(present) for name, evaluate in self._evaluations.items()}

    def doubts(self, state: TimedState) -> list[str]:
        """Warnings of forces on faces more of which than is allowed acts at edges that other faces hold, too."""
        parts = self._forces.of_edges(state)
        forces = self._forces.at(state) if parts else {}
        doubts = []
        for name, one in self._problem.asked.items():
            if not isinstance(one, AskedForce) or one.face not in parts:
                continue
            axis = self._axes.index(one.component)
            part, size = parts[one.face][:, axis].sum(), np.abs(forces[one.face][:, axis]).sum()
            if abs(part) > LARGEST_FORCE_ERROR * size:
                doubts.append(
                    f"{name}: {100 * abs(part) / size:.1f} % of the force on {one.face} is at edges that other faces or planes "
                    "of symmetry hold, too; each is given an equal part, so that the force is uncertain by as much: shorter "
                    "cells beside these edges make it less"
                )
        return doubts

    def _evaluation(self, one: AnyAsked) -> Evaluation:
        """How a number is evaluated; what it names is looked up once."""
        if isinstance(one, AskedDisplacement):
            point, axis = self._point(one.at), self._axes.index(one.component)
            return lambda now: float(point.displacement(now.timed.contact.unknowns)[axis])
        if isinstance(one, AskedStress):
            return self._stress(one)
        if isinstance(one, AskedForce):
            face, axis = one.face, self._axes.index(one.component)
            return lambda now: float(now.forces[face][:, axis].sum())
        if isinstance(one, AskedTorque):
            face = one.face
            return lambda now: self._torque(face, now)
        if isinstance(one, AskedContactForce):
            number, axis = one.contact - 1, self._axes.index(one.component)
            return lambda now: self._contact_force(now, number, axis)
        if isinstance(one, AskedEnergy):
            return self._energy
        assert isinstance(one, AskedVolume)
        weights = self._model.body.points.weights
        return lambda now: float((weights * now.timed.contact.kinematics.J).sum())

    def _point(self, place: tuple[float, ...]) -> BodyPoint:
        return BodyPoint.at(self._model.body, np.array(place))

    def _stress(self, one: AskedStress) -> Evaluation:
        point, component = self._point(one.at), one.component
        if component == "von_mises":
            return lambda now: float(von_mises(point.mean(now.stress)))
        if component == "mean":
            return lambda now: float(np.trace(point.mean(now.stress)) / 3)
        entries = one.entries(self._problem.dimension)
        if component in entries:
            row, column = entries[component]
            return lambda now: float(point.mean(now.stress)[row, column])
        return lambda now: self._around_axis(one, point, now)

    def _around_axis(self, one: AskedStress, point: BodyPoint, now: Present) -> float:
        """Cauchy stress in the direction from the z axis to the deformed place of the point, or around the axis there."""
        x, y = (np.array(one.at) + point.displacement(now.timed.contact.unknowns))[:2]
        away = np.array([x, y, 0.0]) / np.hypot(x, y)
        along = away if one.component == "radial" else np.array([-away[1], away[0], 0.0])
        return float(along @ point.mean(now.stress) @ along)

    def _torque(self, face: str, now: Present) -> float:
        u, _ = self._model.space.split(now.timed.contact.unknowns)
        place, force = self._model.mesh.nodes + u, now.forces[face]
        return float((place[:, 0] * force[:, 1] - place[:, 1] * force[:, 0]).sum())

    def _contact_force(self, now: Present, number: int, axis: int) -> float:
        contact = now.timed.contact.contacts[number]
        return float(contact.surface.total(contact.state.traction)[axis])

    def _energy(self, now: Present) -> float:
        body, state = self._model.body, now.timed.contact
        energy, pressure = np.zeros(state.kinematics.J.shape), body.pressure(state.unknowns)
        for number, material in enumerate(body.materials):
            own = body.regions == number
            F = state.kinematics.F[:, :, own]
            isochoric, volumetric = material.stored_energy(F), 0.0  # type: ignore[attr-defined]
            if material.bulk_modulus is not None:
                # That of the pressure: J at single points misses what the pressure asks for by the error of the mesh.
                isochoric = isochoric - material.bulk_modulus / 2 * material.volume_change(F) ** 2
                volumetric = pressure[own] ** 2 / (2 * material.bulk_modulus)
            lasting = 1.0 if material.relaxation is None else material.relaxation.amplitudes[0]
            energy[own] = lasting * isochoric + volumetric
        return float((body.points.weights * energy).sum())
