"""Designs: the point of every sample in the unit cube, a function of the seed and the number of the sample."""

from __future__ import annotations

import math
import warnings
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.stats import qmc

Array = np.ndarray
DesignName = Literal["sobol", "latin_hypercube", "random", "grid"]
BLOCK = 1024
"""Sobol points that are made together; a power of two keeps their balance."""


def design_point(design: DesignName, seed: tuple[int, ...], number: int, *, count: int, dimensions: int) -> Array:
    """Point (dimensions,) in [0, 1) of a sample.

    Sobol points (scrambled) and random ones depend on the seed and the number alone; of a Latin hypercube, which is defined by
    the number of its points, they depend on ``count`` as well. A grid has no points: see `grid_point`.
    """
    if dimensions == 0:
        return np.zeros(0)
    if design == "random":
        return np.random.default_rng([*seed, number]).random(dimensions)
    if design == "latin_hypercube":
        return _latin_hypercube(seed, count, dimensions)[number]
    return _sobol(seed, number // BLOCK, dimensions)[number % BLOCK]


def redrawn_point(seed: tuple[int, ...], number: int, attempt: int, dimensions: int) -> Array:
    """Point (dimensions,) of a sample whose case was refused ``attempt`` times before: random, whatever the design."""
    return np.random.default_rng([*seed, number, attempt]).random(dimensions)


def grid_point(sizes: tuple[int, ...], number: int) -> Array:
    """Point (len(sizes),) in the middle of the cell of a number; the last place varies fastest."""
    index = np.array(np.unravel_index(number, sizes) if sizes else (), dtype=float)
    return (index + 0.5) / np.array(sizes, dtype=float)


def grid_size(sizes: tuple[int, ...]) -> int:
    """Number of cells."""
    return math.prod(sizes)


@lru_cache(maxsize=4)
def _latin_hypercube(seed: tuple[int, ...], count: int, dimensions: int) -> Array:
    return qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(count)


@lru_cache(maxsize=8)
def _sobol(seed: tuple[int, ...], block: int, dimensions: int) -> Array:
    engine = qmc.Sobol(dimensions, rng=np.random.default_rng(seed))
    if block:
        engine.fast_forward(block * BLOCK)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of balance, which whole blocks keep
        return engine.random(BLOCK)
