"""How a rigid body leans."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.units import Angle

Tilt = Annotated[Angle, Field(ge=-0.5, le=0.5)]
"""Angle by which a body may lean, either way."""


def tilt_matrix(tilt_x: float, tilt_y: float) -> Array:
    """Rotation (3, 3) by ``tilt_x`` about the x axis and then by ``tilt_y`` about the y axis, both in rad and right-handed."""
    (sx, cx), (sy, cy) = ((np.sin(angle), np.cos(angle)) for angle in (tilt_x, tilt_y))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    return about_y @ about_x
