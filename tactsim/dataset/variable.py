"""A variable of the store: its name, dimensions, unit and meaning."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

Array = np.ndarray
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
        told: dict[str, Any] = {"units": self.unit, "long_name": self.description, "role": self.role}
        if self.meanings:
            told |= {"flag_values": list(range(len(self.meanings))), "flag_meanings": " ".join(self.meanings)}
        return told

    def empty(self, samples: int) -> Array:
        """Values of samples that have none."""
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


MOST_SAMPLES = 10_000_000
"""Samples of a data set: a month of a thousand processes at a sample in four minutes, or a day of the closed form."""
STATUS = ("pending", "done", "failed")
PENDING, DONE, FAILED = range(3)
CHECKSUM_BYTES = 32


def index_variables(splits: tuple[str, ...]) -> list[Variable]:
    """What every store has, whatever the experiment."""
    return [
        Variable("status", "1", "whether the sample was computed", "index", dtype="uint8", meanings=STATUS),
        Variable("reason", "1", "how the computation ended", "index", dtype="str"),
        Variable("specimen", "1", "number of the specimen, which samples may share", "index", dtype="int64"),
        Variable("split", "1", "part of the data set, by specimen", "index", dtype="uint8", meanings=splits),
        Variable("seed", "1", "seed of the noise of the sample, where it has noise", "index", dtype="uint64"),
        Variable("redraws", "1", "draws of the specimen that were refused before", "index", dtype="uint32"),
        Variable("wall_time", "s", "time that the sample took", "index"),
        Variable("case_id", "1", "hash of the sample's resolved case", "index", dtype="str"),
        Variable("code", "1", "which entry of the attribute codes computed the sample", "index", dtype="uint8"),
        Variable("checksum", "1", "SHA-256 of the sample's other variables", "index", ("byte",), (CHECKSUM_BYTES,), "uint8"),
    ]


def flags(values: Array, variable: Variable) -> list[str]:
    """The names of coded values."""
    return [variable.meanings[int(value)] for value in values]
