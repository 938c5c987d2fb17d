"""Where in a body the material is strongly elliptic."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.stability import convex_in_invariants, strongly_elliptic


def elliptic_in(body: Body, kinematics: Kinematics) -> Array:
    """Whether the material is strongly elliptic at each point (E, Q)."""
    elliptic = np.ones(kinematics.J.shape, bool)
    for index, material in enumerate(body.materials):
        mine = np.broadcast_to((body.regions == index)[:, None], elliptic.shape).copy()
        if isinstance(material, Hyperelastic):  # most points need no stretches, which take ten times as long
            convex = convex_in_invariants(material, kinematics.I1[mine], kinematics.I2[mine])
            mine[mine] = ~((kinematics.J[mine] > 0) & convex)
        elliptic[mine] = strongly_elliptic(material, kinematics.F[:, :, mine])
    return elliptic
