"""What the matrices of both jaws read, checked, with dead and saturated taxels filled from their neighbours."""

from __future__ import annotations

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.interfaces.taxel_layout import JAWS as JAWS

Array = np.ndarray

MOST_NAMED = 6
"""Taxels that a message names before it counts the rest."""


def taxel_name(jaw: int, row: int, column: int) -> str:
    """How messages call a taxel given by its indices, as in thesis Fig. 6.3: "U2,1 (upper jaw, row 2, column 1)"."""
    side = JAWS[jaw]
    return f"{side[0].upper()}{row + 1},{column + 1} ({side} jaw, row {row + 1}, column {column + 1})"


def silent_taxels(readings: Array) -> Array:
    """Which readings (jaw, row, column) are exactly zero although every neighbour in row and column presses: it may be dead."""
    padded = np.pad(np.asarray(readings, dtype=float), ((0, 0), (1, 1), (1, 1)), constant_values=np.inf)
    beside = (padded[:, :-2, 1:-1], padded[:, 2:, 1:-1], padded[:, 1:-1, :-2], padded[:, 1:-1, 2:])
    return (np.asarray(readings) == 0) & np.logical_and.reduce([part > 0 for part in beside]) & (np.prod(readings.shape[1:]) > 1)


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
    return ", ".join(names[:MOST_NAMED]) + (f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else "")


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
    found = np.asarray(readings, dtype=float)
    if found.ndim != 3 or found.shape[0] != len(JAWS) or 0 in found.shape:
        raise InvalidQuantity(
            f"readings of shape {found.shape}; needed: (2, rows, columns), the upper jaw first, with at least one row and column"
        )
    if valid is None:
        _check_finite(found)
        return found
    usable = np.asarray(valid)
    if usable.shape != found.shape or usable.dtype != bool:
        raise InvalidQuantity(
            f"the mask of valid taxels is {usable.dtype} of shape {usable.shape}; needed: bool of shape {found.shape}, "
            "True where a taxel can be trusted"
        )
    _check_finite(np.where(usable, found, 0.0))
    return np.stack([_filled(matrix, good, side) for matrix, good, side in zip(found, usable, JAWS, strict=True)])


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
    found = matrix.copy()
    found[~good] = np.linalg.solve(system, given)
    return found
