"""A grasp with friction by the iterative solver, ever finer: unknowns, systems, iterations of each, seconds, peak memory.

Planes mirror the grasp; it is solved whole nevertheless, for what is measured is the iteration.

python benchmarks/scale.py [--factor] [--scales 1 0.65 0.4] [--set KEY=VALUE ...]
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.case.loading import load_case
from tactsim.errors import Collapsed, ConvergenceError
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.path import grasp_path
from tactsim.fem.assembly.body import Body
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.solvers.block_preconditioner import BlockPreconditioned
from tactsim.fem.solvers.linear import IterativeSolver, LinearSystem
from tactsim.fem.solvers.pardiso import QuasiDefinitePardiso
from tactsim.fem.solvers.relay import Relay
from tactsim.fem.solvers.reused_factor import ReusedFactor
from tactsim.fem.solvers.solver_choice import analysed, factored, giving_way

CASE = Path(__file__).parents[1] / "cases" / "grasp_lump_icf.yaml"
CELLS = {"size": 4.0, "inclusion_size": 2.0, "edge_size": 1.6}
"""Sizes in mm that are multiplied by the scale; those of the shipped case until it was solved by a part."""
GROWTH, LEAST_GROWTH = 0.6, 0.15
SCALES = (1.0, 0.65, 0.4)
"""33 334, 93 660 and 381 170 unknowns. With one layer of cells around the lump, as in the table of docs/theory/fem.md, they were
28 506, 82 832 and 321 114."""
REPORTED = (0.65, 0.4, 0.295)
"""Of the report, which takes some ten minutes: the last gives a million unknowns."""
MOST_ITERATIONS, MOST_MEMORY, LONGEST, EXPONENT = 60, 24.0, 3600.0, 1.2
"""What is asked: iterations of a system, memory in GB, seconds of the largest, and growth of the time with the unknowns."""


class Counting(IterativeSolver):
    """A solver which notes the iterations, the accuracy and the processor time of every solution."""

    name = "counting"

    def __init__(self, body: Body, *, factor: bool = False):
        if factor:
            guide = QuasiDefinitePardiso(giving_way(body))
            self._solver = factored(guide, analysed(guide, body))
        else:
            self._solver = Relay(BlockPreconditioned(body))
        self._begin = 0.0
        self.iterations: list[int] = []
        self.accuracies: list[float] = []
        self.seconds: list[float] = []

    @property
    def finest_step(self) -> float:  # type: ignore[override]  # of the class elsewhere
        """Of the solver that is counted."""
        return self._solver.finest_step

    def factor(self, system: LinearSystem) -> None:
        """Make the preconditioner."""
        self._begin = time.process_time()
        self._solver.factor(system)

    def solve(self, right: Array, accuracy: float = 0.0) -> Array:
        """Solution for one right-hand side (n,)."""
        before = self._count() if isinstance(self._solver.current, ReusedFactor) else 0
        try:
            return self._solver.solve(right, accuracy)
        finally:
            self.iterations.append(self._count() - before)
            self.accuracies.append(accuracy)
            self.seconds.append(time.process_time() - self._begin)
            sys.stderr.write(f"{len(right)} unknowns, {accuracy:.0e}: {self.iterations[-1]} in {self.seconds[-1]:.1f} s\n")

    def close(self) -> None:
        """Release the preconditioner."""
        self._solver.close()

    def _count(self) -> int:
        """Steps of the last solution by iteration, or of all solutions with a factor."""
        current = self._solver.current
        return current.solutions if isinstance(current, ReusedFactor) else current.iterations


def child(scale: float, settings: Sequence[str], *, factor: bool = False) -> dict[str, float]:
    """Figures of one grasp in one step of time, in this process; memory in GiB."""
    sizes = ", ".join(f"{name}: {value * scale:g} mm" for name, value in CELLS.items())
    mesh = f"experiment.mesh={{kind: graded, {sizes}, growth: {max(GROWTH * scale, LEAST_GROWTH):g}}}"
    experiment = load_case(CASE, [mesh, "experiment.time.steps=1", *settings]).experiment
    begin, begin_processor = time.perf_counter(), time.process_time()
    model = grasp_model(experiment, grasp_mesh(experiment))
    solver = Counting(model.body, factor=factor)
    model.problem = Problem(model.body, np.zeros(0, int), solver=solver, options=model.problem.options)
    figures = {"scale": scale, "unknowns": float(model.space.size), "finished": 1.0}
    try:
        for _ in grasp_path(experiment, model).states():
            pass
    except (ConvergenceError, Collapsed) as error:
        sys.stderr.write(f"{error}\n")
        figures["finished"] = 0.0
    return figures | {
        "systems": float(len(solver.iterations)),
        "mean_iterations": float(np.mean(solver.iterations)),
        "most_iterations": float(max(solver.iterations)),
        "finest_accuracy": min(solver.accuracies),
        "seconds": time.perf_counter() - begin,
        "processor_seconds": time.process_time() - begin_processor,
        "linear_seconds": sum(solver.seconds),
        "memory_gibibytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    }


def measure(
    scales: Sequence[float] = REPORTED, settings: Sequence[str] = (), *, factor: bool = False
) -> dict[str, float | dict[str, float]]:
    """Figures of every size by its scale, and the exponent of the processor time of one system over the unknowns."""
    runs = {}
    for scale in scales:
        command = [sys.executable, __file__, "--child", str(scale), *(["--factor"] if factor else []), "--set", *settings]
        runs[f"{scale:g}"] = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)
    return runs | exponents(list(runs.values()))


def exponents(runs: Sequence[dict[str, float]]) -> dict[str, float]:
    """Slopes of the time of a grasp and of one of its systems over the unknowns, fitted in logarithms; none for one size."""
    if len(runs) < 2:
        return {}
    unknowns = np.log([run["unknowns"] for run in runs])
    seconds = np.log([run["processor_seconds"] for run in runs])
    each = seconds - np.log([run["systems"] for run in runs])
    return {
        "exponent": float(np.polyfit(unknowns, seconds, 1)[0]),
        "exponent_of_a_system": float(np.polyfit(unknowns, each, 1)[0]),
    }


def rows(figures: dict[str, float | dict[str, float]]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured."""
    runs = [run for run in figures.values() if isinstance(run, dict)]
    largest = max(runs, key=lambda run: run["unknowns"])
    made = [_row(run, limit=LONGEST if run is largest else None) for run in runs]
    if "exponent" in figures:
        exponents = f"{figures['exponent']:.2f}, of a system {figures['exponent_of_a_system']:.2f}"
        made.append(("growth of its processor time, as a power of the unknowns", f"{EXPONENT:g}", exponents))
    return made


def _row(run: dict[str, float], limit: float | None) -> tuple[str, str, str]:
    """One size; ``limit`` are the seconds asked for, if any are."""
    unknowns = f"{run['unknowns']:,.0f}".replace(",", " ")
    what = f"`{CASE.name}` by iteration in one step, {unknowns} unknowns"
    asked = f"{MOST_ITERATIONS} iterations a system, {MOST_MEMORY:g} GB" + (f", {limit:g} s" if limit else "")
    ended = "" if run["finished"] else "not solved: "
    counts = (
        f"at most {run['most_iterations']:.0f} iterations, mean {run['mean_iterations']:.0f}, in {run['systems']:.0f} systems"
    )
    memory = 2**30 / 1e9 * run["memory_gibibytes"]
    return (
        what,
        asked,
        f"{ended}{counts}; {memory:.1f} GB; {run['seconds']:.0f} s, {run['processor_seconds']:.0f} s of processors",
    )


def main() -> None:
    """Measure one size in this process, or all in children."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scales", type=float, nargs="+", default=SCALES)
    parser.add_argument("--set", nargs="*", default=(), help="changes of the case")
    parser.add_argument("--factor", action="store_true", help="by a factor that is reused instead")
    parser.add_argument("--child", type=float)
    arguments = parser.parse_args()
    chosen, sizes = (child, arguments.child) if arguments.child else (measure, arguments.scales)
    figures = chosen(sizes, arguments.set, factor=arguments.factor)
    sys.stdout.write(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    main()
