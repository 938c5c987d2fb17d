"""What of a result a data set stores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.errors import shown
from tactsim.model import FrozenModel
from tactsim.units import is_unit

Values = dict[str, Array]
"""Values of variables by name."""


@dataclass(frozen=True)
class ComputedSteps:
    """How far apart the computed moments of a history may lie while a prescribed value changes: what is stored in between lies on
    straight lines."""

    longest: float
    """Longest step, in SI units of what grows."""
    end: float
    """Where the history ends, or the furthest that it may come to, in the same unit."""
    unit: str
    """SI unit of both."""
    shorter: str
    """The setting that makes as many steps as there are stored times, as a case file has it."""


class ForceReader(FrozenModel, ABC):
    """A sensor under the force of a history."""

    @abstractmethod
    def read(self, time: Array, force: Array, at: Array, generator: np.random.Generator) -> Values:
        """Readings at times ``at`` in s of forces (n,) in N at times (n,) in s."""


class Recording(FrozenModel):
    """How much of a result is stored."""

    times: Annotated[int, Field(ge=1, le=100_000)] = 1
    """Stored moments of a history, evenly spaced up to its end: in time, or of an indentation without time in its displacement; 1
    stores the end."""
    quantities: dict[str, str] | None = None
    """Name of a number of the result -> unit in which it is stored, any of its dimension, such as mN; by default the numbers that
    the kind of experiment declares."""
    reading: ForceReader | None = None
    """Sensor through which a stored force is read as well; null reads none."""

    @model_validator(mode="after")
    def _known_units(self) -> Self:
        for name, unit in (self.quantities or {}).items():
            if not is_unit(unit) or not unit:
                expected = "expected one such as 'mN', or '1' of a plain number"
                raise ValueError(f"quantities.{name}: {shown(unit)} is no known unit; {expected}")
        return self

    def stored_times(self, end: float) -> Array:
        """The stored times (times,) in s of a history that ends at ``end``, or what else grows, in its unit."""
        return np.arange(1, self.times + 1) * end / self.times
