"""FElupe on the block: python felupe_block.py {displacement,mixed} WARM_UP.npz PROBLEM.npz RESULT.npz. It needs no tactsim.

Lengths in mm and stresses in MPa, in which FElupe's residuals of force and volume are of like size. The energy is FElupe's own
(third-order deformation by automatic differentiation, in parallel chunks), the solver pypardiso's ``spsolve``.
"""

from __future__ import annotations

import resource
import sys
import time
from importlib.metadata import version

import felupe
import felupe.constitution.tensortrax as differentiated
import numpy as np
import pypardiso

MILLIMETRE, MEGAPASCAL = 1e-3, 1e6


def energies(problem, form):
    """Materials of the tissue and of the ball, K/2 (J - 1)^2 for the volume."""
    c10, c01, c11 = problem["mooney"] / MEGAPASCAL
    model = differentiated.models.hyperelastic.third_order_deformation
    tissue = differentiated.Hyperelastic(model, C10=c10, C01=c01, C11=c11, C20=0.0, C30=0.0, parallel=True)
    ball = felupe.NeoHooke(mu=float(problem["ball_shear"]) / MEGAPASCAL, parallel=True)
    bulk = problem["bulk"] / MEGAPASCAL
    if form == "mixed":
        return [felupe.NearlyIncompressible(energy, bulk=k) for energy, k in zip((tissue, ball), bulk, strict=True)]
    return [tissue & felupe.Volumetric(bulk=bulk[0], parallel=True), felupe.NeoHooke(ball.mu, bulk=bulk[1], parallel=True)]


def bodies(problem, form):
    """Field of the whole block, and a body for each region on the same points."""
    points, corners = problem["nodes"] / MILLIMETRE, int(problem["corner_count"])

    def field_on(cells):
        region = felupe.RegionQuadraticTetra(felupe.Mesh(points, cells, "tetra10"))
        if form == "mixed":
            return felupe.FieldsMixed(region, n=3, npoints=corners)
        return felupe.FieldContainer([felupe.Field(region, dim=3)])

    whole, elements = field_on(problem["elements"]), problem["elements"]
    parts = [field_on(elements[problem["regions"] == number]) for number in range(2)]
    return whole, [felupe.SolidBody(energy, part) for energy, part in zip(energies(problem, form), parts, strict=True)]


def solve(problem, form):
    """Seconds and iterations of every step, and the reactions (n, 3) in N at the top after the last."""
    begin = time.perf_counter()
    whole, items = bodies(problem, form)
    number = len(problem["nodes"])
    masks = {name: np.isin(np.arange(number), problem[name]) for name in ("bottom", "top")}
    boundaries = {
        "bottom": felupe.Boundary(whole[0], mask=masks["bottom"]),
        "sides": felupe.Boundary(whole[0], mask=masks["top"], skip=(0, 0, 1)),
        "down": felupe.Boundary(whole[0], mask=masks["top"], skip=(1, 1, 0)),
    }
    dof0, dof1 = felupe.dof.partition(whole, boundaries)
    setup, seconds, iterations, field = time.perf_counter() - begin, [], [], whole
    used = time.process_time()
    for level in problem["levels"]:
        begin = time.perf_counter()
        boundaries["down"].update(float(level) / MILLIMETRE)
        solution = felupe.newtonraphson(
            x0=field,
            items=items,
            dof0=dof0,
            dof1=dof1,
            ext0=felupe.dof.apply(whole, boundaries, dof0),
            solver=pypardiso.spsolve,
            tol=float(problem["tolerance"]),
            kwargs={"parallel": True},
            verbose=0,
        )
        field = solution.x
        seconds.append(time.perf_counter() - begin)
        iterations.append(solution.iterations)
    used = time.process_time() - used
    forces = solution.fun[: 3 * number].reshape(-1, 3)[problem["top"]]
    return {
        "setup_seconds": setup,
        "step_seconds": seconds,
        "processor_seconds": used,
        "iterations": iterations,
        "factorisations": sum(iterations),
        "solutions": sum(iterations),
        "unknowns": len(dof0) + len(dof1),
        "forces": forces,
        "version": version("felupe"),
    }


def main():
    """Solve the small problem untimed, then the other."""
    form, warm_up, path, result = sys.argv[1:]
    for name in (warm_up, path):
        with np.load(name) as stored:
            solution = solve(dict(stored), form)
    solution["peak_megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    np.savez(result, **solution)


if __name__ == "__main__":
    main()
