"""What the numbers and figures of a thesis table receive beside their own arguments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import Field

from tactsim.errors import InputError, UnknownName
from tactsim.validation.study import RunOutcome

StudyName = Annotated[str, Field(description="Study of the table.")]
RunName = Annotated[str, Field(description="Run of the study.")]


@dataclass(frozen=True)
class Inputs:
    """Where a table stands and the outcomes of its studies; never what a row expects."""

    folder: Path = Path()
    """Where the table stands; the paths in it are relative to it."""
    studies: Mapping[str, tuple[RunOutcome, ...]] = field(default_factory=dict)
    """Outcomes of the table's studies by name."""

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
            If the table has no such study, or the study no such run.
        """
        outcomes = {outcome.id: outcome for outcome in self.study(study)}
        if identifier not in outcomes:
            raise UnknownName(f"run of the study {study}", identifier, outcomes)
        return outcomes[identifier]

    def converged(self, study: str, identifier: str) -> RunOutcome:
        """The outcome of one run of a study, which must have converged.

        Raises
        ------
        UnknownName
            If the table has no such study, or the study no such run.
        InputError
            If the run did not converge.
        """
        outcome = self.run(study, identifier)
        if not outcome.converged:
            raise InputError(f"{study}, {identifier} did not converge: {outcome.reason}")
        return outcome
