"""Fields of the elements of a section or a solid, and values at their points as those of their corners."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.history_variables import elastic_stress, mean_stress
from tactsim.materials.stability import principal_stretches
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.fields.ellipticity import elliptic_in
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.fields import REGION


def cell_fields(mesh: QuadraticMesh, body: Body, state: ContactEquilibrium) -> dict[str, Array]:
    """By name, values (E,) of the elements in a state: their region, how far they are deformed, whether they are elliptic."""
    return {
        REGION: mesh.regions.astype(float),
        "largest_stretch [1]": principal_stretches(state.kinematics.F)[0].max(axis=1),
        "volume_ratio [1]": state.kinematics.J.mean(axis=1),
        "elliptic [1]": elliptic_in(body, state.kinematics).all(axis=1).astype(float),
    }


def pressures(body: Body, state: ContactEquilibrium, isochoric: Array | None) -> tuple[Array, Array]:
    """Pressure in Pa, compression positive: at the pressure unknowns, and at the nodes (n,) as the mean of the regions that meet
    at a corner; 0 at the nodes between corners.

    It is the mean stress, to which the trace of the relaxed ``isochoric`` stress (6, E, Q) in Pa counts in the deformed state, by
    default that of the energy: both hold the resistance of `Body` to the change of volume that its pressure does not ask for.
    """
    if isochoric is None:
        isochoric = elastic_stress(body, state.kinematics, state.unknowns)
    u, p = body.space.split(state.unknowns)
    at_corners = -p - _corner_means(body, mean_stress(body, state.kinematics, isochoric))
    at_nodes, corners = np.zeros(len(u)), body.space.pressure_corners
    at_nodes[: body.space.corner_count] = np.bincount(corners, at_corners) / np.bincount(corners)
    return at_corners, at_nodes


def _corner_means(body: Body, values: Array) -> Array:
    """Values (E, Q) at the volume points as means over the elements around each corner, region by region, by volume."""
    weights, corners = body.points.weights, body.space.pressures
    volume = np.repeat(weights.sum(axis=1), corners.shape[1])
    total = np.repeat((weights * values).sum(axis=1), corners.shape[1])
    return np.bincount(corners.ravel(), total) / np.bincount(corners.ravel(), volume)
