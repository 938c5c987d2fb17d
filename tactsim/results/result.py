"""The result of an experiment as plain values, independent of how it was computed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TypeVar

import numpy as np

from tactsim.errors import INTERRUPTED, ConvergenceError, InputError, StorageError, shown
from tactsim.results.scene import Scene, UnreadableScene

AnyScene = TypeVar("AnyScene", bound=Scene)


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

    @property
    def array(self) -> np.ndarray:
        """The value as an array of floats, NaN where it has none."""
        return np.asarray(self.value, dtype=float)


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
    """What a run computed.

    Attributes
    ----------
    kind : that of the experiment
    units : unit of every history value
    title : that of the case, empty without one
    scene : what later stages read beside quantities and history; see `scene_as`
    """

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
    title: str = ""
    scene: Scene | UnreadableScene | None = None

    def history(self, name: str) -> np.ndarray:
        """A history value at every accepted step, shape (steps,) in SI, NaN where a step has none."""
        return np.array([step.values.get(name, np.nan) for step in self.steps], dtype=float)

    def scene_as(self, model: type[AnyScene]) -> AnyScene:
        """The scene as a kind of scene.

        Raises
        ------
        StorageError
            If the stored scene cannot be read.
        InputError
            If the result has no scene, or another one.
        """
        if isinstance(self.scene, model):
            return self.scene
        if isinstance(self.scene, UnreadableScene):
            raise StorageError(f"the scene of the result cannot be read: {self.scene.reason}; run the case again")
        raise InputError(f"the result of {shown(self.kind)} holds no {model.__name__}")
