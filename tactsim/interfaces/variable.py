"""A variable of a data set: its name, dimensions, unit and meaning."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from tactsim.array import Array

Role = Literal["index", "varied", "label", "reading"]


@dataclass(frozen=True)
class Variable:
    """``sizes`` are those of ``dimensions``, which stand behind the dimension sample."""

    name: str
    unit: str
    description: str
    role: Role
    dimensions: tuple[str, ...] = ()
    sizes: tuple[int, ...] = ()
    dtype: str = "float64"
    meanings: tuple[str, ...] = ()
    """What the whole numbers 0, 1, ... stand for."""
    optional: bool = False
    """Whether a sample that is done may lack it: NaN then says that there is none, such as a threshold that is not reached."""

    prescribed: bool = False
    """Whether the case prescribes it, so that it may well be constant."""

    @property
    def fill(self) -> float | int | str:
        """What stands for a sample without a value."""
        return "" if self.dtype == "str" else math.nan if self.dtype.startswith("f") else 0

    def attributes(self) -> dict[str, Any]:
        """Attributes in the words of the CF conventions."""
        attributes: dict[str, Any] = {"units": self.unit, "long_name": self.description, "role": self.role}
        if self.meanings:
            attributes |= {"flag_values": list(range(len(self.meanings))), "flag_meanings": " ".join(self.meanings)}
        return attributes

    def empty(self, samples: int) -> Array:
        """Values (samples, ...) of samples that have none."""
        return np.full((samples, *self.sizes), self.fill, dtype="U1" if self.dtype == "str" else self.dtype)


def reading(
    name: str, unit: str, description: str, *, optional: bool = False, prescribed: bool = False, **sizes: int
) -> Variable:
    """A reading with these dimensions."""
    shape = (tuple(sizes), tuple(sizes.values()))
    return Variable(name, unit, description, "reading", *shape, optional=optional, prescribed=prescribed)


def label(name: str, unit: str, description: str, **sizes: int) -> Variable:
    """A label with these dimensions."""
    return Variable(name, unit, description, "label", tuple(sizes), tuple(sizes.values()))
