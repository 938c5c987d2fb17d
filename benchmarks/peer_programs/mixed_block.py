"""The block in the mixed form of a program that assembles forces and a tangent: reactions alone, no times.

P2 displacement, continuous P1 pressure. The discrete problem is tactsim's: W(F) + p (J - 1) - p^2 / 2 K at the same four points
of each tetrahedron.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Protocol

import numpy as np
from clamped_block import Array, Discretisation, Problem, numbering, step


class MixedDiscretisation(Discretisation, Protocol):
    """Displacements and pressures of the block in some program, in its own order."""

    displacements: Array
    """Unknowns (3 n,) that are displacements, component i of the node a at 3 a + i."""
    size: int
    """Number of all unknowns."""


def solve(problem: Problem, start: Callable[[Problem], MixedDiscretisation]) -> dict[str, object]:
    """The reactions (n, 3) in N at the top after the last step, and the version."""
    block = start(problem)
    numbers = numbering(problem["nodes"], block.positions)
    top, bottom = numbers[problem["top"]], numbers[problem["bottom"]]
    held = block.displacements[(3 * np.concatenate([top, bottom])[:, None] + np.arange(3)).ravel()]
    unknowns = np.zeros(block.size)
    for height in np.diff(problem["levels"], prepend=0.0):
        moved = np.zeros_like(unknowns)
        moved[block.displacements[3 * top + 2]] = height
        unknowns, forces, _ = step(block, unknowns, held, moved, float(problem["tolerance"]))
    return {"forces": forces[block.displacements].reshape(-1, 3)[top], "version": block.version}


def run(start: Callable[[Problem], MixedDiscretisation]) -> None:
    """PROBLEM.npz RESULT.npz of the command line."""
    path, result = sys.argv[1:]
    with np.load(path) as stored:
        solution = solve(dict(stored), start)
    np.savez(result, **solution)  # type: ignore[arg-type]
