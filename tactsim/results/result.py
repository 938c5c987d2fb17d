"""The result of an experiment as plain values, independent of how it was computed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from tactsim.errors import INTERRUPTED, ConvergenceError


class Status(StrEnum):
    """How a run ended; exit code, banner and data-set index derive from it."""

    CONVERGED = "converged"
    FAILED = "failed"
    INTERRUPTED = "interrupted"

    @property
    def exit_code(self) -> int:
        """Exit code of the command line."""
        return {"converged": 0, "failed": ConvergenceError.exit_code, "interrupted": INTERRUPTED}[self.value]


@dataclass(frozen=True)
class Quantity:
    """A number or array in SI with its unit."""

    value: Any
    unit: str
    description: str


@dataclass(frozen=True)
class StepRecord:
    """One accepted step: its number, what it took, and the history values (name -> SI float) that it committed."""

    step: int
    newton_iterations: int
    residual: float
    values: dict[str, float]


def rows(units: Iterable[str], columns: Iterable[Iterable[float]]) -> tuple[StepRecord, ...]:
    """The history of what is computed without load steps: a record for each row of ``columns``, named as ``units`` are."""
    return tuple(
        StepRecord(number, 0, 0.0, dict(zip(units, map(float, values), strict=True)))
        for number, values in enumerate(zip(*columns, strict=True), 1)
    )


@dataclass(frozen=True)
class FieldFrame:
    """Fields at one accepted step, as meshio writes them.

    ``points`` (n, 3) in m, ``cells`` name -> connectivity, ``point_data`` and ``cell_data`` name -> array (unit in the name).
    """

    time: float
    points: np.ndarray
    cells: dict[str, np.ndarray]
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """What a run found; ``units`` gives the unit of every history value, ``kind`` the experiment's kind."""

    kind: str
    status: Status
    reason: str
    quantities: dict[str, Quantity] = field(default_factory=dict)
    assumptions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    timing: dict[str, float] = field(default_factory=dict)
    steps: tuple[StepRecord, ...] = ()
    units: dict[str, str] = field(default_factory=dict)
    frames: tuple[FieldFrame, ...] = ()
    details: dict[str, Any] = field(default_factory=dict)
