"""What a row of a thesis table computes, and what a figure of a table shows: the two extension points of the validation."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from tactsim.errors import UnknownName
from tactsim.interfaces import CaseKind
from tactsim.validation.study import RunOutcome


@dataclass(frozen=True)
class Inputs:
    """What evaluators and drawings receive beside their own arguments."""

    folder: Path = Path()
    """Where the table stands; the paths in it are relative to it."""
    studies: Mapping[str, tuple[RunOutcome, ...]] = field(default_factory=dict)
    """Outcomes of the table's studies by name."""
    expected: float | None = None
    """The number of the row in SI, None if the thesis prints none."""

    def study(self, name: str) -> tuple[RunOutcome, ...]:
        """The outcomes of a study.

        Raises
        ------
        UnknownName
            If the table has no such study.
        """
        if name not in self.studies:
            raise UnknownName("study", name, self.studies)
        return self.studies[name]

    def run(self, study: str, identifier: str) -> RunOutcome:
        """The outcome of one run of a study.

        Raises
        ------
        UnknownName
            If the study has no such run.
        """
        outcomes = {outcome.id: outcome for outcome in self.study(study)}
        if identifier not in outcomes:
            raise UnknownName(f"run of the study {study}", identifier, outcomes)
        return outcomes[identifier]


class Evaluator(CaseKind):
    """Computes the number that a row compares; its fields are the arguments in the table."""

    package: ClassVar[str] = "tactsim.validation.evaluators"
    unit: ClassVar[str] = "1"
    """SI unit of the number."""

    @property
    def found_unit(self) -> str:
        """SI unit of the number, where it depends on the arguments."""
        return self.unit

    @abstractmethod
    def found(self, inputs: Inputs) -> float:
        """The number in SI.

        Raises
        ------
        TactsimError
            If it cannot be computed; the row then has left its state.
        """


class Drawing(CaseKind):
    """Gathers the plain data of a figure of a table."""

    package: ClassVar[str] = "tactsim.validation.drawings"

    @abstractmethod
    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Plain values with a ``form`` (``curves`` or ``ranges``) that says how they are drawn."""
