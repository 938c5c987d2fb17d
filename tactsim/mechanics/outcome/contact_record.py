"""What every run with contact records of its accepted states and says of them at its end."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.newton import Problem
from tactsim.interfaces.run import Findings
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.outcome.contact_quality import FINER, ContactQuality, displacement_reached
from tactsim.mechanics.outcome.success import judged
from tactsim.mechanics.paths.history_path import TimedState
from tactsim.results.quantity import Quantity
from tactsim.results.result import FieldFrame, Status, StepRecord
from tactsim.results.scene import Scene, SolverReport
from tactsim.units import format_quantity

UNPRINTED = "(from the case; the thesis prints none)"
"""Said of a size that the case chose, or its default, where the thesis leaves it open."""
ERROR_IN_TIME = "estimated error of the stress in time below {:g} of its size"
"""Assumption of a path in time, by its tolerance."""


class ContactModel(Protocol):
    """A body that touches rigid ones."""

    space: TaylorHood
    body: Body
    problem: Problem

    def frame(self, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None) -> FieldFrame:
        """Fields of a state for ParaView; ``time`` in s, ``isochoric`` (6, E, Q) in Pa as in `cauchy_stress`."""


class FollowedPath(Protocol):
    """A path through the states."""

    @property
    def rejected(self) -> int:
        """Steps that were taken back."""


Model = TypeVar("Model", bound=ContactModel)


@dataclass(frozen=True)
class KeptState(Generic[Model]):
    """A state whose fields are kept, and the model that it is of, which an adapted mesh replaces on the way."""

    model: Model
    state: TimedState


class ContactRecord(ABC, Generic[Model]):
    """Collects the accepted states of a run, and reports the findings.

    Parameters
    ----------
    model : on which the states are
    path : through them
    tolerance : largest penetration in m
    stiffest, finer, reached : as in `ContactQuality`
    """

    def __init__(
        self,
        model: Model,
        path: FollowedPath,
        *,
        tolerance: float,
        stiffest: float = math.inf,
        finer: str = FINER,
        reached: Callable[[StepRecord], str] = displacement_reached,
    ):
        self.model, self.path, self.tolerance = model, path, tolerance
        self.steps: list[StepRecord] = []
        self.event: StepRecord | None = None
        """The step at which what the run looks for happened; None if it did not."""
        self.quality = ContactQuality(stiffest, finer=finer, reached=reached)
        self._kept: dict[str, KeptState[Model]] = {}

    def accept(self, state: TimedState, *, event: bool = False) -> StepRecord:
        """Record an accepted state, and whether it is the event.

        Raises
        ------
        ConvergenceError
            If the state contradicts itself.
        """
        values = self.values(state)
        record = StepRecord(len(self.steps) + 1, state.iterations, state.contact.residual, values)
        self.steps.append(record)
        if event:
            self.event = record
        for name in self.kept_as(state, event):
            self._kept[name] = KeptState(self.model, state)
        return record

    @abstractmethod
    def values(self, state: TimedState) -> dict[str, float]:
        """History values of a state in SI."""

    @abstractmethod
    def kept_as(self, state: TimedState, event: bool) -> Sequence[str]:
        """Names under which the fields of a state are kept, each until another state takes it."""

    @property
    def _reported(self) -> list[StepRecord]:
        """The steps of which numbers are reported: the event and the last one."""
        return [step for step in (self.event, *self.steps[-1:]) if step is not None]

    def findings(self) -> Findings:
        """What everything that was accepted says; no success if a reported state is none."""
        status, reason = judged(*self.verdict(), self._reported, self.tolerance, self.model.problem.options.tolerance)
        return Findings(
            reason,
            self.steps,
            status=status,
            quantities=self.quantities() if self.steps else {},
            assumptions=self.assumptions(),
            warnings=self.warnings() if self.steps else (),
            frames=self._frames(),
            scene=self.scene(),
        )

    def unloaded(self, start: TimedState) -> Findings:
        """Frame and scene of the state that the path begins at; nothing is solved."""
        self._kept["last"] = KeptState(self.model, start)
        return Findings("at rest", assumptions=self.assumptions(), frames=self._frames(), scene=self.scene())

    @abstractmethod
    def verdict(self) -> tuple[Status, str]:
        """Status and reason of a path that came to its end."""

    @abstractmethod
    def assumptions(self) -> list[str]:
        """What the sources leave open and the case chooses, a sentence for each."""

    def quantities(self) -> dict[str, Quantity]:
        """Quantities of at least one step: those of every run with contact."""
        return self.quality.quantities(self.steps)

    def warnings(self) -> list[str]:
        """Warnings about at least one step."""
        return self.quality.warnings(self.steps)

    def _frames(self) -> list[FieldFrame]:
        """Fields of the kept states, by time, each state once."""
        kept = {id(one.state): one for one in self._kept.values()}.values()
        return [
            one.model.frame(one.state.contact, time=one.state.time, isochoric=one.state.isochoric)
            for one in sorted(kept, key=lambda one: one.state.time)
        ]

    def _latest(self) -> KeptState[Model]:
        """The latest of the kept states; there must be one."""
        return max(self._kept.values(), key=lambda one: one.state.time)

    @abstractmethod
    def scene(self) -> Scene:
        """What figures and other stages read beside the quantities."""


def penetration_allowed(tolerance: float) -> str:
    """How closely contact is kept, by the largest penetration in m."""
    return f"penetration below {format_quantity(tolerance, 'm')}, elastic slip below ten times that"


def solver_report(record: ContactRecord[Any], *, mesh_adaptations: int = 0) -> SolverReport:
    """What the solution took until now."""
    space = record.model.space
    return SolverReport(
        unknowns=space.size,
        elements=len(space.elements),
        linear_solver=record.model.problem.solver.name,
        rejected_steps=record.path.rejected,
        newton_iterations=sum(step.newton_iterations for step in record.steps),
        mesh_adaptations=mesh_adaptations,
    )
