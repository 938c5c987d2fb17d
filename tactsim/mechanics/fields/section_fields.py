"""Fields of a section of triangles for ParaView."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.fields.cell_fields import cell_fields, pressures
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.fields import DISPLACEMENT, PRESSURE
from tactsim.results.result import FieldFrame


def section_frame(
    mesh: QuadraticMesh, body: Body, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None
) -> FieldFrame:
    """Fields of a state; ``time`` stands in the index.

    The pressure is the mean stress, compression positive; where it jumps from layer to layer, the mean of both. ``isochoric``
    (6, E, Q) is the relaxed isochoric stress in Pa, whose trace in the deformed state counts to the pressure.
    """
    u, _ = body.space.split(state.unknowns)
    flat = np.zeros((len(u), 3))
    points, displacement = flat.copy(), flat.copy()
    points[:, :2], displacement[:, :2] = mesh.nodes, u
    _, pressure = pressures(body, state, isochoric)
    ends = mesh.elements[:, [[0, 1], [1, 2], [0, 2]]]
    pressure[mesh.elements[:, 3:]] = pressure[ends].mean(axis=2)
    return FieldFrame(
        time=time,
        points=points,
        cells={"triangle6": mesh.elements},
        point_data={DISPLACEMENT: displacement, PRESSURE: pressure},
        cell_data=cell_fields(mesh, body, state),
    )
