"""What a sample cost: how long it took, on how large a mesh, and in how many steps and iterations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.variable import Variable
from tactsim.results.result import Result
from tactsim.results.scene import SolverReport

COST = {
    "unknowns": "unknowns of the finite element model at the end; 0 without one, or if the run never came to a state",
    "steps": "accepted steps of the run, or moments of its history",
    "rejected_steps": "steps that did not converge and were repeated with a smaller length",
    "newton_iterations": "Newton iterations, each a linear system, of all accepted steps",
}
"""Whole numbers that every sample has beside its time -> what they mean. Stores of earlier versions lack them."""
SLOWEST, WORTH_A_LINE = 3, 1.0
"""How many of the slowest samples are named, and the time in s that one of them must have taken."""


def cost_variables() -> list[Variable]:
    """The variables of `COST`."""
    return [Variable(name, "1", words, "index", dtype="int64") for name, words in COST.items()]


def cost_of(result: Result) -> dict[str, int]:
    """The values of `COST` of a run, also of one that failed."""
    report, quantity = getattr(result.scene, "solver", None), result.quantities.get("unknowns")
    unknowns, rejected = 0 if quantity is None else int(quantity.numbers), 0
    if isinstance(report, SolverReport):
        unknowns, rejected = report.unknowns, report.rejected_steps
    iterations = sum(step.newton_iterations for step in result.steps)
    return {"unknowns": unknowns, "steps": len(result.steps), "rejected_steps": rejected, "newton_iterations": iterations}


def slow_lines(costs: Mapping[str, Array]) -> list[str]:
    """The median and the slowest samples with their cost, a line each; nothing if all are quick, or their times are lost.

    ``costs`` are ``sample``, ``wall_time`` in s and those of `COST`, as far as they are known, (n,) each; a reading of such a
    name is none.
    """
    times = costs.get("wall_time", np.zeros(0))
    slowest = np.argsort(-times, kind="stable")[:SLOWEST]
    if not (times[slowest] > WORTH_A_LINE).any():
        return []
    known = [name for name in COST if name in costs and costs[name].dtype.kind == "i"]
    medians = {name: float(np.median(costs[name])) for name in known}
    middle = ", ".join([f"{np.median(times):.3g} s", *_words(medians)])
    lines = [f"a sample took {middle} in the median; the slowest:"]
    for row in slowest.tolist():
        words = [f"{times[row]:.3g} s", f"sample {costs['sample'][row]}", *_words({name: costs[name][row] for name in known})]
        lines.append(f"  {', '.join(words)}")
    return lines


def _words(counts: Mapping[str, float]) -> list[str]:
    """Those of the counts that are not 0, in words."""
    nouns = {name: name.replace("_", " ").replace("newton", "Newton") for name in counts}
    return [f"{count:.0f} {nouns[name].removesuffix('s' if count == 1 else '')}" for name, count in counts.items() if count]
