"""Balls and straight tubes that could lie in a block, with the change of force of each for unit contrast."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy
from pydantic import AfterValidator

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.readings import TissueResponse
from tactsim.localization.bodies import Bodies
from tactsim.mesh.block import part_of_usual
from tactsim.units import Length, Positive, format_quantity

LINE_STEP = 1e-3
"""Distance in m of the points on the centre line of a tube, and of parallel centre lines; less in a small block, as all below."""
ANGLES = 12
"""Directions of tubes over half a turn."""
CUTS = (0.25, 0.5, 0.75)
"""Fractions of a line's length in the block at which a tube may end."""
SAME_SPREAD = float(np.sqrt(5 / 4))
"""Radius of the ball over that of the circle with the same second moment along a diameter: r^2 / 5 and r^2 / 4."""
SAME = 1e-9
"""Largest relative difference of equal radii."""
BALL_RADII, TUBE_RADII, GAP = (2e-3, 7e-3), (2e-3, 5e-3), 0.5e-3
"""Radii in m between which balls and tubes are sought, and their distance from the faces."""
RADIUS_STEP = 1e-3
"""Of balls and tubes that are tried, in m."""


def _ordered(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] > limits[1]:
        least, largest = (format_quantity(limit, "m") for limit in limits)
        raise ValueError(f"the least radius {least} is above the largest {largest}; name the least first")
    return limits


RadiusLimits = Annotated[tuple[Positive[Length], Positive[Length]], AfterValidator(_ordered)]
"""Pydantic type of the least and the largest radius of what is sought."""


def _no_body(kind: str) -> InputError:
    """What is raised if no candidate of a kind is left."""
    return InputError(f"no {kind} of the tabulated radii fits into the block; take smaller radii or a smaller gap")


def limits_in(
    size: Sequence[float] | Array, given: tuple[float, float] | None, usual: tuple[float, float]
) -> tuple[float, float]:
    """Radii in m between which is sought in a block of this size (3,) in m: those given, or the usual ones."""
    return given or (part_of_usual(size) * usual[0], part_of_usual(size) * usual[1])


def gap_in(size: Sequence[float] | Array, given: float | None) -> float:
    """Least distance in m from the faces of a block of this size (3,) in m: that given, or the usual one."""
    return part_of_usual(size) * GAP if given is None else given


def radius_steps(limits: tuple[float, float], size: Sequence[float] | Array) -> list[float]:
    """Radii in m from the least to the largest, two at least, in steps of about a millimetre, less in a small block of ``size``
    (3,) in m."""
    return list(np.linspace(*limits, max(2, round((limits[1] - limits[0]) / (part_of_usual(size) * RADIUS_STEP)) + 1)))


@dataclass(frozen=True, eq=False)
class Candidates:
    """Bodies of one kind, all equally likely beforehand, and ``signals`` (n, taxels) in N of each for a contrast of one."""

    geometry: Bodies
    signals: Array

    def __len__(self) -> int:
        return len(self.geometry)

    def chosen(self, which: Array) -> Candidates:
        """The candidates of a mask (n,) or of indices (m,)."""
        begins, ends, radii = (part[which] for part in (self.geometry.begins, self.geometry.ends, self.geometry.radii))
        return Candidates(Bodies(self.geometry.kind, begins, ends, radii), self.signals[which])

    def felt_by(self, trusted: Array) -> Candidates:
        """The candidates with their signals on these taxels (jaw, row, column) alone: what an invalid one reads says nothing."""
        return self if trusted.all() else Candidates(self.geometry, np.ascontiguousarray(self.signals[:, trusted.ravel()]))


def ball_candidates(response: TissueResponse, size: Array, radii: Sequence[float], *, gap: float, every: int = 1) -> Candidates:
    """Balls at every ``every``-th centre of the table with the tabulated radii nearest to ``radii``, inside the block by a gap.

    All lengths are in m, ``size`` (3,) is that of the block. Of some centres only, none may fit.

    Raises
    ------
    InputError
        If none of all centres fits, or all radii lie beyond those of the table.
    """
    return _balls(response, size, _tabulated(response, radii), gap=gap, every=every)


def balls_between(response: TissueResponse, size: Array, limits: tuple[float, float], *, gap: float) -> Candidates:
    """Balls at every centre of the table with every tabulated radius between two limits, inside the block by a gap.

    All lengths are in m, ``size`` (3,) is that of the block.

    Raises
    ------
    InputError
        If none fits, or no radius of the table lies between the limits.
    """
    numbers = np.flatnonzero((response.radii >= limits[0] - 1e-12) & (response.radii <= limits[1] + 1e-12))
    if not len(numbers):
        raise _untabulated(response, limits)
    return _balls(response, size, numbers, gap=gap, every=1)


def _balls(response: TissueResponse, size: Array, numbers: Array, *, gap: float, every: int) -> Candidates:
    """Balls of the tabulated radii of these numbers at every ``every``-th centre of the table, inside the block by a gap in m."""
    axes = tuple(axis[every // 2 :: every] for axis in response.axes)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    room = np.minimum(grid, size - grid).min(axis=1)
    parts = []
    for k in numbers:
        fits = room >= response.radii[k] + gap
        picked = response.values[k][tuple(slice(every // 2, None, every) for _ in range(3))]
        parts.append((grid[fits], np.full(int(fits.sum()), response.radii[k]), picked.reshape(len(grid), -1)[fits]))
    centers, sizes, signals = (np.concatenate(part) for part in zip(*parts, strict=True))
    if not len(sizes) and every == 1:
        raise _no_body("ball")
    return Candidates(Bodies("sphere", centers, centers, sizes), np.ascontiguousarray(signals))


def tube_candidates(
    response: TissueResponse, size: Array, radii: Sequence[float], *, gap: float, closed: bool = True, spacing: float = LINE_STEP
) -> Candidates:
    r"""Straight level tubes of about these outer radii in every direction, through the block or, if ``closed``, ending in it.

    The change that a tube of radius r makes is the integral of the density over it. With the change S of a ball of radius
    :math:`r' = r \sqrt{5/4}`, whose second moment across the line is that of the circle, it is

    .. math:: \Delta F = \pi r^2 \int S(x(l)) \Big/ \tfrac{4}{3} \pi r'^3 \, dl

    as the ball's change over its volume is the density averaged over the ball. A tube that ends is a quarter of the way, half
    or three quarters through the block, from either side. ``spacing`` in m is that of lines in a block that is not small,
    ``size`` (3,) in m that of the block.

    Raises
    ------
    InputError
        If none fits, or all radii lie beyond those of the table.

    Source: derived here; r' follows from equal second moments across the line, :math:`r'^2 / 5 = r^2 / 4`.
    """
    heights = response.axes[2]
    lines = _lines(size, part_of_usual(size) * spacing)
    spans = [(0.0, 1.0)] + [span for cut in CUTS for span in ((0.0, cut), (cut, 1.0)) if closed]
    across = lines[1] - lines[0]
    firsts, lasts = (np.concatenate([lines[0] + end * across for end in ends]) for ends in zip(*spans, strict=True))
    table = _line_integrals(response, firsts, lasts, part_of_usual(size) * LINE_STEP)
    parts = []
    for k in _tabulated(response, radii, SAME_SPREAD):
        radius = float(response.radii[k]) / SAME_SPREAD
        level = np.flatnonzero(np.minimum(heights, size[2] - heights) >= radius + gap)
        inside = _beside(firsts, lasts, size) >= radius + gap
        factor = np.pi * radius**2 / (4 / 3 * np.pi * response.radii[k] ** 3)
        if not (inside.any() and len(level)):
            continue
        plane = response.values[k][:, :, level].reshape(len(response.axes[0]) * len(response.axes[1]), -1)
        signals = factor * (table[inside] @ plane).reshape(int(inside.sum()) * len(level), -1)
        z = np.tile(heights[level], int(inside.sum()))
        placed = [np.column_stack([np.repeat(points[inside], len(level), axis=0), z]) for points in (firsts, lasts)]
        parts.append((*placed, np.full(len(z), radius), signals))
    if not parts:
        raise _no_body("tube")
    begins, ends, sizes, responses = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Candidates(Bodies("tube", begins, ends, sizes), responses)


def _untabulated(response: TissueResponse, limits: tuple[float, float], factor: float = 1.0) -> InputError:
    """What is raised if the response knows no ball with a radius between limits in m, times ``factor``."""
    known = (float(radius) / factor for radius in response.radii[[0, -1]])
    words = [format_quantity(float(f"{radius:.4g}"), "m") for radius in (*limits, *known)]
    return InputError(
        f"no tabulated radius lies between {words[0]} and {words[1]}; the response of the tissue knows {words[2]} to {words[3]}"
    )


def _tabulated(response: TissueResponse, radii: Sequence[float], factor: float = 1.0) -> Array:
    """Numbers of the tabulated radii nearest to those wanted times ``factor``, each once."""
    wanted = factor * np.asarray(radii)
    if wanted.max() < response.radii[0] * (1 - SAME) or wanted.min() > response.radii[-1] * (1 + SAME):
        raise _untabulated(response, (min(radii), max(radii)), factor)
    return np.unique(np.abs(response.radii[:, None] - wanted).argmin(axis=0))


def _lines(size: Array, spacing: float) -> tuple[Array, Array]:
    """Both ends (n, 2) in plan of lines across the block in every direction, evenly spaced."""
    firsts, lasts = [], []
    middle = np.asarray(size[:2]) / 2
    for angle in np.arange(ANGLES) * np.pi / ANGLES:
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        reach = float(np.abs(across) @ middle)
        count = int(reach / spacing)
        for offset in np.arange(-count, count + 1) * spacing:
            span = _crossing(middle + offset * across, along, size)
            if span is not None:
                firsts.append(span[0])
                lasts.append(span[1])
    return np.array(firsts), np.array(lasts)


def _crossing(point: Array, along: Array, size: Array) -> tuple[Array, Array] | None:
    """Where a line through ``point`` enters and leaves the block in plan; None if it only touches it."""
    low, high = -np.inf, np.inf
    for axis in range(2):
        if abs(along[axis]) < 1e-9:
            continue
        both = np.sort(np.array([-point[axis], size[axis] - point[axis]]) / along[axis])
        low, high = max(low, float(both[0])), min(high, float(both[1]))
    return (point + low * along, point + high * along) if high - low > part_of_usual(size) * LINE_STEP else None


def _beside(firsts: Array, lasts: Array, size: Array) -> Array:
    """Least distance (n,) of each line from the corners of the block: a tube nearer than its radius would cut an edge."""
    corners = np.array([[0.0, 0.0], [size[0], 0.0], [0.0, size[1]], [size[0], size[1]]])
    along = (lasts - firsts) / np.linalg.norm(lasts - firsts, axis=1, keepdims=True)
    away = corners[None] - firsts[:, None]
    return np.abs(away[..., 0] * along[:, None, 1] - away[..., 1] * along[:, None, 0]).min(axis=1)


def _line_integrals(response: TissueResponse, firsts: Array, lasts: Array, longest: float) -> scipy.sparse.csr_array:
    """Weights in m (lines, nx ny) whose product with values at the centres in plan is their integral along each line, of which
    one point stands for ``longest`` in m at most."""
    counts = np.maximum(1, np.ceil(np.linalg.norm(lasts - firsts, axis=1) / longest).astype(int))
    line = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) / counts[line]
    points = firsts[line] + share[:, None] * (lasts - firsts)[line]
    step = (np.linalg.norm(lasts - firsts, axis=1) / counts)[line]
    lower, part = [], []
    for axis in range(2):
        centres = response.axes[axis]
        place = np.interp(points[:, axis], centres, np.arange(len(centres)))
        lower.append(np.minimum(place.astype(int), len(centres) - 2))
        part.append(place - lower[-1])
    entries, columns = [], []
    for i in (0, 1):
        for j in (0, 1):
            entries.append(step * (part[0] if i else 1 - part[0]) * (part[1] if j else 1 - part[1]))
            columns.append((lower[0] + i) * len(response.axes[1]) + lower[1] + j)
    shape = (len(counts), len(response.axes[0]) * len(response.axes[1]))
    return scipy.sparse.csr_array((np.concatenate(entries), (np.tile(line, 4), np.concatenate(columns))), shape=shape)
