"""Fields of a body of tetrahedra for ParaView."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.history_variables import mean_stress
from tactsim.materials.stability import principal_stretches
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.fields.ellipticity import elliptic_in
from tactsim.mesh.quadratic import EDGES, QuadraticMesh
from tactsim.results.result import FieldFrame


def solid_frame(
    mesh: QuadraticMesh, body: Body, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None
) -> FieldFrame:
    """Fields of a state; ``time`` stands in the index.

    The pressure is the mean stress, compression positive. It jumps where regions meet: ``corner_pressure`` (E, 4) has it at
    the corners of each element, the nodal ``pressure`` the mean of the regions there. ``isochoric`` (6, E, Q) is the relaxed
    isochoric stress in Pa, whose trace in the deformed state counts to it.
    """
    u, p = body.space.split(state.unknowns)
    pressure, corners = np.zeros(len(u)), body.space.pressure_corners
    at_corners = -p
    if isochoric is not None:
        at_corners = at_corners - corner_means(body, mean_stress(body, state.kinematics, isochoric))
    pressure[: body.space.corner_count] = np.bincount(corners, at_corners) / np.bincount(corners)
    pressure[mesh.elements[:, 4:]] = pressure[mesh.elements[:, EDGES[3]]].mean(axis=2)
    return FieldFrame(
        time=time,
        points=mesh.nodes,
        cells={"tetra10": mesh.elements},
        point_data={"displacement [m]": u.copy(), "pressure [Pa]": pressure},
        cell_data={
            "corner_pressure [Pa]": at_corners[body.space.pressures],
            "region [1]": mesh.regions.astype(float),
            "largest_stretch [1]": principal_stretches(state.kinematics.F)[0].max(axis=1),
            "volume_ratio [1]": state.kinematics.J.mean(axis=1),
            "elliptic [1]": elliptic_in(body, state.kinematics).all(axis=1).astype(float),
        },
    )


def corner_means(body: Body, values: Array) -> Array:
    """Values (E, Q) at the volume points as means over the elements around each corner, region by region, by volume."""
    weights, corners = body.points.weights, body.space.pressures
    volume = np.repeat(weights.sum(axis=1), 4)
    total = np.repeat((weights * values).sum(axis=1), 4)
    return np.bincount(corners.ravel(), total) / np.bincount(corners.ravel(), volume)
