"""The noise of a reading on the page: its size, and where that comes from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.readings import RESOLUTION, ROUNDING_NOISE

MESH_SHARE = 0.006
"""Error of a taxel over the largest force that a mesh leaves: that of the shipped cells around an artery in the middle of a
block, and three times that of ``cases/grasp_lump_icf.yaml`` (docs/theory/mesh.md)."""


@dataclass(frozen=True)
class ReadingNoise:
    """Standard deviation in N of what a taxel reads, and in words why it is taken."""

    deviation: float
    origin: str


RESOLVED = ReadingNoise(ROUNDING_NOISE, f"that of rounding to {RESOLUTION:g} N, the resolution of the sensors of the thesis")
"""Of readings of which no more is known."""


def given_noise(deviation: float) -> ReadingNoise:
    """That which the user has given, in N."""
    return ReadingNoise(deviation, "as given by --noise")


def solution_noise(forces: Array) -> ReadingNoise:
    """Of forces of a solution in N, of any shape, which no sensor has read: the error of their mesh; that of sensors if none is
    known."""
    largest = float(np.abs(np.where(np.isfinite(forces), forces, 0.0)).max(initial=0.0))
    if largest == 0:
        return RESOLVED
    words = f"{100 * MESH_SHARE:.1f} % of the largest force, the error of the mesh of a simulation, which no sensor has read"
    return ReadingNoise(MESH_SHARE * largest, words)
