"""tactsim on the block: python tactsim_block.py WARM_UP.npz PROBLEM.npz RESULT.npz; mixed form, P2 and P1."""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

import numpy as np
from block_problem import read

import tactsim
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.solvers.linear import solved
from tactsim.fem.solvers.reused_factor import ReusedFactor
from tactsim.fem.solvers.solver_choice import solver_for
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.neo_hookean import NeoHookean

Array = np.ndarray
START = 1e-4
"""Accuracy of the linear step that starts the path; Newton mends what it lacks."""


def body_of(problem: dict[str, Array]) -> Body:
    """The block, tissue and ball."""
    c10, c01, c11 = problem["mooney"]
    bulk = problem["bulk"]
    tissue = MooneyRivlin3(c10=c10, c01=c01, c11=c11, bulk_modulus=bulk[0])
    ball = NeoHookean(c10=float(problem["ball_shear"]) / 2, bulk_modulus=bulk[1])
    return Body(TaylorHood(problem["nodes"], problem["elements"], "solid"), [tissue, ball], problem["regions"])


def started(posed: Problem, moved: Array) -> Array:
    """Unknowns of the linear problem with the prescribed unknowns of ``moved`` (size,), which is zero elsewhere."""
    body = posed.body
    data = body.tangent(np.zeros(body.space.size))
    right = posed.constraints.free(-(body.pattern.matrix(data) @ moved))
    matrix = body.pattern.matrix(posed.constraints.apply(data))
    return moved + solved(posed.solver, matrix, right, START)


def solve(problem: dict[str, Array]) -> dict[str, object]:
    """Seconds and iterations of every step, and the reactions (n, 3) in N at the top after the last."""
    begin = time.perf_counter()
    body = body_of(problem)
    fixed = (3 * np.concatenate([problem["bottom"], problem["top"]])[:, None] + np.arange(3)).ravel()
    solver = solver_for(body)
    posed = Problem(body, fixed, solver=solver, options=NewtonOptions(tolerance=float(problem["tolerance"])))
    setup, seconds, iterations = time.perf_counter() - begin, [], []
    path = [np.zeros(body.space.size)]
    used = time.process_time()
    for level in problem["levels"]:
        begin = time.perf_counter()
        if len(path) == 1:
            moved = np.zeros(body.space.size)
            moved[3 * problem["top"] + 2] = level
            guess = started(posed, moved)
        else:
            guess = extrapolated(path)
        solved = posed.solve(guess)
        path.append(solved.unknowns)
        seconds.append(time.perf_counter() - begin)
        iterations.append(solved.iterations)
    used = time.process_time() - used
    reaction, _ = body.space.split(body.residual(path[-1], solved.kinematics))
    solver.close()
    reused = getattr(solver, "current", None)
    counts = (reused.factorisations, reused.solutions) if isinstance(reused, ReusedFactor) else (np.nan, np.nan)
    return {
        "setup_seconds": setup,
        "step_seconds": seconds,
        "processor_seconds": used,
        "iterations": iterations,
        "factorisations": counts[0],
        "solutions": counts[1],
        "unknowns": body.space.size,
        "forces": reaction[problem["top"]],
        "version": tactsim.__version__,
    }


def extrapolated(path: list[Array]) -> Array:
    """Unknowns after one more step of the same length, by the polynomial through the last three states at most."""
    if len(path) == 2:
        return 2 * path[-1] - path[-2]
    return 3 * (path[-1] - path[-2]) + path[-3]


def main() -> None:
    """Solve the small problem untimed, so that the loops are compiled, then the other."""
    warm_up, path, result = map(Path, sys.argv[1:])
    solve(read(warm_up))
    solution = solve(read(path))
    solution["peak_megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    np.savez(result, **solution)


if __name__ == "__main__":
    main()
