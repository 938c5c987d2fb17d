"""Bodies of a simple shape, divided into cells: blocks, plates with a hole, cylinders and tubes, balls and hollow spheres."""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.mesh.affordable import PER_TETRAHEDRON, check_unknowns
from tactsim.mesh.graded.mapped import Domain, disc, grid_domain, spaced
from tactsim.mesh.revolved import SweepSymmetry, polar, swept
from tactsim.model import FrozenModel
from tactsim.units import Length, NonNegative, Positive, format_quantity

Dimension = Literal["3d", "plane_strain", "axisymmetric"]
AXES: dict[str, tuple[str, ...]] = {"3d": ("x", "y", "z"), "plane_strain": ("x", "y"), "axisymmetric": ("r", "z")}
"""Names of the coordinates."""
MEASURES: dict[str, Literal["solid", "plane_strain", "axisymmetric"]] = {
    "3d": "solid",
    "plane_strain": "plane_strain",
    "axisymmetric": "axisymmetric",
}
"""What a volume means in each dimension."""
TETRAHEDRA_OF_PRISM = 3
Part = Literal["whole", "half", "quarter"]


class Span(FrozenModel):
    """Cells one after the other along a coordinate."""

    length: Positive[Length]
    """Length of all of them together."""
    cells: Count
    """Their number."""
    ratio: Annotated[float, Field(ge=1e-6, le=1e6)] = 1.0
    """Length of the last one over that of the first; they grow evenly."""


Count = Annotated[int, Field(ge=1, le=1000)]
Corner = tuple[Length, Length]
Spans = Annotated[tuple[Span, ...], Field(min_length=1)]


def line_of(spans: tuple[Span, ...], start: float = 0.0) -> Array:
    """Coordinates (n,) in m of the ends of all cells, from ``start`` in m on; an InputError if the cells are too many."""
    lines = [np.array([start])]
    for span in spans:
        lines.append(lines[-1][-1] + spaced(span.length, span.cells, span.ratio)[1:])
    return np.concatenate(lines)


class Geometry(FrozenModel):
    """A body that can be meshed in some dimensions."""

    @abstractmethod
    def domain(self, dimension: Dimension) -> Domain:
        """Its mesh with the names of its faces.

        Raises
        ------
        ValueError
            If it has none in this dimension.
        InputError
            If the cells are too many.
        """


class BlockGeometry(Geometry):
    """A rectangle or a block with a corner at the origin; faces left and right (x), bottom and top, in 3D front and back (y).

    The height is the last coordinate: y in plane strain, z in 3D.
    """

    kind: Literal["block"] = "block"
    x: Spans
    """Cells along x."""
    y: Spans
    """Cells along y."""
    z: Spans | None = None
    """Cells along z, in 3D only."""

    def domain(self, dimension: Dimension) -> Domain:
        """A grid of cells.

        Raises
        ------
        ValueError
            If it has none in this dimension, or lacks the cells that it needs there.
        """
        if dimension == "axisymmetric":
            raise ValueError("a block has no axis; allowed dimensions: 3d, plane_strain; take geometry.kind: cylinder")
        if (self.z is None) != (dimension == "plane_strain"):
            raise ValueError("geometry.z belongs to a block in 3d, which needs it, and to no block in plane_strain")
        x, y = line_of(self.x), line_of(self.y)
        if self.z is None:
            return grid_domain((x, y), (("left", "right"), ("bottom", "top")))
        return grid_domain((x, y, line_of(self.z)), (("left", "right"), ("front", "back"), ("bottom", "top")))


class QuadrilateralGeometry(Geometry):
    """A quadrilateral in plane strain; faces left, bottom, right and top, as its corners follow one another.

    The cells are those of a square, carried over linearly from side to side, such as those of Cook's membrane.
    """

    kind: Literal["quadrilateral"] = "quadrilateral"
    corners: tuple[Corner, Corner, Corner, Corner]
    """Corners (x, y), counterclockwise from that between left and bottom."""
    cells: tuple[Count, Count]
    """Numbers of cells along bottom and top, and along left and right."""

    def domain(self, dimension: Dimension) -> Domain:
        """A grid of cells between the corners.

        Raises
        ------
        ValueError
            If the dimension is not plane strain, or the corners make no convex quadrilateral in this order.
        """
        if dimension != "plane_strain":
            raise ValueError("a quadrilateral is meshed in plane_strain only")
        corners = np.array(self.corners)
        before, after = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
        if not (before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0).all():
            raise ValueError("the corners must make a convex quadrilateral, counterclockwise")
        lines = [np.linspace(0.0, 1.0, count + 1) for count in self.cells]
        square = grid_domain(lines, (("left", "right"), ("bottom", "top")))

        def place(nodes: Array) -> Array:
            s, t = nodes.T
            weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
            return np.asarray(weights @ corners)

        return square.mapped(place)


class PlateGeometry(Geometry):
    """A quarter of a rectangular plate with an elliptic hole in its middle, the origin; faces hole, right and a far one in y.

    The far face in y is top in plane strain and back in 3D, where bottom and top are those of the thickness, along z from 0. The
    faces x_plane (x = 0) and y_plane (y = 0) are planes of symmetry.
    """

    kind: Literal["plate_with_hole"] = "plate_with_hole"
    size: Corner
    """From the middle to the far faces, along x and y: half the width and half the height."""
    hole: tuple[Positive[Length], Positive[Length]]
    """Semi-axes of the hole along x and y, equal of a round one."""
    outward: Count
    """Number of cells from the hole to the far faces."""
    ratio: Annotated[float, Field(ge=1e-6, le=1e6)] = 1.0
    """Length of the last of them over that of the first; they grow evenly."""
    around: Count = 8
    """Number of cells around the hole, up to each of the two far faces."""
    z: Spans | None = None
    """Cells through the thickness, in 3D only."""

    def domain(self, dimension: Dimension) -> Domain:
        """Cells between the hole and the far faces, along straight lines from angle to angle.

        Raises
        ------
        ValueError
            If it has none in this dimension, lacks the cells that it needs there, or the hole reaches the far faces.
        """
        if dimension == "axisymmetric":
            raise ValueError("a plate with a hole has no axis; allowed dimensions: 3d, plane_strain")
        if (self.z is None) != (dimension == "plane_strain"):
            raise ValueError("geometry.z belongs to a plate in 3d, which needs it, and to none in plane_strain")
        for name, semi_axis, end in zip("xy", self.hole, self.size, strict=True):
            if semi_axis >= end:
                given, most = format_quantity(semi_axis, "m"), format_quantity(end, "m")
                raise ValueError(f"the hole reaches {given} along {name}; allowed: less than the size there, {most}")
        lines = [spaced(1.0, self.outward, self.ratio), np.linspace(0.0, 2.0, 2 * self.around + 1)]
        names = [("hole", "far"), ("y_plane", "x_plane")]
        if self.z is not None:
            lines, names = [*lines, line_of(self.z)], [*names, ("bottom", "top")]
        grid = grid_domain(lines, names, {"x_plane": 0, "y_plane": 1})
        faces = dict(grid.faces)
        far = faces.pop("far")
        below = (grid.mesh.nodes[far][..., 1] <= 1.0).all(axis=1)
        faces |= {"right": far[below], "back" if self.z else "top": far[~below]}
        return Domain(grid.mesh, faces, grid.mirrors).mapped(self._place)

    def _place(self, nodes: Array) -> Array:
        """Places (n, d) in m of nodes of the grid: from 0 at the hole to 1 outside, from 0 at y = 0 over 1 at the corner to 2."""
        out, around = nodes[:, :1], nodes[:, 1]
        hole = polar(np.column_stack([np.ones(len(nodes)), around * np.pi / 4])) * self.hole
        far = np.column_stack([np.minimum(1.0, 2.0 - around), np.minimum(1.0, around)]) * self.size
        return np.column_stack([(1 - out) * hole + out * far, nodes[:, 2:]])


class RoundGeometry(Geometry):
    """A body with round faces: in 3D swept about z, or the part of it between planes of symmetry; a section of a long one."""

    radial: Spans
    """Cells along the radius, from the inside out."""
    inner_radius: NonNegative[Length] = 0.0
    """Radius of the hole; 0 without one."""
    around: Annotated[int, Field(ge=2, le=1000)] = 8
    """Cells around a quarter of a circle, of a ring or a sweep; a section without a hole has twice those of its radius."""
    part: Part = "quarter"
    """What is computed in 3D and in plane strain: planes of symmetry through the axis bound a half (y = 0) or a quarter (x = 0,
    y = 0)."""

    def _radii(self) -> Array:
        return line_of(self.radial, self.inner_radius)

    def _rounded(self, names: tuple[str, str], mirrors: dict[str, int], part: Part = "quarter") -> Domain:
        """A part of a ring or a disc; ``names`` are the faces on the second and the first axis, if it ends there."""
        radii, quarters = self._radii(), SweepSymmetry[part.upper()].quarters
        mirrors = {name: axis for name, axis in mirrors.items() if axis in SweepSymmetry[part.upper()].value}
        if self.inner_radius > 0:
            angles = np.linspace(0, quarters * np.pi / 2, quarters * self.around + 1)
            end = {1: names[0], 2: names[1], 4: "end"}[quarters]
            ring = grid_domain((radii, angles), (("inner", "outer"), (names[1], end)), mirrors).mapped(polar)
            return ring.closed(names[1], end) if quarters == 4 else ring
        line = radii / radii[-1]
        across = np.concatenate([-line[:0:-1], line])
        first = "outer" if quarters > 1 else names[0], "outer"
        second = "outer" if quarters == 4 else names[1], "outer"
        lines = across if quarters > 1 else line, across if quarters == 4 else line
        return grid_domain(lines, (first, second), mirrors).mapped(lambda nodes: radii[-1] * disc(nodes))

    def _revolved(self, section: Domain) -> Domain:
        """The section turned about z."""
        symmetry = SweepSymmetry[self.part.upper()]
        prisms = float(len(section.mesh.elements)) * self.around * symmetry.quarters
        check_unknowns(PER_TETRAHEDRON * TETRAHEDRA_OF_PRISM * prisms, "geometry: cells along the radius, the axis and around it")
        turned = swept(section.mesh, self.around * symmetry.quarters, symmetry.quarters * np.pi / 2)
        faces = {name: turned.facets_from(edges) for name, edges in section.faces.items() if name != "axis"}
        boundary, _ = turned.mesh.boundary_facets()
        places = turned.mesh.nodes[boundary]
        mirrors = {f"{'xy'[axis]}_plane": axis for axis in symmetry.value}
        faces |= {name: boundary[(places[..., axis] == 0).all(axis=1)] for name, axis in mirrors.items()}
        mirrors |= {name: 2 for name, axis in section.mirrors.items() if axis == 1}
        return Domain(turned.mesh, faces, mirrors)


class CylinderGeometry(RoundGeometry):
    """A cylinder or a tube about z, its bottom at z = 0; faces outer, inner, bottom, top.

    In plane strain it is long along z, and a part of its section is computed: the faces x_plane (x = 0) and y_plane (y = 0) where
    a half or a quarter ends are planes of symmetry.
    """

    kind: Literal["cylinder"] = "cylinder"
    axial: Spans | None = None
    """Cells along z; none in plane strain."""

    def domain(self, dimension: Dimension) -> Domain:
        """A section, or that section swept.

        Raises
        ------
        ValueError
            If it has none in this dimension, or lacks the cells that it needs there.
        """
        if (self.axial is None) != (dimension == "plane_strain"):
            raise ValueError(
                "geometry.axial belongs to a cylinder in 3d or axisymmetric, which needs it, and to none in plane_strain"
            )
        if self.axial is None:
            return self._rounded(("x_plane", "y_plane"), {"x_plane": 0, "y_plane": 1}, self.part)
        inside = "axis" if self.inner_radius == 0 else "inner"
        section = grid_domain((self._radii(), line_of(self.axial)), ((inside, "outer"), ("bottom", "top")))
        return section if dimension == "axisymmetric" else self._revolved(section)


class BallGeometry(RoundGeometry):
    """The upper half of a ball or a hollow sphere about the origin; faces outer and inner.

    The equator (z = 0) is a plane of symmetry.
    """

    kind: Literal["ball"] = "ball"

    def domain(self, dimension: Dimension) -> Domain:
        """A quarter of the meridian, or that swept.

        Raises
        ------
        ValueError
            If it has none in this dimension, or lacks the cells that it needs there.
        """
        if dimension == "plane_strain":
            raise ValueError("a ball has no section in plane_strain; allowed dimensions: 3d, axisymmetric")
        section = self._rounded(("axis", "equator"), {"equator": 1})
        return section if dimension == "axisymmetric" else self._revolved(section)


AnyGeometry = Annotated[
    BlockGeometry | QuadrilateralGeometry | PlateGeometry | CylinderGeometry | BallGeometry, Field(discriminator="kind")
]
