"""What an estimator takes: forces on the taxels of both jaws, checked, and what is known of the grasp."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces.solid import check_size
from tactsim.interfaces.taxel_layout import JAWS as JAWS
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.outside.text import first_names
from tactsim.units import format_quantity

MOST_NAMED = 6
"""Taxels that a message names before it counts the rest."""
PULLED = 4.0
"""Standard deviations of the sum of a jaw's readings below zero from which on they are said to pull."""
RESOLUTION = 0.1
"""Force in N that a sensor resolves: thesis, 3.1.2 and 6.2."""
SAME_BLOCK = 1e-6
"""Largest relative difference of the sides of one block."""
ROUNDING_NOISE = RESOLUTION / 12**0.5
"""Standard deviation in N of what rounding to the resolution does to a force."""


def noise_in_words(noise: float) -> str:
    """A standard deviation in N, and where it comes from if nobody chose it."""
    size = format_quantity(noise, "N")
    return f"{size} (of sensors that resolve {RESOLUTION:g} N, as the thesis's)" if noise == ROUNDING_NOISE else size


class TissueResponse(Protocol):
    """How the forces on all taxels change with a ball in the block, for a contrast of one."""

    @property
    def axes(self) -> tuple[Array, Array, Array]:
        """Ascending centres (n,) in m along each of x, y and z at which it is tabulated."""

    @property
    def radii(self) -> Array:
        """Ascending radii (R,) in m."""

    @property
    def values(self) -> Array:
        """Change of force (R, nx, ny, nz, jaw, row, column) in N."""

    def signal(self, centers: Array, radii: Array) -> Array:
        """Change of force (n, jaw, row, column) in N for centres (n, 3) and radii (n,) in m.

        Raises
        ------
        InvalidQuantity
            If a ball lies outside the table.
        """


@dataclass(frozen=True, eq=False)
class Readings:
    """Forces on the taxels of both jaws, and what is known of the grasp.

    Attributes
    ----------
    forces : (jaw, row, column) in N pressing into the taxels, the upper jaw first, row 1 nearest the front, column 1 smallest x
    layout : of the taxels on each jaw
    block_size : (3,) of the undeformed tissue in m, which begins at the origin
    reference : (jaw, row, column) in N, what the same tissue without a lump reads at the same closing, that of invalid taxels
        interpolated; None if not known
    noise : standard deviation of a reading in N
    noise_origin : in words, why this noise is taken; empty if not known
    valid : (jaw, row, column), False for a dead or saturated taxel; None if all can be trusted
    middle : (2,) x and y in m of the middle of both matrices; None for that of the block
    closing : of each jaw from first touch, in m; None if not known
    response : fast forward model of lumps in this tissue at this closing; None if not known

    Raises
    ------
    InvalidQuantity
        On construction: a wrong shape, a taxel that is not finite (named), a block or noise out of its range, a response of
        other taxels or of another block.
    """

    forces: Array
    layout: TaxelLayout
    block_size: Array
    reference: Array | None = None
    noise: float = ROUNDING_NOISE
    noise_origin: str = ""
    valid: Array | None = None
    middle: Array | None = None
    closing: float | None = None
    response: TissueResponse | None = field(default=None, repr=False)
    filled: Array = field(init=False, repr=False)
    """The forces with those of invalid taxels interpolated from their neighbours."""
    difference: Array | None = field(init=False, repr=False)
    """Forces less reference in N, those of invalid taxels interpolated; None without a reference."""

    def __post_init__(self) -> None:
        forces = np.asarray(self.forces, dtype=float)
        allowed = (len(JAWS), self.layout.rows, self.layout.columns)
        for what, values in (("forces", forces), ("reference", self.reference)):
            if values is not None and np.shape(values) != allowed:
                raise InvalidQuantity(f"{what} of shape {np.shape(values)}; the layout needs (jaw, row, column) = {allowed}")
        size = np.asarray(self.block_size, dtype=float)
        check_size(size)
        if not (np.isfinite(self.noise) and self.noise >= 0):
            raise InvalidQuantity(f"noise {self.noise} N; allowed: finite and not negative")
        middle = size[:2] / 2 if self.middle is None else np.asarray(self.middle, dtype=float)
        if middle.shape != (2,) or not np.isfinite(middle).all():
            raise InvalidQuantity(f"middle of the matrices {middle.tolist()} m; allowed: two finite lengths, x and y")
        if self.response is not None:
            _check_response(self.response, allowed, size)
        reference = None if self.reference is None else checked_readings(self.reference, self.valid)
        difference = None if reference is None else checked_readings(forces - reference, self.valid)
        parts = {"forces": forces, "block_size": size, "middle": middle, "reference": reference, "difference": difference}
        for name, value in (parts | {"filled": checked_readings(forces, self.valid)}).items():
            object.__setattr__(self, name, value)

    @property
    def trusted(self) -> Array:
        """Which taxels (jaw, row, column) can be trusted."""
        return np.ones(self.forces.shape, bool) if self.valid is None else np.asarray(self.valid)

    def taxel_places(self) -> tuple[Array, Array]:
        """Centres of the columns (columns,) along x and of the rows (rows,) along y in m, from the undeformed block's corner."""
        middle = np.asarray(self.middle)
        return self.layout.borders("x").mean(axis=1) + middle[0], self.layout.borders("y").mean(axis=1) + middle[1]


def taxel_name(jaw: int, row: int, column: int) -> str:
    """How messages call a taxel given by its indices, as in thesis Fig. 6.3: "U2,1 (upper jaw, row 2, column 1)"."""
    side = JAWS[jaw]
    return f"{side[0].upper()}{row + 1},{column + 1} ({side} jaw, row {row + 1}, column {column + 1})"


def silent_taxels(readings: Array) -> Array:
    """Which readings (jaw, row, column) are exactly zero although every neighbour in row and column presses: it may be dead."""
    padded = np.pad(np.asarray(readings, dtype=float), ((0, 0), (1, 1), (1, 1)), constant_values=np.inf)
    beside = (padded[:, :-2, 1:-1], padded[:, 2:, 1:-1], padded[:, 1:-1, :-2], padded[:, 1:-1, 2:])
    return (np.asarray(readings) == 0) & np.logical_and.reduce([part > 0 for part in beside]) & (np.prod(readings.shape[1:]) > 1)


def pulled_words(readings: Array, noise: float) -> str | None:
    """What the user must know where the readings (jaw, row, column) of a jaw pull on the whole, beyond their noise in N."""
    sums = np.sum(readings, axis=(1, 2))
    pulled = sums < -PULLED * noise * np.sqrt(np.size(readings[0]))
    if not pulled.any():
        return None
    sides = " and ".join(
        f"the {side} jaw's by {format_quantity(-float(sums[k]), 'N')}" for k, side in enumerate(JAWS) if pulled[k]
    )
    return f"the readings pull on the whole, {sides}, which tissue between jaws does not: forces are positive that press"


def rising(difference: Array) -> tuple[Array, bool]:
    """A change of readings (jaw, row, column) in N, positive where it is strongest, and whether the strongest one is a loss.

    The strongest change is that of the sum of both jaws; it is a loss over something softer than the tissue.
    """
    sums = difference.sum(axis=0)
    softer = bool(-sums.min() > sums.max())
    return (-difference if softer else difference), softer


def shown_change(difference: Array) -> tuple[Array, str]:
    """What views draw of the change from a reference, (jaw, row, column) in N, and what it is in words."""
    signal, softer = rising(difference)
    return signal, f"force {'below' if softer else 'above'} that of the reference"


def named_taxels(chosen: Array) -> str:
    """Those of a mask (jaw, row, column), such as "U2,1, L3,3 and 4 more"."""
    names = [taxel_name(*map(int, place)).split(" ")[0] for place in np.argwhere(chosen)]
    return first_names(names, MOST_NAMED)


def silent_words(silent: Array) -> str:
    """What the user must know of silent taxels (jaw, row, column)."""
    return f"exactly zero although all around press, so perhaps dead, and used as it is: {named_taxels(silent)}"


def checked_readings(readings: Array, valid: Array | None = None) -> Array:
    """Readings (jaw, row, column) as floats, those of invalid taxels interpolated from their neighbours.

    Row 1 is nearest the front (smallest y), column 1 has the smallest x; jaw 0 is the upper one. ``valid`` of the same shape is
    False for a dead or saturated taxel, whose reading is not looked at and may be NaN.

    Raises
    ------
    InvalidQuantity
        If the shape is wrong, a valid taxel is not finite, or a jaw has no valid taxel; it names the taxel.
    """
    forces = np.asarray(readings, dtype=float)
    if forces.ndim != 3 or forces.shape[0] != len(JAWS) or 0 in forces.shape:
        raise InvalidQuantity(
            f"readings of shape {forces.shape}; needed: (2, rows, columns), the upper jaw first, with at least one row and column"
        )
    if valid is None:
        _check_finite(forces)
        return forces
    usable = np.asarray(valid)
    if usable.shape != forces.shape or usable.dtype != bool:
        raise InvalidQuantity(
            f"the mask of valid taxels is {usable.dtype} of shape {usable.shape}; needed: bool of shape {forces.shape}, "
            "True where a taxel can be trusted"
        )
    _check_finite(np.where(usable, forces, 0.0))
    return np.stack([_filled(matrix, good, side) for matrix, good, side in zip(forces, usable, JAWS, strict=True)])


def _check_response(response: TissueResponse, taxels: tuple[int, ...], size: Array) -> None:
    """Refuse the response of other taxels (jaw, row, column), or of a block of another size than (3,) in m."""
    needed = "needed: the response of the same grasp"
    if response.values.shape[4:] != taxels:
        raise InvalidQuantity(
            f"the response of the tissue is that of taxels {response.values.shape[4:]}, the readings are of (jaw, row, column) = "
            f"{taxels}; {needed}"
        )
    tabulated = np.array([axis[0] + axis[-1] for axis in response.axes])
    if not np.allclose(tabulated, size, rtol=SAME_BLOCK):
        given, block = (" x ".join(format_quantity(float(side), "m") for side in sides) for sides in (tabulated, size))
        raise InvalidQuantity(f"the response of the tissue is that of a block of {given}, the readings are of {block}; {needed}")


def _check_finite(readings: Array) -> None:
    if np.isfinite(readings).all():
        return
    jaw, row, column = (int(k) for k in np.argwhere(~np.isfinite(readings))[0])
    raise InvalidQuantity(
        f"taxel {taxel_name(jaw, row, column)} reads {readings[jaw, row, column]}; needed: a finite number, "
        "or False for this taxel in the mask of valid taxels (key dead of a case)"
    )


def _filled(matrix: Array, good: Array, side: str) -> Array:
    """A matrix (rows, columns) whose invalid taxels are each the mean of their neighbours in row and column.

    The means of adjoining invalid taxels depend on each other: they solve the discrete Laplace equation, with the valid taxels
    given and no flow across the border, and lie between the least and the largest valid reading.
    """
    if good.all():
        return matrix
    if not good.any():
        raise InvalidQuantity(f"all taxels of the {side} jaw are marked invalid; needed: at least one that can be trusted")
    number = np.full(matrix.shape, -1)
    number[~good] = np.arange((~good).sum())
    system, given = np.zeros((number.max() + 1,) * 2), np.zeros(number.max() + 1)
    for row, column in np.argwhere(~good):
        here = number[row, column]
        for near in ((row - 1, column), (row + 1, column), (row, column - 1), (row, column + 1)):
            if not (0 <= near[0] < matrix.shape[0] and 0 <= near[1] < matrix.shape[1]):
                continue
            system[here, here] += 1
            if good[near]:
                given[here] += matrix[near]
            else:
                system[here, number[near]] -= 1
    filled = matrix.copy()
    filled[~good] = np.linalg.solve(system, given)
    return filled
