"""What the taxels of a simulated grasp read: the steps of its history as arrays."""

from __future__ import annotations

import re
from typing import Literal, get_args

import numpy as np

from tactsim.errors import InputError
from tactsim.units import format_quantity
from tactsim.validation.evaluator import Inputs
from tactsim.validation.study import RunOutcome

Array = np.ndarray
Side = Literal["upper", "lower"]
SIDES: tuple[Side, ...] = get_args(Side)
SAME_CLOSING = 1e-9
"""Largest relative difference of a closing from the one asked for: round-off."""


def grasp(inputs: Inputs, run: tuple[str, str]) -> RunOutcome:
    """The outcome of a study's run.

    Raises
    ------
    InputError
        If it did not converge.
    """
    outcome = inputs.run(*run)
    if not outcome.converged:
        raise InputError(f"{', '.join(run)} did not converge: {outcome.reason}")
    return outcome


def taxel_history(outcome: RunOutcome, side: Side) -> Array:
    """Forces (steps, rows, columns) in N that press on the taxels of a jaw.

    Raises
    ------
    InputError
        If the run has no taxels.
    """
    name = re.compile(rf"taxel_force_{side}_(\d+)_(\d+)")
    found = {(int(m[1]), int(m[2])): values for key, values in outcome.history.items() if (m := name.fullmatch(key))}
    if not found:
        raise InputError(f"{outcome.id} has no taxels of the {side} jaw")
    rows, columns = (max(place[k] for place in found) for k in range(2))
    return np.array([[found[row, column] for column in range(1, columns + 1)] for row in range(1, rows + 1)]).transpose(2, 0, 1)


def taxels_at(inputs: Inputs, run: tuple[str, str], side: Side, closing: float | None = None) -> Array:
    """Forces (rows, columns) in N on the taxels of a jaw at the end of a run, or at a closing in m that a step ended with.

    Raises
    ------
    InputError
        If no step ended there.
    """
    outcome = grasp(inputs, run)
    forces = taxel_history(outcome, side)
    if closing is None:
        return forces[-1]
    away = np.abs(np.array(outcome.history["displacement"]) - closing)
    if away.min() > SAME_CLOSING * closing:
        raise InputError(f"no step of {', '.join(run)} ended at a closing of {format_quantity(closing, 'm')}")
    return forces[int(away.argmin())]


def taxel(forces: Array, place: tuple[int, int]) -> float:
    """The force in N on the taxel in a row and a column, both counted from 1.

    Raises
    ------
    InputError
        If the matrix has no such taxel.
    """
    row, column = place
    if not (1 <= row <= forces.shape[0] and 1 <= column <= forces.shape[1]):
        raise InputError(f"taxel {row}, {column} of a matrix of {forces.shape[0]} rows and {forces.shape[1]} columns")
    return float(forces[row - 1, column - 1])
