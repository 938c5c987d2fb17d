"""Whether what is prescribed leaves the volume of a body no freedom, so that an incompressible one has no pressure of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.experiments.boundary_value.motions import Held
from tactsim.experiments.boundary_value.parts import Parts

ROUND_OFF = 1e-9
"""Change of the volume by a free displacement, over the largest, that is none."""


def is_confined(parts: Parts, held: Sequence[Held]) -> bool:
    r"""Whether no displacement that is left free changes the volume: :math:`\int v \cdot n\, dA = 0` for all of them."""
    mesh = parts.domain.mesh
    facets, _ = mesh.boundary_facets()
    points = parts.space.surface_points(facets)
    swept = np.zeros_like(mesh.nodes)
    np.add.at(swept, points.nodes, np.einsum("qa,q,iq->qai", points.values, points.weights, points.normals))
    change = swept.ravel()
    largest = float(np.abs(change).max())
    for one in held:
        change[one.motion.unknowns] = 0.0
        slides = one.motion.slides(0.0)
        slides.add(change, -slides.along(change))
    return bool(np.abs(change).max() <= ROUND_OFF * largest)
