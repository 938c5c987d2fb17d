"""Newton's method for a program that assembles forces and a tangent of the block. It needs numpy only, no tactsim.

As in FElupe's, the first iteration of a step moves the held unknowns with the linearised others, and a step is done when the
forces at the free unknowns are ``tolerance`` of those at the held ones.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable
from typing import Protocol

import numpy as np

Array = np.ndarray
Problem = dict[str, Array]

ITERATIONS_LIMIT = 25
SAME_PLACE = 1e-9
"""Distance in m below which two nodes are one."""


class Discretisation(Protocol):
    """Displacements of the block in some program, in its own order of nodes, component i of the node a at 3 a + i."""

    version: str
    positions: Array
    """Nodes (n, 3) in m."""

    def forces(self, displacements: Array) -> Array:
        """Internal forces (3 n,) in N."""
        ...

    def correction(self, displacements: Array, forces: Array, held: Array, moved: Array) -> Array:
        """Change (3 n,) in m, ``moved`` (3 n,) at ``held``, by which the linearised forces vanish at the free unknowns."""
        ...


def numbering(own: Array, theirs: Array) -> Array:
    """Numbers in ``theirs`` (n, 3) of the nodes ``own`` (n, 3), both in m."""
    own_order, their_order = (np.lexsort(np.round(nodes / SAME_PLACE).T) for nodes in (own, theirs))
    if own.shape != theirs.shape or np.abs(own[own_order] - theirs[their_order]).max() > SAME_PLACE:
        raise ValueError(f"the program's {len(theirs)} nodes are not the problem's {len(own)}")
    numbers = np.empty(len(own), dtype=int)
    numbers[own_order] = their_order
    return numbers


def step(block: Discretisation, displacements: Array, held: Array, moved: Array, tolerance: float) -> tuple[Array, Array, int]:
    """Displacements and forces after the held unknowns moved by ``moved`` (3 n,), and the iterations it took."""
    forces = block.forces(displacements)
    for iteration in range(1, ITERATIONS_LIMIT + 1):
        displacements = displacements + block.correction(displacements, forces, held, moved)
        forces, moved = block.forces(displacements), np.zeros_like(moved)
        ratio = np.linalg.norm(np.delete(forces, held)) / np.linalg.norm(forces[held])
        if not np.isfinite(ratio):
            raise ValueError(f"forces are not finite after {iteration} iterations")
        if ratio <= tolerance:
            return displacements, forces, iteration
    raise ValueError(f"forces at free unknowns are {ratio:.1e} of those at held ones after {ITERATIONS_LIMIT} iterations")


def solve(problem: Problem, start: Callable[[Problem], Discretisation]) -> dict[str, object]:
    """Seconds and iterations of every step, and the reactions (n, 3) in N at the top after the last."""
    begin = time.perf_counter()
    block = start(problem)
    numbers = numbering(problem["nodes"], block.positions)
    top, bottom = numbers[problem["top"]], numbers[problem["bottom"]]
    held = (3 * np.concatenate([top, bottom])[:, None] + np.arange(3)).ravel()
    setup, seconds, iterations = time.perf_counter() - begin, [], []
    displacements = np.zeros(problem["nodes"].size)
    used = time.process_time()
    for height in np.diff(problem["levels"], prepend=0.0):
        begin = time.perf_counter()
        moved = np.zeros_like(displacements)
        moved[3 * top + 2] = height
        displacements, forces, count = step(block, displacements, held, moved, float(problem["tolerance"]))
        seconds.append(time.perf_counter() - begin)
        iterations.append(count)
    used = time.process_time() - used
    return {
        "setup_seconds": setup,
        "step_seconds": seconds,
        "processor_seconds": used,
        "iterations": iterations,
        "factorisations": sum(iterations),
        "solutions": sum(iterations),
        "unknowns": displacements.size,
        "forces": forces.reshape(-1, 3)[top],
        "version": block.version,
    }


def run(start: Callable[[Problem], Discretisation]) -> None:
    """WARM_UP.npz PROBLEM.npz RESULT.npz of the command line: solve the small problem untimed, then the other."""
    warm_up, path, result = sys.argv[1:]
    for name in (warm_up, path):
        with np.load(name) as stored:
            solution = solve(dict(stored), start)
    solution["peak_megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    np.savez(result, **solution)
