"""Where the centre of an inclusion lies with a stated probability: the smallest region that holds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import scipy
from contourpy import contour_generator

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces.estimate import LEVEL, Region
from tactsim.localization.views import AWAY

CORNERS = 48
"""Of the polygon that stands for an ellipse."""


@dataclass(frozen=True, eq=False)
class CellRegion(Region):
    """A distribution over the cells of a regular grid.

    Attributes
    ----------
    axes : three arrays of the middles of the cells in m, each evenly spaced, at least two
    weights : (nx, ny, nz), not negative, of any sum above zero

    Raises
    ------
    InvalidQuantity
        On construction: weights of another shape, not finite, negative or all zero.
    """

    axes: tuple[Array, Array, Array]
    weights: Array

    @classmethod
    def of_centres(cls, axes: tuple[Array, Array, Array], centres: Array, weights: Array) -> Self:
        """The region of weighted centres (n, 3) in m, each of which is the middle of a cell; several may be that of one.

        Raises
        ------
        InvalidQuantity
            As on construction.
        """
        shape = tuple(map(len, axes))
        cells = np.ravel_multi_index([np.searchsorted(axis, along) for axis, along in zip(axes, centres.T, strict=True)], shape)
        return cls(axes, np.bincount(cells, weights, int(np.prod(shape))).reshape(shape))

    def __post_init__(self) -> None:
        weights = np.asarray(self.weights, dtype=float)
        if weights.shape != tuple(map(len, self.axes)) or min(weights.shape) < 2:
            raise InvalidQuantity(
                f"weights of shape {weights.shape} on axes of {[len(axis) for axis in self.axes]} cells, at least 2"
            )
        if not np.isfinite(weights).all() or weights.min() < 0 or weights.sum() <= 0:
            raise InvalidQuantity("the weights of a region must be finite and not negative, and not all zero")
        object.__setattr__(self, "weights", weights / weights.sum())

    @cached_property
    def cell(self) -> Array:
        """Sides (3,) of a cell in m."""
        return np.array([float(axis[1] - axis[0]) for axis in self.axes])

    def inside(self, probability: float = LEVEL) -> Array:
        """Which cells (nx, ny, nz) belong to the region: the likeliest that reach the probability together.

        Raises
        ------
        InvalidQuantity
            If the probability is not between 0 and 1.
        """
        check_probability(probability)
        flat = self.weights.ravel()
        order = np.argsort(-flat, kind="stable")
        before = np.cumsum(flat[order]) - flat[order]
        chosen = np.zeros(flat.shape, bool)
        chosen[order] = (before < probability) & (flat[order] > 0)
        return chosen.reshape(self.weights.shape)

    def contains(self, point: Array, probability: float = LEVEL) -> bool:
        """Whether the cell of the point (3,) in m belongs to the region of a probability; a point beyond the grid does not."""
        lowest = np.array([float(axis[0]) for axis in self.axes]) - self.cell / 2
        index = np.floor((np.asarray(point, dtype=float) - lowest) / self.cell).astype(int)
        if (index < 0).any() or (index >= self.weights.shape).any():
            return False
        return bool(self.inside(probability)[tuple(index)])

    def sizes(self, probability: float = LEVEL) -> tuple[float, float]:
        """Diameter in m of the disc as large as the plan of the region's cells, and height in m of all layers that hold some."""
        chosen = self.inside(probability)
        area = float(chosen.any(axis=2).sum() * self.cell[0] * self.cell[1])
        return 2 * float(np.sqrt(area / np.pi)), float(chosen.any(axis=(0, 1)).sum() * self.cell[2])

    def shadow(self, away: int, probability: float = LEVEL) -> list[Array]:
        """Lines (n, 2) in m half-way between the middles of cells inside and outside; cells at the rim of the grid are whole."""
        chosen = np.pad(self.inside(probability).any(axis=away).astype(float), 1)
        steps = zip(self.axes, self.cell, strict=True)
        wider = [np.concatenate([axis[:1] - step, axis, axis[-1:] + step]) for axis, step in steps]
        first, second = (axis for k, axis in enumerate(wider) if k != away)
        return [np.asarray(line) for line in contour_generator(first, second, chosen.T).lines(0.5)]


@dataclass(frozen=True, eq=False)
class GaussianRegion(Region):
    r"""Ellipsoids :math:`(x - m)^T C^{-1} (x - m) \le q` with the quantile q of chi-squared with three degrees of freedom.

    Attributes
    ----------
    mean : (3,) in m
    covariance : (3, 3) in m^2, positive definite

    Raises
    ------
    InvalidQuantity
        On construction: a covariance that is not positive definite.
    """

    mean: Array
    covariance: Array

    def __post_init__(self) -> None:
        covariance = np.asarray(self.covariance, dtype=float)
        if covariance.shape != (3, 3) or not np.isfinite(covariance).all() or np.linalg.eigvalsh(covariance).min() <= 0:
            raise InvalidQuantity(f"a covariance of shape {covariance.shape}; needed: (3, 3), finite, positive definite")

    def contains(self, point: Array, probability: float = LEVEL) -> bool:
        """Whether the point (3,) in m lies in the ellipsoid of a probability."""
        away = np.asarray(point, dtype=float) - self.mean
        return bool(away @ np.linalg.solve(self.covariance, away) <= self._quantile(probability))

    def sizes(self, probability: float = LEVEL) -> tuple[float, float]:
        """Diameter in m of the disc as large as the plan of the ellipsoid, and its height in m."""
        quantile = self._quantile(probability)
        plan = float(np.linalg.det(np.asarray(self.covariance)[:2, :2]))
        return 2 * float(np.sqrt(quantile) * plan**0.25), 2 * float(np.sqrt(quantile * np.asarray(self.covariance)[2, 2]))

    def shadow(self, away: int, probability: float = LEVEL) -> list[Array]:
        """An ellipse, as a closed polygon (n, 2) in m."""
        across = [k for k in range(3) if k != away]
        root = np.linalg.cholesky(np.asarray(self.covariance)[np.ix_(across, across)])
        angles = np.linspace(0, 2 * np.pi, CORNERS + 1)
        circle = np.sqrt(self._quantile(probability)) * np.stack([np.cos(angles), np.sin(angles)])
        return [np.asarray(self.mean)[across] + (root @ circle).T]

    def _quantile(self, probability: float) -> float:
        check_probability(probability)
        return float(scipy.stats.chi2.ppf(probability, 3))


@dataclass(frozen=True, eq=False)
class OutlinedRegion(Region):
    """A region that is known by its outlines alone, for the one probability ``LEVEL``, as a result keeps it.

    Attributes
    ----------
    outlines : by view, closed lines (n, 2) in m
    """

    outlines: Mapping[str, Sequence[Array]]

    def contains(self, point: Array, probability: float = LEVEL) -> bool:
        """Whether the point (3,) in m lies within the outlines of every view.

        Raises
        ------
        InvalidQuantity
            If the probability is not that of the outlines.
        """
        self._check(probability)
        return all(_within(np.delete(point, away), self.outlines.get(view, ())) for view, away in AWAY.items())

    def sizes(self, probability: float = LEVEL) -> tuple[float, float]:
        """Diameter in m of the disc as large as the outlines from above, and height in m of those from the front, without gaps.

        Raises
        ------
        InvalidQuantity
            If the probability is not that of the outlines.
        """
        self._check(probability)
        lines = map(np.asarray, self.outlines.get("top", ()))  # a hole is outlined the other way round
        area = abs(sum((line[:-1, 0] * line[1:, 1] - line[:-1, 1] * line[1:, 0]).sum() for line in lines)) / 2
        heights = [np.asarray(line)[:, 1] for line in self.outlines.get("front", ())]
        height, reached = 0.0, -np.inf
        for low, high in sorted((float(along.min()), float(along.max())) for along in heights):
            height += max(0.0, high - max(low, reached))
            reached = max(reached, high)
        return 2 * float(np.sqrt(area / np.pi)), height

    def shadow(self, away: int, probability: float = LEVEL) -> list[Array]:
        """The outlines (n, 2) in m as they were kept.

        Raises
        ------
        InvalidQuantity
            If the probability is not that of the outlines.
        """
        self._check(probability)
        view = next(name for name, axis in AWAY.items() if axis == away)
        return [np.asarray(line, dtype=float) for line in self.outlines.get(view, ())]

    def _check(self, probability: float) -> None:
        if probability != LEVEL:
            raise InvalidQuantity(f"a kept region of probability {probability}; known: {LEVEL}")


def _within(point: Array, lines: Sequence[Array]) -> bool:
    """Whether a point (2,) lies within closed lines: a ray from it crosses them an odd number of times."""
    crossings = 0
    for line in map(np.asarray, lines):
        (x0, y0), (x1, y1) = line[:-1].T, line[1:].T
        meets = (y0 > point[1]) != (y1 > point[1])
        crossings += int((meets & (point[0] < x0 + (x1 - x0) * (point[1] - y0) / np.where(meets, y1 - y0, 1.0))).sum())
    return crossings % 2 == 1


def check_probability(probability: float) -> None:
    """Refuse a probability that is not between 0 and 1.

    Raises
    ------
    InvalidQuantity
        Naming the probability.
    """
    if not 0 < probability < 1:
        raise InvalidQuantity(f"a region of probability {probability}; allowed: above 0 and below 1")


def shadows(region: Region) -> dict[str, list[list[list[float]]]]:
    """The outline of a region in every view, as plain numbers in m."""
    return {view: [line.tolist() for line in region.shadow(away)] for view, away in AWAY.items()}
