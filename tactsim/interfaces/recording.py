"""What of a result a data set stores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.model import FrozenModel

Values = dict[str, Array]
"""Values of variables by name."""


class ForceReader(FrozenModel, ABC):
    """A sensor under the force of a history."""

    @abstractmethod
    def read(self, time: Array, force: Array, at: Array, generator: np.random.Generator) -> Values:
        """Readings at times ``at`` in s of forces (n,) in N at times (n,) in s."""


class Recording(FrozenModel):
    """How much of a result is stored."""

    times: Annotated[int, Field(ge=1, le=100_000)] = 1
    """Stored times of a history, evenly spaced up to its end; 1 stores the end."""
    quantities: dict[str, str] | None = None
    """Name -> unit of the numbers of a result that are stored; by default those that the kind of experiment declares."""
    reading: ForceReader | None = None
    """Sensor through which a stored force is read as well; null reads none."""

    def stored_times(self, end: float) -> Array:
        """The stored times (times,) in s of a history that ends at ``end``."""
        return np.arange(1, self.times + 1) * end / self.times
