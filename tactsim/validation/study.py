"""A list of simulations around one case, and what each of them computed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Self

from pydantic import Field, model_validator

from tactsim.errors import InputError
from tactsim.model import FrozenModel

Override = str | int | float | bool | dict[str, str | int | float | bool | dict[str, str]]


class StudyRun(FrozenModel):
    """One simulation of a study."""

    id: str = Field(min_length=1, max_length=80)
    """Name within the study, as the figure shows it."""
    set: dict[str, Override] = {}
    """Key path in the case -> value, as with ``tactsim run --set``."""


class Study(FrozenModel):
    """Simulations that differ from one case in what they set."""

    name: str = Field(min_length=1)
    """Name within the table."""
    case: str
    """Case file, relative to the table."""
    common: dict[str, Override] = {}
    """What every run sets."""
    runs: tuple[StudyRun, ...] = Field(min_length=1)
    """The simulations."""

    @model_validator(mode="after")
    def _named_once(self) -> Self:
        names = [run.id for run in self.runs]
        if len(set(names)) < len(names):
            raise ValueError(f"two runs of the study {self.name} have the same id")
        return self

    def overrides(self, run: StudyRun) -> tuple[str, ...]:
        """What a run sets, as ``path.to.key=value``."""
        return overrides({**self.common, **run.set})


class RunOutcome(FrozenModel):
    """What one simulation computed, in SI."""

    id: str
    """Name within the study."""
    case_id: str
    """Identity of the case."""
    status: str
    """``converged`` or ``failed``."""
    reason: str
    """How it ended."""
    quantities: dict[str, float]
    """Numbers of the result."""
    history: dict[str, tuple[float, ...]]
    """Values of the accepted steps."""
    disc_share: float = 1.0
    """Area of the annulus over that of the full disc of its outer radius."""
    seconds: float
    """Duration when it was computed."""

    @property
    def converged(self) -> bool:
        """Whether its numbers count."""
        return self.status == "converged"

    def value(self, quantity: str) -> float:
        """A quantity of the run in SI.

        Raises
        ------
        InputError
            If the run did not converge or has no such quantity.
        """
        if not self.converged or quantity not in self.quantities:
            raise InputError(f"the run {self.id} has no {quantity}: {self.reason}")
        return self.quantities[quantity]


def overrides(values: Mapping[str, Override]) -> tuple[str, ...]:
    """Key paths with their values as ``path.to.key=value``."""
    return tuple(f"{key}={value if isinstance(value, str) else json.dumps(value)}" for key, value in values.items())
