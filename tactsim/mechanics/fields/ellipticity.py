"""Where in a body the material is strongly elliptic."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.materials.stability import strongly_elliptic


def elliptic_in(body: Body, kinematics: Kinematics) -> Array:
    """Whether the material is strongly elliptic at each point (E, Q)."""
    elliptic = np.ones(kinematics.J.shape, bool)
    for index, material in enumerate(body.materials):
        mine = body.regions == index
        elliptic[mine] = strongly_elliptic(material, kinematics.F[:, :, mine])
    return elliptic
