"""What is common to rigid bodies that are another one in axes of their own."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import RigidBody
from tactsim.interfaces.contact_shape import ContactShape


class BodyInOwnAxes(RigidBody):
    """A body turned about its reference point, which stays at the origin."""

    body: RigidBody
    """The body that is turned."""

    @property
    @abstractmethod
    def rotation(self) -> Array:
        """Matrix (d, d) that turns the body's own axes into those of the tissue."""

    @property
    def contact_shape(self) -> ContactShape:
        """That of the body that is turned."""
        return self.body.contact_shape

    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance in m, outward normal and Hessian in 1/m at points (d, n)."""
        return in_turned_axes(self.rotation, self.body.signed_distance, x)


def in_turned_axes(turn: Array, own: Callable[[Array], tuple[Array, Array, Array]], x: Array) -> tuple[Array, Array, Array]:
    """Distance (n,) in m, normal (d, n) and Hessian (d, d, n) in 1/m at points (d, n) of what ``own`` gives in its own axes.

    ``turn`` (d, d) turns these axes into those of the points.
    """
    distance, normal, hessian = own(turn.T @ x)
    return distance, turn @ normal, np.einsum("ij,jkn,lk->iln", turn, hessian, turn)
