"""The variables that every store has, whatever the experiment."""

from __future__ import annotations

import numpy as np

from tactsim.interfaces.variable import Variable

Array = np.ndarray

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
