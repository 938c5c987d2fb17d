"""The parts of a meshed body that a case names: faces, pieces of faces between cells, corners of the mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from tactsim.array import Array
from tactsim.experiments.boundary_value.asked import place_in_words
from tactsim.experiments.boundary_value.conditions import FaceCondition, Within, within_in_words
from tactsim.experiments.boundary_value.geometry import AXES, MEASURES, Dimension, Geometry
from tactsim.mesh.graded.mapped import Domain
from tactsim.units import format_quantity

if TYPE_CHECKING:
    from tactsim.fem.assembly.space import TaylorHood

AT_NODE = 1e-9
"""Distance from a corner or a border of the mesh, over the body's size, that is round-off."""
HashableWithin = tuple[tuple[str, tuple[float, float]], ...]
"""The items of a `Within`."""


@dataclass(frozen=True)
class Parts:
    """A meshed body; errors begin with the key that is to blame, such as ``face``."""

    domain: Domain
    dimension: Dimension

    @classmethod
    @lru_cache(maxsize=1)
    def of(cls, geometry: Geometry, dimension: Dimension, regions: tuple[HashableWithin, ...]) -> Parts:
        """Those of a geometry, the elements of each region numbered from one on; zero elsewhere.

        Checking, asking for doubts, drawing and solving take the same mesh, which is made and divided once.

        Raises
        ------
        ValueError
            If it has no mesh in this dimension, there is no coordinate that a region names, or a region holds no element or does
            not end between cells.
        InputError
            If the cells are too many.
        """
        try:
            whole = cls(geometry.domain(dimension), dimension)
        except ValueError as error:
            raise ValueError(f"geometry: {error}") from None
        return whole._divided([dict(within) for within in regions])

    def _divided(self, regions: Sequence[Within]) -> Parts:
        mesh = self.domain.mesh
        corners, numbers = mesh.nodes[mesh.elements[:, : mesh.dim + 1]], np.zeros(len(mesh.elements), np.int64)
        for number, within in enumerate(regions):
            inside, touched = self._within(within, corners)
            if not inside.any() or (touched & ~inside).any():
                fault = "ends within cells" if inside.any() else "holds no cell"
                raise ValueError(
                    f"regions.{number}.within: the part within {within_in_words(within)} {fault}; {self._ending(within)}"
                )
            numbers[inside] = number + 1
        if not regions:
            return self
        return replace(self, domain=replace(self.domain, mesh=replace(mesh, regions=numbers)))

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return AXES[self.dimension]

    @cached_property
    def space(self) -> TaylorHood:
        """Displacements and pressures on the mesh."""
        from tactsim.fem.assembly.space import TaylorHood  # not for a wrong word in a case

        mesh = self.domain.mesh
        return TaylorHood(mesh.nodes, mesh.elements, MEASURES[self.dimension], mesh.regions)

    @property
    def size(self) -> float:
        """Largest extent of the body along an axis in m."""
        return float(np.ptp(self.domain.mesh.nodes, axis=0).max())

    def face(self, name: str) -> Array:
        """Facets (F, 3) or (F, 6) of a face by its name.

        Raises
        ------
        ValueError
            If there is no such face.
        """
        if name not in self.domain.faces:
            raise ValueError(f"face: the body has no face {name!r}; it has {', '.join(self.domain.faces)}")
        return self.domain.faces[name]

    def facets(self, condition: FaceCondition) -> Array:
        """The facets (F, nodes) of the face of a condition, or of the part of the face to which the condition is limited.

        Raises
        ------
        ValueError
            If there is no such face or coordinate, or the part holds no facet or does not end between cells.
        """
        facets = self.face(condition.face)
        inside, touched = self._within(condition.within or {}, self.domain.mesh.nodes[facets])
        if (cut := facets[touched & ~inside]).size:
            raise ValueError(self._cut_in_words(cut[0], condition))
        if not inside.any():
            part = within_in_words(condition.within or {})
            raise ValueError(
                f"within: no facet of {condition.face} lies within {part}; let cells end there, or take a wider part"
            )
        return facets[inside]

    def _ending(self, within: Within) -> str:
        """What to do so that cells end at the ends of a region."""
        if "r" in within and self.dimension == "plane_strain" and "inner" not in self.domain.faces:
            return (
                "cells of a section without a hole end on no circle: take dimension: axisymmetric, or 3d, and hold the "
                "displacement z of bottom and top at zero"
            )
        return "let cells end there"

    def _within(self, within: Within, places: Array) -> tuple[Array, Array]:
        """Which cells or facets (n,) lie in a part by the places (n, k, d) of their nodes in m, and which reach into it."""
        inside, touched, slack = np.ones(len(places), bool), np.ones(len(places), bool), AT_NODE * self.size
        for name, (low, high) in within.items():
            along = self._along(name, places)
            inside &= ((along >= low - slack) & (along <= high + slack)).all(axis=1)
            touched &= (along.max(axis=1) > low + slack) & (along.min(axis=1) < high - slack)
        return inside, touched

    def _along(self, name: str, places: Array) -> Array:
        """A coordinate in m of places (..., d); a round body in 3D or plane strain has the distance ``r`` from its axis, too.

        Raises
        ------
        ValueError
            If there is no such coordinate.
        """
        if name in self.axes:
            return np.asarray(places[..., self.axes.index(name)])
        turned = "outer" in self.domain.faces
        if name == "r" and turned:
            return np.hypot(places[..., 0], places[..., 1])
        allowed = ", ".join((*self.axes, *(("r",) if turned else ())))
        raise ValueError(f"within: there is no coordinate {name}; allowed: {allowed}")

    def node(self, place: Sequence[float]) -> int:
        """The node at a place in m.

        Raises
        ------
        ValueError
            If there is none, or the place has another number of coordinates.
        """
        self.check_place(place)
        distance = np.linalg.norm(self.domain.mesh.nodes - np.asarray(place), axis=1)
        node = int(distance.argmin())
        if distance[node] > AT_NODE * self.size:
            away = format_quantity(float(distance[node]), "m")
            raise ValueError(
                f"at: no node of the mesh lies at {place_in_words(place)}; the nearest is {away} away: let cells end there"
            )
        return node

    def check_place(self, place: Sequence[float]) -> None:
        """Check that a place in m has as many coordinates as the problem, and lies no further out than the body.

        Raises
        ------
        ValueError
            If it has another number of coordinates, or lies further out.
        """
        if len(place) != len(self.axes):
            raise ValueError(
                f"at: the point {place_in_words(place)} has {len(place)} coordinates; needed: {', '.join(self.axes)}"
            )
        nodes, slack = self.domain.mesh.nodes, AT_NODE * self.size
        for name, value, low, high in zip(self.axes, place, nodes.min(axis=0), nodes.max(axis=0), strict=True):
            if not low - slack <= value <= high + slack:
                ends = " to ".join(format_quantity(float(end), "m") for end in (low, high))
                raise ValueError(f"at: the point {place_in_words(place)} lies outside the body, where {name} is {ends}")

    def _cut_in_words(self, facet: Array, condition: FaceCondition) -> str:
        """That a facet reaches across an end of the part that a condition means."""
        slack = AT_NODE * self.size
        for name, ends in (condition.within or {}).items():
            along = self._along(name, self.domain.mesh.nodes[facet])
            low, high = float(along.min()), float(along.max())
            for end in ends:
                if low + slack < end < high - slack:
                    first, last, cut = (format_quantity(value, "m") for value in (low, high, end))
                    return (
                        f"within.{name}: a cell of {condition.face} reaches from {first} to {last}, across the end at {cut}; "
                        "let cells end there"
                    )
        part = within_in_words(condition.within or {})
        return f"within: a cell of {condition.face} lies partly within {part}; let cells end there"
