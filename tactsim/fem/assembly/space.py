"""Taylor-Hood P2/P1 space on quadratic triangles or tetrahedra, tabulated once at the quadrature points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from skfem import ElementLineP2, ElementTetP1, ElementTetP2, ElementTriP1, ElementTriP2
from skfem.quadrature import get_quadrature

from tactsim.array import Array
from tactsim.errors import InputError

Measure = Literal["axisymmetric", "plane_strain", "solid"]

ELEMENTS = {2: (ElementTriP2(), ElementTriP1()), 3: (ElementTetP2(), ElementTetP1())}
"""Quadratic and linear functions by dimension."""
FACET_ELEMENTS = {2: ElementLineP2(), 3: ElementTriP2()}
VOLUME_ORDER = {2: 4, 3: 2}
"""Degree of the volume quadrature: 6 points on a triangle (the hoop term is rational), 4 on a tetrahedron."""
SURFACE_ORDER = {2: 5, 3: 4}
"""Degree of the surface quadrature: 3 points on an edge, 6 on a triangle."""
FACET_POINTS: Array = get_quadrature(FACET_ELEMENTS[3], SURFACE_ORDER[3])[0].T
"""Quadrature points (6, 2) of a triangular facet on the reference triangle."""


@dataclass(frozen=True)
class VolumePoints:
    """Shape functions at the volume quadrature points.

    ``gradients`` (E, Q, A, d) of the P2 functions in 1/m, ``hoop`` (E, Q, A) is N/R on an axisymmetric body and zero
    otherwise, ``weights`` (E, Q) in m^3 (with 2 pi R on an axisymmetric body; m^2 times unit thickness in plane strain),
    ``values`` (Q, A) of P2, ``pressure_values`` (Q, V) of P1.
    """

    gradients: Array
    hoop: Array
    weights: Array
    values: Array
    pressure_values: Array


@dataclass(frozen=True)
class SurfacePoints:
    """Shape functions at the quadrature points of boundary facets, flattened to n = F * Q points.

    ``nodes`` (n, A) node numbers of the facet of each point, ``values`` (n, A) of the P2 functions, ``weights`` (n,) in m^2
    of the reference surface, ``normals`` (d, n) outward in the reference configuration. The ``per_facet`` points of a facet
    follow one another and have the same places in every facet.
    """

    nodes: Array
    values: Array
    weights: Array
    normals: Array
    per_facet: int

    def interpolate(self, nodal: Array) -> Array:
        """Values (d, n) at the points of a nodal field (n_nodes, d)."""
        return np.einsum("na,nad->dn", self.values, nodal[self.nodes])


@dataclass(frozen=True)
class TaylorHood:
    """Displacement P2 (nodes), pressure P1 (corner nodes, numbered first).

    Unknowns: ``u[node, component]`` flattened first, then the pressures: one per corner node or, with ``regions``, one per corner
    node and region that it belongs to, because the mean stress jumps where stiff and soft tissue meet.

    Attributes
    ----------
    nodes : (n, d) reference coordinates in m; axisymmetric ones are (r, z)
    elements : (E, A) node numbers, corners first
    measure : what a volume means: "axisymmetric", "plane_strain" or "solid"
    regions : (E,) numbers; None means that the pressure is continuous everywhere

    Raises
    ------
    InputError
        If nodes or elements have too many or too few columns for the measure, or a node of an axisymmetric mesh lies at r < 0.
    """

    nodes: Array
    elements: Array
    measure: Measure
    regions: Array | None = None

    def __post_init__(self) -> None:
        """Check shapes that everything else relies on."""
        dim = 3 if self.measure == "solid" else 2
        expected = {2: 6, 3: 10}[dim]
        if self.nodes.shape[1] != dim or self.elements.shape[1] != expected:
            raise InputError(
                f"a {self.measure} body needs nodes (n, {dim}) and elements (E, {expected}), "
                f"got {self.nodes.shape} and {self.elements.shape}"
            )
        if self.measure == "axisymmetric" and self.nodes[:, 0].min() < 0:
            raise InputError("an axisymmetric mesh must lie at r >= 0")

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return int(self.nodes.shape[1])

    @property
    def corner_count(self) -> int:
        """Number of corner nodes."""
        return int(self.elements[:, : self.dim + 1].max()) + 1

    @property
    def pressures(self) -> Array:
        """Numbers (E, V) of the pressures at the corners of each element."""
        return self._numbering[0]

    @property
    def pressure_corners(self) -> Array:
        """Corner node (n_pressure,) of each pressure."""
        return self._numbering[1]

    @cached_property
    def _numbering(self) -> tuple[Array, Array]:
        corners, count = np.ascontiguousarray(self.elements[:, : self.dim + 1]), self.corner_count
        if self.regions is None:
            return corners, np.arange(count)
        keys, numbers = np.unique(corners + count * self.regions.astype(np.int64)[:, None], return_inverse=True)
        return np.ascontiguousarray(numbers.reshape(corners.shape).astype(self.elements.dtype)), keys % count

    @property
    def displacement_size(self) -> int:
        """Number of displacement unknowns."""
        return int(self.nodes.size)

    @property
    def size(self) -> int:
        """Number of all unknowns."""
        return self.displacement_size + len(self.pressure_corners)

    def split(self, unknowns: Array) -> tuple[Array, Array]:
        """Displacement (n, d) in m and pressure (n_pressure,) in Pa as views of the unknowns."""
        return unknowns[: self.displacement_size].reshape(-1, self.dim), unknowns[self.displacement_size :]

    def element_unknowns(self) -> Array:
        """Unknown numbers (E, A d + V) of each element: displacements node by node, then pressures."""
        u = (self.elements[:, :, None] * self.dim + np.arange(self.dim)).reshape(len(self.elements), -1)
        return np.hstack([u, self.displacement_size + self.pressures])

    def volume_points(self, order: int | None = None) -> VolumePoints:
        """Tabulate the shape functions at the points of a rule of the given degree.

        Raises
        ------
        InputError
            If an element is inverted or flat.
        """
        displacement, pressure = ELEMENTS[self.dim]
        X, W = get_quadrature(displacement, order or VOLUME_ORDER[self.dim])
        values, local = tabulate(displacement, X)
        pressure_values, _ = tabulate(pressure, X)
        coordinates = self.nodes[self.elements]
        jacobian = np.einsum("eai,qaj->eqij", coordinates, local)
        determinant = np.linalg.det(jacobian)
        if not (determinant > 0).all():
            bad = int(np.flatnonzero((determinant <= 0).any(axis=1))[0])
            raise InputError(f"element {bad} of the mesh is inverted or flat (Jacobian {determinant[bad].min():.3g})")
        gradients = np.einsum("qak,eqkj->eqaj", local, np.linalg.inv(jacobian))
        weights = determinant * W
        hoop = np.zeros(gradients.shape[:3])
        if self.measure == "axisymmetric":
            radius = np.einsum("qa,ea->eq", values, coordinates[:, :, 0])
            hoop = values[None] / radius[:, :, None]
            weights = weights * 2 * np.pi * radius
        return VolumePoints(*map(np.ascontiguousarray, (gradients, hoop, weights, values, pressure_values)))

    def surface_points(self, facets: Array, order: int | None = None) -> SurfacePoints:
        """Tabulate on boundary facets, (F, 3) edges or (F, 6) triangles by node numbers, corners first, outward oriented."""
        element = FACET_ELEMENTS[self.dim]
        X, W = get_quadrature(element, order or SURFACE_ORDER[self.dim])
        values, local = tabulate(element, X)
        coordinates = self.nodes[facets]
        tangents = np.einsum("fai,qaj->fqij", coordinates, local)
        if self.dim == 2:
            area_normal = np.stack([tangents[..., 1, 0], -tangents[..., 0, 0]], axis=-1)
        else:
            area_normal = np.cross(tangents[..., 0], tangents[..., 1])
        area = np.linalg.norm(area_normal, axis=-1)
        weights = area * W
        if self.measure == "axisymmetric":
            weights = weights * 2 * np.pi * np.einsum("qa,fa->fq", values, coordinates[:, :, 0])
        count = len(W)
        return SurfacePoints(
            nodes=np.repeat(facets, count, axis=0),
            values=np.tile(values, (len(facets), 1)),
            weights=weights.ravel(),
            normals=(area_normal / area[..., None]).reshape(-1, self.dim).T,
            per_facet=count,
        )


def tabulate(element: object, X: Array) -> tuple[Array, Array]:
    """Values (Q, A) and local gradients (Q, A, d) of a scikit-fem element's shape functions."""
    count = element.doflocs.shape[0]  # type: ignore[attr-defined]
    pairs = [element.lbasis(X, i) for i in range(count)]  # type: ignore[attr-defined]
    values = np.stack([np.broadcast_to(value, X.shape[1]) for value, _ in pairs], axis=1)
    gradients = np.stack([np.broadcast_to(gradient, X.shape).T for _, gradient in pairs], axis=1)
    return values, gradients


def quadratic_values(X: Array) -> tuple[Array, Array]:
    """Values (Q, A) and local gradients (Q, A, d) of the quadratic functions at points (d, Q) of the reference simplex."""
    return tabulate(ELEMENTS[len(X)][0], X)
