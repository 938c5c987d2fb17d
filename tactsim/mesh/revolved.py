"""Sections swept around their axis into quadratic tetrahedra: graded as the section is, and the same every time."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from enum import Enum

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.mesh.quadratic import EDGES, QuadraticMesh, quadratic_mesh

LARGEST_SECTOR = np.pi / 4
"""Wider sectors turn the elements beside the axis nearly inside out."""
LARGEST_SQUEEZE = 0.6
"""Largest part by which moving the side of a cylinder may shorten an element; the steepest slope of the map is 1.5."""
_THIRDS = np.array([[[0, 0], [1, 0], [2, 0], [2, 1]], [[0, 0], [1, 0], [1, 1], [2, 1]], [[0, 0], [0, 1], [1, 1], [2, 1]]])
"""Corners of the three tetrahedra of a prism: place in the ascending triangle, and 0 before or 1 after the sector. The one in row
2 - i holds corner i twice, which is flat if that corner lies on the axis."""


class SweepSymmetry(Enum):
    """The part of a body that is computed; its value names the axes that mirror planes are normal to."""

    WHOLE = ()
    HALF = (1,)
    QUARTER = (0, 1)

    @property
    def quarters(self) -> int:
        """Quarter turns of the part."""
        return 4 // 2 ** len(self.value)

    @property
    def mirrors(self) -> Array:
        """Signs (m, 3) of the coordinates of the m images that make up the whole."""
        choices = [(1.0, -1.0) if axis in self.value else (1.0,) for axis in range(3)]
        return np.array(list(itertools.product(*choices)))


@dataclass(frozen=True)
class Swept:
    """A body of revolution, or the part of it between two planes through its axis.

    Attributes
    ----------
    mesh : quadratic tetrahedra with nodes (x, y, z) in m, z along the axis; the plane of the section is y = 0, x >= 0
    section_nodes : (n,) node of the section that each node was swept from
    """

    mesh: QuadraticMesh
    section_nodes: Array

    def facets_from(self, edges: Array) -> Array:
        """Outward boundary facets (F, 6) that boundary edges (k, 3) of the section, by node numbers, were swept to."""
        swept = np.zeros(self.section_nodes.max() + 1, bool)
        swept[np.unique(edges)] = True
        facets, _ = self.mesh.boundary_facets()
        return facets[swept[self.section_nodes[facets]].all(axis=1)]


def swept(section: QuadraticMesh, sectors: int, turn: float = 2 * np.pi) -> Swept:
    """The section (r, z), r >= 0, turned about r = 0 by an angle ``turn`` in rad, in equal ``sectors``.

    Every triangle makes a prism in every sector, which is split into three tetrahedra by the order of the section's nodes;
    neighbouring sectors mirror each other, so that half a body with mirror planes has the elements of the whole. The middles
    of edges lie on the true circles.

    Raises
    ------
    InputError
        If a sector is wider than 45 degrees, or a closed body has an odd number of them.
    """
    closed = turn >= 2 * np.pi * (1 - 1e-12)
    if turn <= 0 or turn > 2 * np.pi * (1 + 1e-12) or sectors < turn / LARGEST_SECTOR * (1 - 1e-12) or (closed and sectors % 2):
        few, angle = int(np.ceil(turn / LARGEST_SECTOR * (1 - 1e-12))), np.degrees(turn)
        raise InputError(f"{sectors} sectors of {angle:g} degrees; allowed: at least {few}, and an even number of a whole body")
    count, planes = section.corner_count, sectors if closed else sectors + 1
    on_axis = section.nodes[:count, 0] == 0.0
    numbers = np.zeros((count, planes), np.int64)
    numbers[~on_axis] = np.arange((~on_axis).sum() * planes).reshape(-1, planes)
    numbers[on_axis] = ((~on_axis).sum() * planes + np.arange(on_axis.sum()))[:, None]
    places = np.zeros((numbers.max() + 1, 2), np.int64)
    places[numbers] = np.stack(np.broadcast_arrays(np.arange(count)[:, None], np.arange(planes)), axis=-1)
    simplices, triangles = _prisms(np.sort(section.elements[:, :3], axis=1), on_axis, sectors)
    simplices = numbers[simplices[..., 0], simplices[..., 1] % planes]
    angles = np.where(on_axis[places[:, 0]], 0.0, turn / sectors * places[:, 1])
    straight = quadratic_mesh(_turned(section.nodes[places[:, 0]], angles), simplices, section.regions[triangles])
    return _rounded(straight, section, places, sectors=sectors, turn=turn)


def _prisms(triangles: Array, on_axis: Array, sectors: int) -> tuple[Array, Array]:
    """Tetrahedra (E, 4, 2) by section node and plane, and the triangle (E,) that each comes from."""
    prisms, owners = [], []
    for sector in range(sectors):
        for place, third in zip((2, 1, 0), _THIRDS, strict=True):
            keep = np.flatnonzero(~on_axis[triangles[:, place]])
            after = third[:, 1] if sector % 2 == 0 else 1 - third[:, 1]
            planes = np.broadcast_to(sector + after, (len(keep), 4))
            prisms.append(np.stack([triangles[keep][:, third[:, 0]], planes], axis=-1))
            owners.append(keep)
    return np.concatenate(prisms), np.concatenate(owners)


def _rounded(straight: QuadraticMesh, section: QuadraticMesh, places: Array, *, sectors: int, turn: float) -> Swept:
    """The mesh with the middles of its edges half way in angle; ``places`` (n, 2) are section node and plane of the corners."""
    ends = places[straight.elements[:, EDGES[3]]].reshape(-1, 2, 2)
    middles, first = np.unique(straight.elements[:, 4:].ravel(), return_index=True)
    ends = ends[first]
    nodes, planes = ends[..., 0], ends[..., 1].copy()
    axial = section.nodes[nodes, 0] == 0.0
    planes = np.where(axial, planes[:, ::-1], planes)
    across = (planes == 0) & (planes[:, ::-1] > 1)
    planes[across] = sectors
    between = _middles(section, nodes)
    origin = np.concatenate([places[:, 0], between])
    coordinates = straight.nodes.copy()
    coordinates[middles] = _turned(section.nodes[between], turn / sectors * planes.mean(axis=1))
    return Swept(straight.moved(coordinates), origin)


def _middles(section: QuadraticMesh, pairs: Array) -> Array:
    """The section's node (n,) between two of its corners (n, 2), which may be the same."""
    count = section.corner_count
    (edges, known), pairs = section.edges(), np.sort(pairs, axis=1)
    keys = edges @ [count, 1]
    at = np.minimum(np.searchsorted(keys, pairs @ [count, 1]), len(keys) - 1)
    return np.where(pairs[:, 0] == pairs[:, 1], pairs[:, 0], known[at])


def _turned(nodes: Array, angles: Array) -> Array:
    """Points (n, 3) in m of section nodes (n, 2) turned by angles in rad; exact at multiples of a right angle."""
    return np.column_stack([polar(np.column_stack([nodes[:, 0], angles])), nodes[:, 1]])


def polar(nodes: Array) -> Array:
    """Places (n, 2) in the plane of nodes (n, 2) given by radius in m and angle in rad; exact on both axes."""
    r, angle = nodes.T
    cosine, sine = np.cos(angle), np.sin(angle)
    cosine, sine = (np.where(np.abs(part) < 1e-14, 0.0, part) for part in (cosine, sine))
    return np.column_stack([r * cosine, r * sine])


def shifted_outside(nodes: Array, offset: float, *, radius: float, rest: float) -> Array:
    """Nodes (n, 3) in m of a cylinder about z moved along x, none within ``rest`` of the axis, all of its side by ``offset``.

    The map is smooth and one to one while ``offset`` stays below ``largest_offset``; ``radius`` is that of the side.
    """
    share = np.clip((np.hypot(nodes[:, 0], nodes[:, 1]) - rest) / (radius - rest), 0.0, 1.0)
    moved = nodes.copy()
    moved[:, 0] += offset * share**2 * (3 - 2 * share)
    return moved


def largest_offset(radius: float, rest: float) -> float:
    """Largest distance in m by which ``shifted_outside`` should move the side of a cylinder."""
    return LARGEST_SQUEEZE * (radius - rest) / 1.5
