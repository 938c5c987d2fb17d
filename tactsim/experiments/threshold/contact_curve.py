"""Forces on the filler plate and on the small sensor over displacement, and over time at a speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy

from tactsim.analytic.annular_area import annular_area
from tactsim.analytic.force_factor import force_factor
from tactsim.array import Array
from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.scene import IndentationScene
from tactsim.results.result import Result, Status
from tactsim.units import format_quantity

RECESS_TOLERANCE = 0.01
"""Difference of the rise at the touch from the recess, over the recess, beyond which a curve is that of another sensor."""


@dataclass(frozen=True)
class SensorShape:
    """The annular face and the recess of a threshold sensor, lengths in m."""

    inner_radius: float
    outer_radius: float
    recess: float

    @property
    def area(self) -> float:
        """Annular area in m^2."""
        return annular_area(self.inner_radius, self.outer_radius)


@dataclass(frozen=True)
class Approach:
    """What acts on a sensor that moves into tissue at a constant speed in m/s; times in s since the face touched."""

    speed: float
    duration: float
    """Time in s until the end of what is known."""
    touch: float
    """Time in s at which the tissue touches the small sensor."""
    threshold_force: float
    """On the plate at the touch, in N."""
    forces: Callable[[Array], tuple[Array, Array]]
    """Forces in N on the plate and on the small sensor at times of shape (n,), each (n,)."""

    def at(self, times: Array) -> tuple[Array, Array]:
        """Forces (n,) in N on plate and small sensor at times (n,) in s; 0 before the face touches, never negative."""
        plate, small = self.forces(np.clip(times, 0.0, self.duration))
        return np.maximum(plate, 0.0), np.maximum(small, 0.0)


@dataclass(frozen=True)
class ContactCurve:
    """Rate-independent forces over displacement: rows up to the touch, and rows past it.

    Arrays of shape (n,): displacement in m from 0, strictly increasing, force on the plate, rise of the tissue, force on the
    small sensor, which is 0 up to the row ``touch``.

    Raises
    ------
    InvalidQuantity
        If the rows are too few, do not increase, or the small sensor is never touched.
    """

    shape: SensorShape
    displacement: Array
    plate: Array
    rise: Array
    small: Array
    touch: int

    def __post_init__(self) -> None:
        if (np.diff(self.displacement) <= 0).any() or self.displacement[0] != 0:
            raise InvalidQuantity("the displacements of a contact curve must begin at 0 and increase")
        if not 2 <= self.touch < len(self.displacement) - 1:
            counts = f"{self.touch + 1} rows up to the touch and {len(self.displacement) - 1 - self.touch} past it"
            raise InvalidQuantity(f"a contact curve has {counts}; allowed: at least 3 and 1")

    @classmethod
    def of_rows(cls, shape: SensorShape, columns: dict[str, Array]) -> Self:
        """From rows with a force on the small sensor, which begins after the row of the touch; columns (n,) in m and N.

        Raises
        ------
        InvalidQuantity
            If a number is negative, the small sensor is never touched, or not after a rise by the recess.
        """
        d, plate, rise, small = (columns[name] for name in ("displacement", "plate force", "tissue rise", "small sensor force"))
        for name, unit in (("displacement", "m"), ("plate force", "N"), ("small sensor force", "N")):
            for row in np.flatnonzero(columns[name] < 0)[:1]:
                given = format_quantity(float(columns[name][row]), unit)
                raise InvalidQuantity(f"{name} in row {row + 1} is {given}, negative; allowed: 0 and above")
        for row in np.flatnonzero(np.diff(d) <= 0)[:1]:
            after, before = (format_quantity(float(d[row + k]), "m") for k in (1, 0))
            raise InvalidQuantity(f"displacement in row {row + 2} is {after} after {before}; allowed: rows that increase")
        pressed = small > 0
        if not pressed.any() or pressed[0]:
            raise InvalidQuantity("a contact curve must begin before the small sensor is touched and go on past the touch")
        risen = float(rise[int(pressed.argmax()) - 1])
        if abs(risen - shape.recess) > RECESS_TOLERANCE * shape.recess:
            risen_text, recess_text = format_quantity(risen, "m"), format_quantity(shape.recess, "m")
            raise InvalidQuantity(
                f"in the contact curve the tissue has risen by {risen_text} in the last row without a force on the small sensor, "
                f"but the recess is {recess_text}; give the recess of the curve, or a row at the touch"
            )
        if d[0] > 0:
            d, plate, rise, small = (np.append(0.0, values) for values in (d, plate, rise, small))
            pressed = small > 0
        return cls(shape, d, plate, rise, small, int(pressed.argmax()) - 1)

    @classmethod
    def of_result(cls, result: Result, *, beyond: float) -> Self:
        """From the history of an indentation by an annulus; one that stops at its threshold is continued by ``beyond`` in m.

        Raises
        ------
        InputError
            If the result is no converged indentation by an annulus with a threshold.
        """
        reached = result.quantities.get("threshold_displacement")
        if Indentation.registered_as(result.kind) is None or result.status is not Status.CONVERGED or reached is None:
            description = f"kind {result.kind}, {result.status}, {'no ' if reached is None else ''}threshold"
            raise InputError(
                f"the result is not usable ({description}); needed: a converged indentation by an annulus to its threshold"
            )
        scene = result.scene_as(IndentationScene)
        touching = scene.body.contact_shape
        if not touching.hole or touching.radius is None or scene.recess is None:
            raise InputError(f"the body of the result is a {scene.body.kind}; needed: an annulus with an inner sensor")
        shape = SensorShape(touching.hole, touching.radius, scene.recess)
        names = ("displacement", "reaction_force", "tissue_rise", "sensor_force")
        rows = np.array([[0.0] * 4] + [[step.values[name] for name in names] for step in result.steps])
        touch = int(np.argmin(np.abs(rows[:, 0] - reached.value)))
        rows[: touch + 1, 3] = 0.0
        if touch == len(rows) - 1:
            rows = np.vstack([rows, continued(rows, shape, beyond)])
        displacement, plate, rise, small = np.maximum(rows.T, 0.0)
        return cls(shape, displacement, plate, rise, small, touch)

    @property
    def threshold_displacement(self) -> float:
        """In m."""
        return float(self.displacement[self.touch])

    def approach(self, speed: float) -> Approach:
        """The forces over time at a speed in m/s: between the rows monotone cubic, with a kink at the touch."""
        before, after = slice(None, self.touch + 1), slice(self.touch, None)
        d, touch = self.displacement, self.threshold_displacement
        rising, pressing = (scipy.interpolate.PchipInterpolator(d[part], self.plate[part]) for part in (before, after))
        small = scipy.interpolate.PchipInterpolator(d[after], self.small[after])

        def forces(times: Array) -> tuple[Array, Array]:
            at = np.minimum(speed * times, d[-1])
            late = at > touch
            return np.where(late, pressing(at), rising(at)), np.where(late, small(at), np.zeros_like(at))

        return Approach(speed, float(d[-1]) / speed, touch / speed, float(self.plate[self.touch]), forces)


def continued(rows: Array, shape: SensorShape, beyond: float) -> Array:
    r"""A row (4,) past the last of ``rows`` (n, 4), by ``beyond`` in m: the last slopes go on, the small sensor is a solid punch.

    The columns are displacement in m, force on the plate in N, rise in m and force on the small sensor in N.

    .. math:: k_s = \frac{b}{a \kappa} \frac{dP}{d\epsilon}

    since an annulus has 8 G a kappa and a punch of the hole's radius 8 G b.

    Source: thesis, eq. 4.2.21, for the annulus; Sneddon 1965, doi:10.1016/0020-7225(65)90019-4, for the punch; nu = 1/2.
    """
    last, step = rows[-1], rows[-1] - rows[-2]
    slopes = step / step[0]
    ratio = shape.inner_radius / shape.outer_radius
    stiffness = ratio / float(force_factor(ratio)) * slopes[1]
    added = last + slopes * beyond
    added[3] = stiffness * slopes[2] * beyond
    return added
