"""The deformed section of an axisymmetric body, mirrored about its axis so that both halves are seen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Patch
from matplotlib.tri import Triangulation

from tactsim.array import Array
from tactsim.plotting.canvas import REGION_COLOURS, extension, robust_limits, scale_of, with_minus
from tactsim.plotting.plane_cut import QUARTERS
from tactsim.results import FieldFrame
from tactsim.results.fields import DISPLACEMENT, REGION

_EDGES = [[0, 3, 1], [1, 4, 2], [2, 5, 0]]
_PARABOLA = np.linspace(0, 1, 7)


@dataclass(frozen=True)
class Section:
    """Six-node triangles in the (r, z) half-plane with their deformation, in mm."""

    frame: FieldFrame

    @cached_property
    def places(self) -> Array:
        """Deformed nodes (n, 2) in mm."""
        return 1e3 * (self.frame.points + self.frame.point_data[DISPLACEMENT])[:, :2]

    @property
    def elements(self) -> Array:
        """Triangles (E, 6) in the order of VTK."""
        return self.frame.cells["triangle6"]

    def weights(self) -> Array:
        """Area in mm^2 that belongs to each node, (n,)."""
        corners = self.places[self.elements[:, :3]]
        (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
        return np.bincount(self.elements.ravel(), np.repeat(np.abs(ax * by - ay * bx) / 12, 6), len(self.places))

    def curves(self, edges: Array) -> Array:
        """Points (k, 7, 2) in mm of edges given as (k, 3): first, middle and last node of a parabola."""
        t = _PARABOLA[:, None]
        first, middle, last = (self.places[edges[:, [k]]] for k in range(3))
        return (1 - t) * (1 - 2 * t) * first + 4 * t * (1 - t) * middle + t * (2 * t - 1) * last

    def edges(self) -> tuple[Array, Array]:
        """Every edge once (k, 3), and whether it bounds the body or parts two regions."""
        edges = self.elements[:, _EDGES].reshape(-1, 3)
        regions = self.frame.cell_data.get(REGION, np.zeros(len(self.elements)))
        owners = np.repeat(np.asarray(regions).ravel(), 3)
        _, first, group, count = np.unique(edges[:, 1], return_index=True, return_inverse=True, return_counts=True)
        spread = np.zeros(len(first), bool)
        np.logical_or.at(spread, group, owners != owners[first][group])
        on_axis = np.abs(self.frame.points[edges[first, 1], 0]) < 1e-12
        return edges[first], ((count == 1) & ~on_axis) | spread


def pressure_scale(section: Section, pressure: Array, seen: Array) -> tuple[tuple[float, float], float, str]:
    """Limits of the colours of a nodal pressure (n,) in Pa where it is seen, and factor and unit in which it is shown."""
    low, high = robust_limits(pressure[seen], section.weights()[seen])
    factor, unit = scale_of(max(abs(low), abs(high)), "Pa")
    return (factor * low, factor * high), factor, unit


def pressure_bar(axis: Axes, drawn: Any, pressure: Array, limits: tuple[float, float], unit: str) -> None:
    """The colours of a pressure (n,) in a unit, pointed where values lie beyond the limits of the colours."""
    extend = extension(pressure, limits)
    bar = axis.figure.colorbar(drawn, ax=axis, extend=extend, location="bottom", shrink=0.6, aspect=32, pad=0.02)
    ends = [with_minus(f"{float(f'{end:.3g}'):g}") for end in (pressure.min(), pressure.max())]
    beyond = {"neither": "", "min": f"down to {ends[0]}", "max": f"up to {ends[1]}", "both": f"from {ends[0]} to {ends[1]}"}
    arrows = f"\narrows: what lies beyond them, {beyond[extend]} {unit}" if beyond[extend] else ""
    bar.set_label(f"pressure in {unit} (colours: 1st to 99th percentile of the area){arrows}")
    bar.outline.set_linewidth(0.5)


def draw_field(axis: Axes, section: Section, values: Array, sides: tuple[float, ...], **style: Any) -> Any:
    """Colours the section, or its mirror image where a side is -1, by nodal values (n,); returns the last side's mappable."""
    quarters = section.elements[:, QUARTERS].reshape(-1, 3)
    r, z = section.places.T
    for side in sides:
        drawn = axis.tripcolor(Triangulation(side * r, z, quarters), values, shading="gouraud", rasterized=True, **style)
    return drawn


def draw_regions(axis: Axes, section: Section, sides: tuple[float, ...]) -> None:
    """The elements in the colour of their region, with a legend if there are several: layers from the top, then the tissue."""
    regions = np.asarray(section.frame.cell_data.get(REGION, np.zeros(len(section.elements)))).ravel().round().astype(int)
    quarters = section.elements[:, QUARTERS].reshape(-1, 3)
    shades = np.array([REGION_COLOURS[k % len(REGION_COLOURS)] for k in np.roll(range(regions.max() + 1), -1)])
    for side in sides:
        corners = (section.places * [side, 1.0])[quarters]
        colours = np.repeat(shades[regions], len(QUARTERS))
        axis.add_collection(PolyCollection(list(corners), facecolors=colours, edgecolors="face", linewidths=0.7, rasterized=True))
    if len(shades) > 1:
        names = [*(f"layer {k}" for k in range(1, len(shades))), "tissue below"]
        patches = [Patch(facecolor=shade, label=name) for shade, name in zip(shades, names, strict=True)]
        axis.legend(handles=patches, loc="lower right", fontsize=7.5, frameon=True)


def draw_mesh(axis: Axes, section: Section, sides: tuple[float, ...], meshed: tuple[float, ...]) -> None:
    """Boundary and interfaces on the sides (1.0, and -1.0 for the mirror image), the elements faintly on those in ``meshed``."""
    edges, outline = section.edges()
    style: dict[str, Any] = {"colors": "k", "linewidths": 0.25, "alpha": 0.35, "rasterized": True}
    for side in sides:
        mirror = np.array([side, 1.0])
        if side in meshed:
            axis.add_collection(LineCollection(list(section.curves(edges) * mirror), **style))
        axis.add_collection(LineCollection(list(section.curves(edges[outline]) * mirror), colors="k", linewidths=0.9))


def draw_body(axis: Axes, distance: Array, grid: tuple[Array, Array], sides: tuple[float, ...]) -> None:
    """A rigid body filled from its signed distance on a grid (r, z) in mm, mirrored where a side is -1."""
    r, z = grid
    for side in sides:
        axis.contourf(side * r, z, distance, levels=[-np.inf, 0.0], colors=["#c8ccd2"], zorder=3)
        axis.contour(side * r, z, distance, levels=[0.0], colors=["#30363d"], linewidths=1.1, zorder=3)
