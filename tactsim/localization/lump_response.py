"""How the forces on all taxels change when a ball in the block is stiffer or softer than the tissue: the fast forward model.

To first order in the contrast the change is an integral over the ball of a density that depends on the plain tissue alone. It is
tabulated for balls of several radii on a grid of centres, and interpolated between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
import scipy

from tactsim.analytic.eshelby_ball import stiffness_ratio_of
from tactsim.array import Array
from tactsim.deadline import check_time
from tactsim.errors import InvalidQuantity
from tactsim.mesh.block import part_of_usual

MOST_TOLD_APART = 10
"""Ratio of stiffness beyond which the contrast hardly changes."""
FINER = 4
"""Parts per side of a voxel by which the share of a voxel in a ball is computed."""


@dataclass(frozen=True, eq=False)
class LumpResponse:
    """Change of force in N for a contrast of one.

    Attributes
    ----------
    axes : three ascending arrays of centres in m along x, y and z
    radii : (R,) ascending, in m
    values : (R, nx, ny, nz, jaw, row, column) in N

    Raises
    ------
    InvalidQuantity
        If the values do not have that shape or are not finite.
    """

    axes: tuple[Array, Array, Array]
    radii: Array
    values: Array
    _interpolator: scipy.interpolate.RegularGridInterpolator = field(init=False, repr=False)

    def __post_init__(self) -> None:
        shape = (len(self.radii), *map(len, self.axes))
        if self.values.shape[:4] != shape or self.values.ndim != 7 or not np.isfinite(self.values).all():
            raise InvalidQuantity(f"values of shape {self.values.shape}; needed: finite, {shape} and (jaw, row, column)")
        interpolator = scipy.interpolate.RegularGridInterpolator((self.radii, *self.axes), self.values, bounds_error=True)
        object.__setattr__(self, "_interpolator", interpolator)

    @classmethod
    def of_density(
        cls, places: Array, volumes: Array, densities: Array, *, size: Sequence[float], radii: Array, spacing: float
    ) -> Self:
        """Integrals over balls of a density given at points, on a grid of voxels.

        Parameters
        ----------
        places, volumes : (n, 3) in m and (n,) in m^3 of quadrature points that fill the block
        densities : (jaw, row, column, n) in N/m^3
        size : (3,) of the block in m
        radii : (R,) of the balls in m
        spacing : of the centres in m, at most; it divides the block evenly

        Raises
        ------
        InvalidQuantity
            If a response is not finite.
        OutOfTime
            If the time limit has passed, or another thread has stopped the computation.
        """
        counts = [max(2, int(np.ceil(side / spacing))) for side in size]
        edges = [np.linspace(0, side, count + 1) for side, count in zip(size, counts, strict=True)]
        cell = np.array([edge[1] for edge in edges])
        index = np.ravel_multi_index(
            [np.clip((places[:, k] / cell[k]).astype(int), 0, counts[k] - 1) for k in range(3)], tuple(counts)
        )
        flat = densities.reshape(-1, densities.shape[-1]) * volumes
        voxels = np.stack([np.bincount(index, row, int(np.prod(counts))) for row in flat]).reshape(-1, *counts)
        values = []
        for radius in radii:
            check_time()
            ball = _ball(float(radius), cell)
            values.append(scipy.signal.oaconvolve(voxels, ball[None], mode="same", axes=(1, 2, 3)))
        table = np.moveaxis(np.stack(values), 1, -1).reshape(len(radii), *counts, *densities.shape[:-1])
        centres = tuple((edge[:-1] + edge[1:]) / 2 for edge in edges)
        return cls(centres, np.asarray(radii, dtype=float), table)  # type: ignore[arg-type]

    def signal(self, centers: Array, radii: Array) -> Array:
        """Change of force (n, jaw, row, column) in N for balls with centres (n, 3) and radii (n,) in m and a contrast of one.

        Raises
        ------
        InvalidQuantity
            If a ball lies outside the table.
        """
        try:
            return self._interpolator(np.column_stack([radii, centers]))
        except ValueError as error:
            raise InvalidQuantity(f"a ball outside the table of the response: {error}") from None


@dataclass(frozen=True, eq=False)
class Tabulation:
    """The balls of a table: ascending ``radii`` (R,) and the ``spacing`` of the centres in m, both less in a small block
    (``mesh.block.part_of_usual``), and about how many centres there are at most."""

    radii: Array
    spacing: float
    most_centres: int

    def radii_in(self, size: Sequence[float]) -> Array:
        """Radii in m of those that fit into a block of this size (3,) in m."""
        radii = part_of_usual(size) * self.radii
        return np.asarray(radii[min(size) > 2 * radii])

    def spacing_in(self, size: Sequence[float]) -> float:
        """Distance in m of the centres in a block of this size (3,) in m."""
        return max(part_of_usual(size) * self.spacing, float(np.prod(size) / self.most_centres) ** (1 / 3))


def stiffness_words(contrast: float, deviation: float = 0.0) -> str:
    """The stiffness of a ball of this contrast, dimensionless, in words, from one standard deviation below to one above."""
    low, high = (stiffness_ratio_of(contrast + off) for off in (-deviation, deviation))
    least, most = (f"{one:.2g}" if one <= MOST_TOLD_APART else f"more than {MOST_TOLD_APART:g}" for one in (low, high))
    return f"{most if least == most else f'{least} to {most}'} times as stiff as the tissue at this closing"


def _ball(radius: float, cell: Array) -> Array:
    """Share (a, b, c) of each voxel of a centred grid that lies in a ball, odd in each direction, with the ball's volume."""
    reach = np.ceil(radius / cell + 0.5).astype(int)
    halves = [n * FINER + FINER // 2 for n in reach]
    lines = [(np.arange(-half, half) + 0.5) / FINER * side for half, side in zip(halves, cell, strict=True)]
    inside = sum(line.reshape([-1 if k == axis else 1 for k in range(3)]) ** 2 for axis, line in enumerate(lines)) <= radius**2
    shape = [part for n in reach for part in (2 * n + 1, FINER)]
    shares = np.asarray(inside).reshape(shape).mean(axis=(1, 3, 5))
    return shares * (4 / 3 * np.pi * radius**3) / (shares.sum() * np.prod(cell))
