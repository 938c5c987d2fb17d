"""Fields of a body of tetrahedra for ParaView."""

from __future__ import annotations

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.fields.cell_fields import cell_fields, pressures
from tactsim.mesh.quadratic import EDGES, QuadraticMesh
from tactsim.results.fields import CORNER_PRESSURE, DISPLACEMENT, PRESSURE
from tactsim.results.result import FieldFrame


def solid_frame(
    mesh: QuadraticMesh, body: Body, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None
) -> FieldFrame:
    """Fields of a state; ``time`` stands in the index.

    The pressure is the mean stress, compression positive. It jumps where regions meet: ``corner_pressure`` (E, 4) has it at
    the corners of each element, the nodal ``pressure`` the mean of the regions there. ``isochoric`` (6, E, Q) is the relaxed
    isochoric stress in Pa, whose trace in the deformed state counts to it.
    """
    u, _ = body.space.split(state.unknowns)
    at_corners, pressure = pressures(body, state, isochoric)
    pressure[mesh.elements[:, 4:]] = pressure[mesh.elements[:, EDGES[3]]].mean(axis=2)
    return FieldFrame(
        time=time,
        points=mesh.nodes,
        cells={"tetra10": mesh.elements},
        point_data={DISPLACEMENT: u.copy(), PRESSURE: pressure},
        cell_data={CORNER_PRESSURE: at_corners[body.space.pressures], **cell_fields(mesh, body, state)},
    )
