"""A published benchmark that nobody here made: a compressible neo-Hookean plate pulled to ten times its thickness.

python benchmarks/stretch.py [--cells 32 52]

The problem is `hyperelasticity` of torch-fem's benchmarks (github.com/meyer-nils/torch-fem, ``benchmarks/hyperelasticity.py``):
E = 1000, nu = 0.3, faces pulled apart, middle planes held, eleven stretches in a geometric row from 1 to 10. There five layers of
nodes of trilinear hexahedra in displacements; here as many in quadratic tetrahedra with a linear pressure. The energy there is
mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2, here c10 (I1bar - 3) + K/2 (J - 1)^2 with the same mu and K, whose loops are compiled.
The state is homogeneous and its force known: the closed form is compared with. The problem shows how fast large deformations are
solved, and nothing of the error of cells.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from typing import Any

import history
import numpy as np
from scipy.optimize import brentq

from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.solvers.solver_choice import solver_for
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.structured_block import structured_block

Array = np.ndarray

YOUNG, POISSON = 1000.0, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))
BULK = YOUNG / (3 * (1 - 2 * POISSON))
LEVELS = np.geomspace(1.0, 10.0, 11)
LAYERS = 2
"""Quadratic cells through the plate: five layers of nodes, as four trilinear ones have."""
CELLS = (32, 52)
"""Along each side: 63 375 and 165 375 displacement unknowns."""
TOLERANCE = 1e-8
PUBLISHED = {
    63_375: (77.9, "torch-fem, i7-13700K, eight fast cores"),
    165_375: (39.6, "torch-fem, RTX 5090"),
}
"""Seconds of the forward solution that torch-fem's ``benchmarks/results`` give, by displacement unknowns, and where."""


def exact_force(stretch: float) -> float:
    """Force in N on a face of 1 m^2: uniaxial tension of the energy above, the sides free."""

    def sides(across: float) -> float:
        return _stress(stretch, across)[1]

    across = brentq(sides, 1e-3, 1.0) if stretch > 1 else 1.0
    return _stress(stretch, across)[0]


def _stress(along: float, across: float) -> tuple[float, float]:
    """Nominal stresses in Pa along and across, of stretches along and (twice) across."""
    J = along * across**2
    first = along**2 + 2 * across**2
    slope, pressure = SHEAR * J ** (-2 / 3), BULK * (J - 1)
    pulled, free = (slope * (stretch - first / (3 * stretch)) + pressure * J / stretch for stretch in (along, across))
    return pulled, free


def solve(cells: int) -> dict[str, float]:
    """Seconds, counts and the force of one size; compiled loops are warmed up before."""
    edge = 2.0 / cells
    block = structured_block((LAYERS * edge / 2, 1.0, 1.0), (LAYERS, cells, cells))
    nodes = block.mesh.nodes
    begin = time.perf_counter()
    space = TaylorHood(nodes, block.mesh.elements, "solid")
    body = Body(space, [NeoHookean(c10=SHEAR / 2, bulk_modulus=BULK)], block.mesh.regions)
    left, right = np.flatnonzero(nodes[:, 0] == 0), np.flatnonzero(nodes[:, 0] == nodes[:, 0].max())
    middle = [3 * np.flatnonzero(nodes[:, k] == 0.5) + k for k in (1, 2)]
    solver, fixed = solver_for(body), np.concatenate([3 * left, 3 * right, *middle])
    problem = Problem(body, fixed, solver=solver, options=NewtonOptions(tolerance=TOLERANCE))
    path, systems, force = [np.zeros(space.size)], 0, 0.0
    for count, level in enumerate(LEVELS[1:], 1):
        guess = _extrapolated(path, LEVELS[: count + 1])
        guess[3 * right] = (level - 1) * nodes[:, 0].max()
        if count == 1:
            guess[: 3 * len(nodes) : 3] = (level - 1) * nodes[:, 0]
        solved = problem.solve(guess)
        systems += solved.iterations
        path.append(solved.unknowns)
        reaction, _ = space.split(body.residual(solved.unknowns, solved.kinematics))
        force = float(reaction[right, 0].sum())
    seconds = time.perf_counter() - begin
    solver.close()
    exact = exact_force(float(LEVELS[-1]))
    return {
        "displacement_unknowns": 3 * len(nodes),
        "unknowns": space.size,
        "seconds": seconds,
        "systems": systems,
        "force_error": abs(force / exact - 1),
        "peak_megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


def _extrapolated(path: Sequence[Array], levels: Array) -> Array:
    """Unknowns at the last of the ``levels`` by the polynomial through the three states before it at most."""
    states, places = path[-3:], levels[-1 - len(path[-3:]) : -1]
    guess = np.zeros_like(states[0])
    for k, state in enumerate(states):
        others = np.delete(places, k)
        guess += state * np.prod((levels[-1] - others) / (places[k] - others))
    return guess


def measure(sizes: Sequence[int] = CELLS) -> dict[str, dict[str, Any]]:
    """Every size in a process of its own, so that its memory is its own; and the machine, as others' stands in their row."""
    program = "import json, sys, stretch; stretch.solve(4); print(json.dumps(stretch.solve(int(sys.argv[1]))))"
    done = {}
    for cells in sizes:
        command = [sys.executable, "-c", program, str(cells)]
        output = subprocess.run(command, check=True, stdout=subprocess.PIPE, cwd=__file__.rsplit("/", 1)[0]).stdout
        figures = json.loads(output)
        done[f"{figures['displacement_unknowns']}"] = figures | {"machine": history.machine()}
    return done


def rows(figures: dict[str, dict[str, Any]]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is published, what was measured."""
    made = []
    for size, taken in figures.items():
        seconds, where = PUBLISHED.get(int(size), (None, ""))
        made.append(
            (
                f"neo-Hookean plate pulled to ten times its thickness, {size} displacement unknowns",
                f"published: {seconds} s ({where})" if seconds else "-",
                f"{taken['seconds']:.1f} s ({taken['machine']}), {taken['systems']:.0f} systems, "
                f"force off by {taken['force_error']:.0e}",
            )
        )
    return made


def main() -> None:
    """Print figures as JSON and as a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, nargs="+", default=list(CELLS))
    figures = measure(parser.parse_args().cells)
    table = "\n".join(f"| {' | '.join(row)} |" for row in rows(figures))
    sys.stdout.write(f"{json.dumps(figures, indent=2)}\n\n{table}\n")


if __name__ == "__main__":
    main()
