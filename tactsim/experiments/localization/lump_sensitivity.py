r"""What a small change of stiffness at a point does to the force on each taxel: adjoint solutions on the plain tissue.

The force on a taxel is the virtual work of the stress in the virtual displacement w that moves the taxel by one into the tissue
and leaves the rest of both jaws at rest. If w solves the equations linearised about the grasped plain tissue, a change of stress
:math:`\delta P` in a part of the tissue changes the force by

.. math:: \delta F = \int \delta P : \nabla w\, dV

and stiffness times 1 + c is :math:`\delta P = c P_{iso}`; pressure does no work in w, which keeps the volume. Tissue that
touches a jaw is taken to stick to it. See K.-J. Bathe, Finite Element Procedures, 1996, for the linearised equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.deadline import check_time
from tactsim.errors import ConvergenceError, InputError
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.path import grasp_path
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.fem.solvers.linear import direct_solver
from tactsim.fem.solvers.pardiso import SymmetricPardiso
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.localization.lump_response import LumpResponse, Tabulation
from tactsim.mechanics.models.block_model import CLOSING, GraspModel
from tactsim.mechanics.models.block_source import StructuredSource

CELLS = (14, 14, 8)
"""Cells of the block, each of six tetrahedra: 45 000 unknowns."""
FINE = Tabulation(np.linspace(1.5e-3, 8e-3, 14), spacing=1e-3, most_centres=100_000)
"""Balls that estimators try: 22 MB for a taxel of both jaws."""
ROWS_AT_ONCE = 32
"""Taxels whose densities are turned into responses together, which bounds the memory."""


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Densities (jaw, row, column, n) in N/m^3 at points ``places`` (n, 3) in m that stand for ``volumes`` (n,) in m^3."""

    places: Array
    volumes: Array
    densities: Array
    forces: Array
    """What the taxels (jaw, row, column) read on the plain tissue, in N."""


def lump_response(setup: GraspSetup, balls: Tabulation = FINE) -> LumpResponse:
    """The fast forward model of lumps in the tissue of a grasp without inclusions, at the end of its history.

    Raises
    ------
    InputError
        If the grasp has inclusions.
    ConvergenceError
        If the plain tissue cannot be grasped.
    OutOfTime
        If its time has passed, or it was stopped.
    """
    size, adjoint = setup.block.size, sensitivity(setup)
    radii, spacing, densities = balls.radii_in(size), balls.spacing_in(size), adjoint.densities
    flat, tables = densities.reshape(-1, densities.shape[-1]), []
    for begin in range(0, len(flat), ROWS_AT_ONCE):
        part = flat[begin : begin + ROWS_AT_ONCE][:, None, None]
        tables.append(LumpResponse.of_density(adjoint.places, adjoint.volumes, part, size=size, radii=radii, spacing=spacing))
    values = np.concatenate([table.values for table in tables], axis=4)
    return LumpResponse(tables[0].axes, radii, values.reshape(*values.shape[:4], *densities.shape[:-1]))


def sensitivity(setup: GraspSetup) -> Sensitivity:
    """Densities of the change of every taxel's force, on a structured mesh.

    Raises
    ------
    InputError
        If the grasp has an inclusion.
    ConvergenceError
        If no step of its history converges.
    OutOfTime
        If its time has passed, or it was stopped.
    """
    if setup.inclusions:
        raise InputError("the response is that of plain tissue; give a grasp without inclusions")
    plain = setup.model_copy(update={"mesh": StructuredSource(kind="structured", cells=CELLS)})
    model = grasp_model(plain, grasp_mesh(plain))
    last = None
    for state, _ in grasp_path(plain, model).states():
        last = state.contact
    if last is None:
        raise ConvergenceError("the history of the grasp has no step")
    adjoint = _Adjoint(model, last.unknowns)
    body, F = model.body, last.kinematics.F
    stress = body.materials[0].first_piola_kirchhoff(F, np.zeros(F.shape[2:]))
    densities = []
    for side in JAWS:
        for border in adjoint.indicators(side, last.contacts[JAWS.index(side)].place, plain.matrix):
            check_time()
            gradient = adjoint.gradient(side, border)
            densities.append(np.einsum("ijeq,ijeq->eq", stress, gradient).ravel())
    shape = (len(JAWS), plain.matrix.rows, plain.matrix.columns)
    corners = model.mesh.nodes[model.space.elements]
    places = np.einsum("qa,ead->eqd", body.points.values, corners).reshape(-1, 3)
    forces = np.stack([model.taxels(last, side, plain.matrix).taxels[2] for side in JAWS])
    return Sensitivity(places, body.points.weights.ravel(), np.array(densities).reshape(*shape, -1), forces)


class _Adjoint:
    """The tangent of the grasped plain tissue, factored with both faces held."""

    def __init__(self, model: GraspModel, unknowns: Array):
        self.model = model
        self.displacement = model.space.split(unknowns)[0]
        size, pattern = model.space.size, model.body.pattern
        tangent = scipy.sparse.csr_matrix((model.body.tangent(unknowns), pattern.indices, pattern.indptr), shape=(size, size))
        self.nodes = {side: np.unique(model.facets[side]) for side in JAWS}
        held = np.concatenate([(nodes[:, None] * 3 + np.arange(3)).ravel() for nodes in self.nodes.values()])
        self.free = np.setdiff1d(np.arange(size), held)
        self.coupling = tangent[self.free]
        self.solver = direct_solver(SymmetricPardiso.name)
        inner = self.coupling[:, self.free].tocsr()
        inner.sort_indices()
        self.solver.factor(inner)

    def indicators(self, side: str, place: Array, layout: TaxelLayout) -> list[Array]:
        """For each taxel, by rows, the nodal values (nodes of the face,) that come nearest to one on it and zero beside it."""
        surface = self.model.space.surface_points(self.model.facets[side])
        nodes = self.nodes[side]
        number = np.searchsorted(nodes, surface.nodes)
        products = surface.weights[:, None, None] * surface.values[:, :, None] * surface.values[:, None, :]
        count = surface.values.shape[1]
        places = np.repeat(number[:, :, None], count, axis=2), np.repeat(number[:, None, :], count, axis=1)
        mass = scipy.sparse.linalg.splu(
            scipy.sparse.csr_matrix((products.ravel(), tuple(p.ravel() for p in places)), shape=(len(nodes),) * 2).tocsc()
        )
        deformed = surface.interpolate(self.model.mesh.nodes + self.displacement)
        along = self.model.jaws[side].face_coordinates(deformed - place[:, None])
        indicators = []
        for low_y, high_y in layout.borders("y"):
            for low_x, high_x in layout.borders("x"):
                on = (along[0] >= low_x) & (along[0] < high_x) & (along[1] >= low_y) & (along[1] < high_y)
                loads = (surface.weights * on)[:, None] * surface.values
                indicators.append(mass.solve(np.bincount(number.ravel(), loads.ravel(), len(nodes))))
        return indicators

    def gradient(self, side: str, border: Array) -> Array:
        """Gradient (3, 3, E, Q) in 1/m of the virtual displacement that moves the face of a jaw by ``border`` into the tissue."""
        model = self.model
        field = np.zeros(model.space.size)
        field[self.nodes[side] * 3 + 2] = CLOSING[side][2] * border
        field[self.free] = self.solver.solve(-(self.coupling @ field))
        moved = model.space.split(field)[0][model.space.elements]
        return np.einsum("eqak,eai->ikeq", model.body.points.gradients, moved)
