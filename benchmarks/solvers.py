"""Factor against iteration on the first tangent of a grasp: seconds, peak memory and the size at which the iteration wins.

python benchmarks/solvers.py [--large]
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time

import numpy as np
from skfem import MeshTet

from tactsim.contact.coulomb import Coulomb
from tactsim.contact.jaw import Jaw
from tactsim.contact.penalty import Regularisation
from tactsim.errors import ConvergenceError
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.solvers.block_preconditioner import BlockPreconditioned
from tactsim.fem.solvers.linear import IterativeSolver, LinearSystem, resolved
from tactsim.fem.solvers.pardiso import SinglePardiso
from tactsim.fem.solvers.reused_factor import ReusedFactor
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh

SIZE = np.array([0.04, 0.04, 0.02])
CENTRE, RADIUS = np.array([0.02, 0.02, 0.012]), 5e-3
CLOSING = 2.5e-4
ACCURACY = 1e-4
SMALL, LARGE = (8, 14), (8, 14, 20, 24, 28)
"""Cells along the long sides: 8 208, 39 645, 110 754, 188 200 and 295 320 unknowns."""
KINDS = ("direct", "iterative")
LONGEST = 500.0
"""Seconds after which a child is given up."""


class Recorded(Exception):
    """Carries the first linear system of Newton's method out of the model."""

    def __init__(self, system: LinearSystem, right: np.ndarray):
        super().__init__("first system")
        self.system, self.right = system, right


class Recorder(IterativeSolver):
    """A solver that solves nothing."""

    name = "recorder"

    def factor(self, system: LinearSystem) -> None:
        """Keep the system."""
        self._system = system

    def solve(self, right: np.ndarray, accuracy: float = 0.0) -> np.ndarray:
        """Hand the system out."""
        raise Recorded(self._system, right)

    def close(self) -> None:
        """Drop the system."""
        del self._system


def first_system(cells: int):  # type: ignore[no-untyped-def]
    """Body, first system and right-hand side: a hard ball in a block, friction, closed by 0.25 mm."""
    lines = [np.linspace(0, length, count + 1) for length, count in zip(SIZE, (cells, cells, cells // 2), strict=True)]
    tetrahedra = MeshTet.init_tensor(*lines)
    mesh = quadratic_mesh(tetrahedra.p.T, tetrahedra.t.T)
    middles = mesh.nodes[mesh.elements[:, :4]].mean(axis=1)
    mesh = QuadraticMesh(mesh.nodes, mesh.elements, (np.linalg.norm(middles - CENTRE, axis=1) < RADIUS).astype(int))
    facets, _ = mesh.boundary_facets()
    heights = mesh.nodes[facets, 2]
    faces = {"upper": facets[np.isclose(heights, SIZE[2]).all(axis=1)], "lower": facets[np.isclose(heights, 0.0).all(axis=1)]}
    soft, hard = MooneyRivlin2(c10=1000.0, c01=685.0), MooneyRivlin2(c10=8000.0, c01=2000.0)
    jaws = [Jaw(side=side, width=0.03, depth=0.03, fillet=1e-3) for side in faces]
    model = GraspModel(mesh, [soft, hard], faces, jaws=jaws, offsets=np.tile(SIZE[:2] / 2, (2, 1)))
    model.problem = Problem(model.body, np.zeros(0, int), solver=Recorder(), options=model.problem.options)
    state = model.start(Coulomb(friction=0.6), Regularisation(1e-6, soft.shear_modulus, switch_length=1e-3))
    try:
        model.equilibrium(state, CLOSING, state.unknowns)
    except Recorded as recorded:
        return model.body, recorded.system, recorded.right
    raise AssertionError("Newton solved nothing")


def child(kind: str, cells: int) -> dict[str, float]:
    """Figures of one solver at one size; the memory is that of the whole process in GiB.

    The direct one factors in the solve, and iterates for the skew part that friction makes.
    """
    body, system, right = first_system(cells)
    solver = ReusedFactor(SinglePardiso()) if kind == "direct" else BlockPreconditioned(body)
    begin = time.perf_counter()
    solver.factor(system)
    ready = time.perf_counter()
    figures = {"unknowns": float(len(right)), "setup_seconds": ready - begin}
    try:
        resolved(solver, system.matrix, right, ACCURACY)
        figures["solved"] = 1.0
    except ConvergenceError:
        figures["solved"] = 0.0
    figures["solve_seconds"] = time.perf_counter() - ready
    figures["iterations"] = float(solver.solutions if kind == "direct" else solver.iterations)
    figures["memory_gibibytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return figures


def measure(sizes: tuple[int, ...] = SMALL) -> dict[str, float]:
    """Figures by solver and cells, and the unknowns at the crossing, if the measured sizes enclose it."""
    figures: dict[str, float] = {}
    seconds: dict[str, list[float]] = {kind: [] for kind in KINDS}
    unknowns = []
    for cells in sizes:
        for kind in KINDS:
            run = [sys.executable, __file__, "--child", kind, "--cells", str(cells)]
            done = subprocess.run(run, check=True, capture_output=True, text=True, timeout=LONGEST)
            measured = json.loads(done.stdout)
            figures |= {f"{kind}_{cells}_{name}": value for name, value in measured.items()}
            seconds[kind].append(measured["setup_seconds"] + measured["solve_seconds"] if measured["solved"] else np.inf)
        unknowns.append(measured["unknowns"])
    crossing = crossing_point(unknowns, seconds["direct"], seconds["iterative"])
    return figures if crossing is None else figures | {"crossing_unknowns": crossing}


def crossing_point(unknowns: list[float], direct: list[float], iterative: list[float]) -> float | None:
    """Unknowns at which the iteration begins to be faster, by logarithms between two sizes; none if it never does."""
    ratio = np.log(iterative) - np.log(direct)
    for k in range(1, len(ratio)):
        if ratio[k] <= 0 < ratio[k - 1] and np.isfinite(ratio[k - 1]):
            share = ratio[k - 1] / (ratio[k - 1] - ratio[k])
            return float(unknowns[k - 1] * (unknowns[k] / unknowns[k - 1]) ** share)
    return None


def main() -> None:
    """Measure one size in this process, or all in children."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="up to 300 000 unknowns")
    parser.add_argument("--child", choices=KINDS)
    parser.add_argument("--cells", type=int)
    arguments = parser.parse_args()
    measured = child(arguments.child, arguments.cells) if arguments.child else measure(LARGE if arguments.large else SMALL)
    sys.stdout.write(json.dumps(measured, indent=2) + "\n")


if __name__ == "__main__":
    main()
