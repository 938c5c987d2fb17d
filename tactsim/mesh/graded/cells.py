"""Cells of a graded block, and the rounded ones in the box around a lump: a core, a ring about it, layers out to the box."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.interfaces.solid import BallImage
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.fitting.layers import Layers
from tactsim.mesh.structured_block import blown, directions, grid, product, skin, stacked

LEAST_LAYERS = 3
"""Layers of cells between a body and the box around it, at least. With one, however small the cells along the surface, a ball of
75 times the modulus of the tissue, 3 mm below a jaw, presses on its taxel 18 % too hard, with two 5 %, with three 1 %."""
LAYER_GROWTH = 1.25
"""Thickness of a layer over that of the one beneath."""
CORE_PLACE, WALL_PLACE = 0.4, 0.8
"""Distances from the middle of the box, of which the sides are one away, at which core and wall count when cells are split."""


@dataclass(frozen=True)
class Cells:
    """Hexahedra that meet side to side.

    Attributes
    ----------
    corners : (n, 3) in m
    cells : (H, 8) corners of each, numbered by x + 2 y + 4 z in it
    regions : (H,)
    places : (n, 3) steps from the middle of the nearest box, whose sides are one away, by which cells are split
    layers : those around the bodies
    """

    corners: Array
    cells: Array
    regions: Array
    places: Array
    layers: Layers

    @classmethod
    def plain(cls, corners: Array, cells: Array, places: Array) -> Cells:
        """Cells (H, 8) of tissue with ``corners`` (n, 3) in m, in no layer, and their ``places`` (n, 3)."""
        return cls(corners, cells, np.zeros(len(cells), np.int64), places, Layers.none(len(corners)))

    def used(self) -> Cells:
        """The same without the corners of no cell."""
        used, compact = np.unique(self.cells, return_inverse=True)
        cells = compact.reshape(self.cells.shape)
        return Cells(self.corners[used], cells, self.regions, self.places[used], self.layers.kept(used))


@dataclass(frozen=True)
class Filling:
    """What boxes around bodies are filled with.

    Attributes
    ----------
    settings : of the mesh
    fewer : layers than are usual, where bodies are too close for these
    """

    settings: BlockMeshSettings
    fewer: int = 0

    @property
    def fans(self) -> bool:
        """Whether lumps hold a fan about their middle: cells of which one side has shrunk to it."""
        return self.settings.filling == "fan"

    def ends(self, wall: Array, box: Array) -> Array:
        """Where layers between corners (..., 3) in m of a body and those of its box end, as ascending parts of the distance.

        There are `LEAST_LAYERS`, and more where cells that grow from the size at inclusions to that of the block find room for
        them; less those that are to be ``fewer``.

        Raises
        ------
        InputError
            If the cells are too many.
        """
        settings, distance = self.settings, float(np.linalg.norm(box - wall, axis=-1).mean())
        steps = [settings.inclusion_size]
        while (further := min(steps[-1] * LAYER_GROWTH, settings.size)) + sum(steps) <= distance:
            steps.append(further)
            check_along(len(steps), f"mesh.inclusion_size {settings.inclusion_size:.3g} m")
        count = max(LEAST_LAYERS, len(steps)) - self.fewer
        if count != len(steps):
            steps = list(LAYER_GROWTH ** np.arange(count))
        return np.asarray(np.cumsum(steps)[:-1] / np.sum(steps))


def from_boxes(lines: int, first: ArrayLike, across: int) -> Array:
    """Places (lines,) of lines from the middle of the nearest box, whose sides are one away; boxes begin at lines ``first``."""
    steps = np.abs(np.arange(lines)[:, None] - np.atleast_1d(first) - across / 2)
    return np.asarray(from_box(steps, across / 2).min(axis=1))


def from_box(steps: Array, half: float) -> Array:
    """Places of lines by their ``steps`` from the middle of a box, of the same shape: 0 there, 1 at its sides, ``half`` away."""
    return np.where(steps > half, 1 + steps - half, steps / half)


def layer_places(unit: Array, ends: Array) -> list[Array]:
    """Places (n, ...) of corners in directions ``unit`` on a wall and at each end (k,) of a layer, within those of the box."""
    return [(WALL_PLACE + (1 - WALL_PLACE) * end) * np.abs(unit) for end in (0.0, *ends)]


def with_lump(
    cells: Cells,
    ball: BallImage,
    across: Sequence[int],
    on_box: Callable[[Array], Array],
    filling: Filling,
    *,
    region: int,
    turned: Callable[[Array], Array] = np.asarray,
) -> Cells:
    """The same with cells in a lump and around it in place of those of its box, which are gone already.

    Parameters
    ----------
    across : (3,) cells of the box along x, y and z
    on_box : numbers (s,) of the corners on the sides of the box, of which steps (3, s) from its first corner are given
    filling : of the box
    region : of the lump
    turned : moves points (n, 3) of the unit ball
    """
    logical = product([np.linspace(-1, 1, count + 1) for count in across])
    core = grid(across)
    shell, quads = skin(core, logical)
    sides = on_box(np.stack(np.unravel_index(shell, np.add(across, 1))))
    unit = directions(logical[shell])
    wall, box = ball.center + turned(unit) @ ball.stretch, cells.corners[sides]
    ends = filling.ends(wall, box)
    between = [wall + share * (box - wall) for share in ends]
    if filling.fans:
        inside, core, innermost = np.zeros((1, 3)), core[:0], np.zeros_like(shell)
    else:
        inside, innermost = blown(logical), shell
    added, rounded, depth = stacked(ball.center + turned(inside) @ ball.stretch, innermost, quads, core, [wall, *between, box])
    count, fresh = len(cells.corners), len(added) - len(shell)
    places = np.vstack([CORE_PLACE * np.abs(inside), *layer_places(unit, ends)])
    return Cells(
        np.vstack([cells.corners, added[:fresh]]),
        np.vstack([cells.cells, np.concatenate([count + np.arange(fresh), sides])[rounded]]),
        np.concatenate([cells.regions, np.where(depth < 1, region, 0)]),
        np.vstack([cells.places, places]),
        cells.layers.with_body(len(inside), sides, ends),
    )
