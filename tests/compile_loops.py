"""Compiles the element loops of ``scripts/test``'s workers, those of the dimension given: 2 or 3.

Each worker would compile both for itself, as all need them at the beginning; two processes compile one each.
"""

from __future__ import annotations

import sys

import numpy as np
from solids import body_of, box

from tactsim.fem.assembly.space import Measure
from tactsim.materials.neo_hookean import NeoHookean

MEASURES: dict[int, Measure] = {2: "plane_strain", 3: "solid"}


def compile_loops(dim: int) -> None:
    """Deformation, residual and tangent of a body at rest, whose code numba keeps."""
    body = body_of(box((1.0,) * dim, (1,) * dim), MEASURES[dim], NeoHookean(c10=1000.0))
    rest = np.zeros(body.space.size)
    body.residual(rest)
    body.tangent(rest)


if __name__ == "__main__":
    compile_loops(int(sys.argv[1]))
