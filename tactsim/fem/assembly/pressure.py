"""Pressure that follows the deformed surface it acts on."""

from __future__ import annotations

from copy import copy
from functools import cached_property

import numpy as np
from skfem.quadrature import get_quadrature

from tactsim.array import Array
from tactsim.fem.assembly.body_part import BodyPart
from tactsim.fem.assembly.pattern import Pattern
from tactsim.fem.assembly.space import FACET_ELEMENTS, SURFACE_ORDER, TaylorHood, tabulate


class FollowerPressure:
    r"""Pressure on deformed facets, pushing against their outward normal.

    .. math:: f_a = -p \int N_a\, (\partial_\xi x \times \partial_\eta x)\, d\xi\, d\eta

    with the axisymmetric and plane counterparts. Source: Schweizerhof & Ramm 1984, doi:10.1016/0045-7949(84)90154-8.

    Parameters
    ----------
    space : TaylorHood
    facets : (F, 3) edges or (F, 6) triangles by node number, outward oriented
    pattern : sparse pattern of the body
    pressure : in Pa
    """

    def __init__(self, space: TaylorHood, facets: Array, pattern: Pattern, pressure: float):
        self._facets, self.pressure = _PressedFacets(space, facets, pattern), pressure

    def at(self, pressure: float) -> FollowerPressure:
        """The same facets under another pressure in Pa."""
        return self._on(self._facets, pressure)

    def of_part(self, part: BodyPart) -> FollowerPressure:
        """The pressure on the facets of a part of the body."""
        return self._on(self._facets.of_part(part), self.pressure)

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at nodal displacements (n, d) in m."""
        return self.pressure * self._facets.force(displacement)

    def add_stiffness(self, data: Array, displacement: Array) -> None:
        """Add the pressure times the derivative of the area vector at displacements (n, d) to the tangent's entries (nnz,)."""
        self._facets.add_stiffness(data, displacement, self.pressure)

    def _on(self, facets: _PressedFacets, pressure: float) -> FollowerPressure:
        other = copy(self)
        other._facets, other.pressure = facets, pressure
        return other


class _PressedFacets:
    """Facets under a pressure of 1 Pa, and the places of their tangent entries."""

    def __init__(self, space: TaylorHood, facets: Array, pattern: Pattern):
        element = FACET_ELEMENTS[space.dim]
        X, W = get_quadrature(element, SURFACE_ORDER[space.dim])
        self._values, self._local = tabulate(element, X)
        self._weights, self._space, self._facets, self._pattern = W, space, facets, pattern
        self._unknowns = (facets[:, :, None] * space.dim + np.arange(space.dim)).reshape(len(facets), -1)
        self._parts: dict[BodyPart, _PressedFacets] = {}

    def of_part(self, part: BodyPart) -> _PressedFacets:
        """Those that lie on a part of the body, the same object for the same part."""
        if part not in self._parts:
            self._parts[part] = _PressedFacets(part.body.space, part.facets(self._facets)[1], part.body.pattern)
        return self._parts[part]

    def force(self, displacement: Array) -> Array:
        """Nodal forces (size,) in N/Pa."""
        x = (self._space.nodes + displacement)[self._facets]
        area = self._measure(x)[..., None] * self._area_normal(x)
        forces = np.einsum("q,qa,fqi->fai", self._weights, self._values, area)
        return -np.bincount(self._unknowns.ravel(), forces.ravel(), self._space.size)

    def add_stiffness(self, data: Array, displacement: Array, pressure: float) -> None:
        """Add minus the derivative of the force at a pressure in Pa to the entries of the tangent."""
        x = (self._space.nodes + displacement)[self._facets]
        slope = self._measure(x)[..., None, None, None] * self._area_normal_slope(x)
        if self._space.measure == "axisymmetric":
            slope[..., 0] += 2 * np.pi * self._area_normal(x)[..., :, None] * self._values[None, :, None, :]
        blocks = pressure * np.einsum("q,qa,fqibk->faibk", self._weights, self._values, slope)
        places, positions = self._places
        data[places] += np.bincount(positions, blocks.ravel(), len(places))

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """Places of the facets' entries in the tangent, each once, and which of them each facet's entries take."""
        return np.unique(self._pattern.between(self._unknowns).ravel(), return_inverse=True)

    def _measure(self, x: Array) -> Array:
        """Circumference at the points of an axisymmetric facet (F, Q) in m, one otherwise."""
        if self._space.measure == "axisymmetric":
            return 2 * np.pi * np.einsum("qa,fa->fq", self._values, x[:, :, 0])
        return np.ones((len(x), len(self._weights)))

    def _area_normal(self, x: Array) -> Array:
        """Outward normal times the local area, (F, Q, d)."""
        tangents = np.einsum("fai,qaj->fqji", x, self._local)
        if self._space.dim == 3:
            return np.cross(tangents[:, :, 0], tangents[:, :, 1])
        return np.stack([tangents[:, :, 0, 1], -tangents[:, :, 0, 0]], axis=-1)

    def _area_normal_slope(self, x: Array) -> Array:
        """Derivative of the area vector i with respect to node b, component k: (F, Q, i, b, k)."""
        dim = self._space.dim
        if dim == 2:
            turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
            slope = np.einsum("ik,qb->qibk", turn, self._local[:, :, 0])
            return np.broadcast_to(slope, (len(x), *slope.shape)).copy()
        tangents = np.einsum("fai,qaj->fqji", x, self._local)
        permutation = np.zeros((3, 3, 3))
        permutation[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
        permutation[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = -1.0
        first = np.einsum("ikl,qb,fql->fqibk", permutation, self._local[:, :, 0], tangents[:, :, 1])
        return first + np.einsum("ilk,fql,qb->fqibk", permutation, tangents[:, :, 0], self._local[:, :, 1])
