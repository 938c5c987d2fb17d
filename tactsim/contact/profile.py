"""Bodies of revolution from a profile in the (r, z) half-plane."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import RigidBody
from tactsim.units import format_quantity


class Revolved(RigidBody):
    """A body of revolution about z; points are (r, z) on an axisymmetric mesh or (x, y, z) in 3D."""

    @abstractmethod
    def profile_distance(self, p: Array) -> tuple[Array, Array, Array]:
        """Distance (n,), normal (2, n) and Hessian (2, 2, n) in the half-plane at points (2, n)."""

    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance in m, outward normal and Hessian in 1/m at points (2, n) or (3, n)."""
        if len(x) == 2:
            return self.profile_distance(x)
        radius = np.hypot(x[0], x[1])
        safe = np.where(radius > 0, radius, 1.0)
        radial = np.stack([np.where(radius > 0, x[0], 1.0) / safe, x[1] / safe, np.zeros_like(radius)])
        hoop = np.stack([-radial[1], radial[0], np.zeros_like(radius)])
        axial = np.zeros_like(radial)
        axial[2] = 1.0
        distance, normal, hessian = self.profile_distance(np.stack([radius, x[2]]))
        basis = np.stack([radial, axial])
        lifted = np.einsum("ian,jbn,ijn->abn", basis, basis, hessian)
        around = np.where(radius > 0, normal[0] / safe, hessian[0, 0])  # on the axis its limit
        lifted += around * hoop[:, None] * hoop[None, :]
        return distance, np.einsum("in,ian->an", normal, basis), lifted


def rounded_box(p: Array, lower: Array, upper: Array, fillet: float) -> tuple[Array, Array, Array]:
    """Signed distance, normal and Hessian of a rectangle or box with filleted edges and corners.

    Parameters
    ----------
    p : (d, n) points in m
    lower, upper : (d,) opposite corners in m
    fillet : radius of the edges in m, at most half the smallest side
    """
    below, above = lower[:, None] - p, p - upper[:, None]
    sign = np.where(below > above, -1.0, 1.0)
    beyond = np.maximum(below, above)
    outside = np.maximum(beyond + fillet, 0.0)
    reach = np.linalg.norm(outside, axis=0)
    rounded = (outside > 0).sum(axis=0) > 1
    distance = np.where(rounded, reach - fillet, beyond.max(axis=0))
    flat = (np.arange(len(p))[:, None] == beyond.argmax(axis=0)).astype(float)
    safe = np.where(rounded, reach, 1.0)
    normal = sign * np.where(rounded, outside / safe, flat)
    turning = np.eye(len(p))[:, :, None] * (outside > 0) - normal[:, None] * normal[None, :]
    return distance, normal, np.where(rounded, 1.0 / safe, 0.0) * turning


def check_fillet(fillet: float, largest: float) -> None:
    """Refuse a fillet in m larger than the rectangle it rounds allows.

    Raises
    ------
    ValueError
        With both radii.
    """
    if fillet > largest:
        given, limit = format_quantity(fillet, "m"), format_quantity(largest, "m")
        raise ValueError(
            f"fillet: {given} is too large; allowed: at most half the width and half the height of the section, {limit}"
        )
