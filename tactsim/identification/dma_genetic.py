"""Constants of the generalized Kelvin model by a genetic algorithm, as in thesis section 4.5."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity, UnknownName
from tactsim.identification.dma_data import DmaData
from tactsim.identification.dma_least_squares import DmaFit
from tactsim.identification.dma_objective import FORMS, KelvinConstants, objective
from tactsim.outside.extras import extras_named

SOFTEST, STIFFEST = 1e-2, 1e4
"""Assumption: moduli from 1e-2 to 1e4 of the smallest dynamic modulus; the thesis prints no bounds."""
SHORTEST, LONGEST = 1e-2, 1e3
"""Assumption: times from 1e-2 / omega_max to 1e3 / omega_min."""


@dataclass(frozen=True)
class GeneticSettings:
    """How long a genetic algorithm searches; the thesis prints none of these."""

    population: int = 100
    generations: int = 500
    seed: int = 1


def log_bounds(data: DmaData, units: int) -> tuple[Array, Array]:
    """Lower and upper bounds of the log constants, each of shape (2 units + 1,); the search is uniform between them."""
    modulus = float(1 / np.abs(data.compliance).max())
    omega = 2 * np.pi * data.frequencies
    lower = np.repeat([SOFTEST * modulus, SHORTEST / omega[-1]], [units + 1, units])
    upper = np.repeat([STIFFEST * modulus, LONGEST / omega[0]], [units + 1, units])
    return np.log(lower), np.log(upper)


def fit_genetic(data: DmaData, units: int = 8, *, form: str = "squared", settings: GeneticSettings | None = None) -> DmaFit:
    """Constants of ``units`` Kelvin units with the least ``objective`` that a genetic algorithm meets.

    Tournament selection, simulated binary crossover, polynomial mutation and survival of the fittest, with the parameters of
    pymoo, on the log constants between ``log_bounds``. It stops after the given generations: a longer search finds a lower
    objective, nothing shows that the lowest is reached.

    Raises
    ------
    InvalidQuantity
        If units, population or generations are too few.
    UnknownName
        If the form of the objective is none of ``FORMS``.
    ConvergenceError
        If no better constants were found than the best of the first generation.
    InputError
        If pymoo is not installed.

    Source: thesis section 4.5; Deb & Agrawal 1995 (crossover and mutation); Blank & Deb 2020, doi:10.1109/ACCESS.2020.2990567.
    """
    settings = settings or GeneticSettings()
    if form not in FORMS:
        raise UnknownName("form of the objective", form, FORMS)
    for name, value, least in (
        ("units", units, 1),
        ("population", settings.population, 4),
        ("generations", settings.generations, 2),
    ):
        if value < least:
            raise InvalidQuantity(f"{name} is {value}; allowed: at least {least}")
    best, history = _searched(data, units, form, settings)
    if not history[-1] < history[0]:
        raise ConvergenceError(f"genetic algorithm: no progress in {settings.generations} generations", history)
    return DmaFit(
        method="genetic",
        constants=KelvinConstants.from_logarithms(best),
        data=data,
        objective=float(objective(best, data)),
        evaluations=settings.population * settings.generations,
        history=history,
    )


def _searched(data: DmaData, units: int, form: str, settings: GeneticSettings) -> tuple[Array, tuple[float, ...]]:
    """Best log constants, and the best objective of each generation."""
    with extras_named():
        from pymoo.algorithms.soo.nonconvex.ga import GA
        from pymoo.core.callback import Callback
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize

    size = float(np.abs(data.compliance).max()) ** (2 if form == "squared" else 1)
    history: list[float] = []

    class Identification(Problem):
        def _evaluate(self, x: Array, out: dict[str, Array], *args: object, **kwargs: object) -> None:
            out["F"] = objective(x, data, form)[:, None] / size

    class Record(Callback):
        def notify(self, algorithm: GA) -> None:
            history.append(size * float(algorithm.opt[0].F[0]))

    lower, upper = log_bounds(data, units)
    minimum = minimize(
        Identification(n_var=2 * units + 1, n_obj=1, xl=lower, xu=upper),
        GA(pop_size=settings.population, eliminate_duplicates=True),
        ("n_gen", settings.generations),
        seed=settings.seed,
        callback=Record(),
    )
    return np.asarray(minimum.X), tuple(history)
