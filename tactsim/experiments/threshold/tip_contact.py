"""What one sensor of a tip meets: forces over displacement in closed form or from curves, and how large their error may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.experiments.threshold.contact_curve import Approach, ContactCurve

ROWS = 40
"""Rows of a mixed curve before and after the touch."""


@dataclass(frozen=True)
class SensorContact:
    r"""A sensor on tissue in which forces grow with displacement: lengths in m, forces in N.

    .. math:: P = P^* d / d^*, \qquad P_s = k_s \frac{L}{d^*} (d - d^*)_+

    with the threshold at force P* and displacement d*, and k_s of a solid punch of the hole's radius.

    Source: thesis, eq. 4.2.21: a flat face on a linear solid meets a force in proportion to its displacement; the punch after
    Sneddon 1965, doi:10.1016/0020-7225(65)90019-4.
    """

    force: float
    displacement: float
    small_stiffness: float
    recess: float

    def approach(self, speed: float, depth: float) -> Approach:
        """The forces over time at a speed in m/s down to a depth in m after the face has touched."""
        rise_rate = speed * self.recess / self.displacement
        touch = self.displacement / speed

        def forces(times: Array) -> tuple[Array, Array]:
            return self.force * times / touch, self.small_stiffness * rise_rate * np.maximum(times - touch, 0.0)

        reached = touch if depth > self.displacement else np.inf
        return Approach(speed, max(depth, 0.0) / speed, reached, self.force, forces)


@dataclass(frozen=True)
class CurveContact(SensorContact):
    """A sensor on tissue with a curve of its own; the stiffness of the small sensor is that of its first row past the touch."""

    curve: ContactCurve

    def approach(self, speed: float, depth: float) -> Approach:
        """The forces over time at a speed in m/s down to a depth in m; the curve's own speed counts if the tissue relaxes."""
        whole = self.curve.approach(speed)
        reached = whole.touch if depth > self.displacement else np.inf
        return Approach(speed, min(max(depth, 0.0) / speed, whole.duration), reached, self.force, whole.forces)


@dataclass(frozen=True)
class TipContact:
    """A contact with the relative errors of its threshold.

    ``low`` and ``high`` are the smallest and the largest part by which the tissue's threshold may differ from the computed one;
    ``own`` is the part of it, up or down, that the other sensors do not share, by which a ranking may be wrong.
    """

    contact: SensorContact
    low: float
    high: float
    own: float


def mixed_contacts(curves: Sequence[ContactCurve], shares: Array, factors: Array) -> list[SensorContact]:
    """Contacts (sensor,) that mix the curves of tissues by ``shares`` (sensor, tissue), with ``factors`` (sensor, 2) of the mean
    threshold's force and displacement."""
    return [_mixed(curves, share, *map(float, factor)) for share, factor in zip(shares, factors, strict=True)]


def _mixed(curves: Sequence[ContactCurve], shares: Array, force: float, displacement: float) -> CurveContact:
    """The curves mixed at equal parts of the displacement of each tissue's threshold, and at equal distances past it."""
    at = displacement * float(shares @ np.array([curve.threshold_displacement for curve in curves]))
    beyond = min(float(curve.displacement[-1]) - curve.threshold_displacement for curve in curves)
    parts, ways = np.linspace(0.0, 1.0, ROWS), np.linspace(0.0, beyond, ROWS)[1:]
    plate, small = np.zeros(2 * ROWS - 1), np.zeros(2 * ROWS - 1)
    for share, curve in zip(shares.tolist(), curves, strict=True):
        touch = curve.threshold_displacement
        places = np.concatenate([parts * touch, touch + ways])
        approach = curve.approach(1.0)
        pressed = approach.at(places)
        plate += share * force * pressed[0]
        small += share * pressed[1]
    small[:ROWS] = 0.0
    where = np.concatenate([parts * at, at + ways])
    recess = curves[0].shape.recess
    rise = recess * np.concatenate([parts, 1 + ways / at])
    curve = ContactCurve(curves[0].shape, where, plate, rise, small, ROWS - 1)
    threshold = float(plate[ROWS - 1])
    stiffness = float(small[ROWS] / (ways[0] * recess / at))
    return CurveContact(threshold, at, stiffness, recess, curve)
