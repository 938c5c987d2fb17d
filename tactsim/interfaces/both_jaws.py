"""What a result of a grasp holds of both jaws: the names of the quantities of its taxels, and their values in one array."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal, get_args

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.results.result import Result

Source = Literal["taxel_force", "read_force"]
"""Forces of the solution, or those read through film, electronics and calibration."""
TAXEL_FORCE: Source
READ_FORCE: Source
TAXEL_FORCE, READ_FORCE = get_args(Source)
"""Each is stored for a jaw and its last step, ``taxel_force_upper``, and over time, ``taxel_force_upper_history``."""
TAXEL_PRESSURE, TAXEL_DIFFERENCE, VOLTAGE, SATURATED = "taxel_pressure", "taxel_difference", "voltage", "saturated"


def has_taxels(result: Result, name: str, *, history: bool = False) -> bool:
    """Whether a result has a quantity of the taxels, and if asked for, its history."""
    return f"{name}_{JAWS[0]}{'_history' if history else ''}" in result.quantities


def over_time(result: Result, name: str) -> Array:
    """A quantity (step, ...) in SI; a run with a single step keeps no history, only its end.

    Raises
    ------
    UnknownName
        If the result does not hold it.
    """
    history = f"{name}_history"
    return result.quantities[history].numbers if history in result.quantities else result[name].numbers[None]


def jaws_over_time(result: Result, name: str) -> Array:
    """A quantity of both jaws (step, jaw, ...) in SI, the upper jaw first; it raises what `jaws_at_end` raises."""
    return _of_jaws(name, partial(over_time, result), axis=1)


def jaws_at_end(result: Result, name: str) -> Array:
    """A quantity of both jaws (jaw, ...) at the end in SI, the upper jaw first.

    Raises
    ------
    InputError
        If the result does not hold it as numbers in arrays of one shape.
    """
    return _of_jaws(name, lambda of_one: result[of_one].numbers, axis=0)


def saturated_taxels(result: Result) -> Array:
    """Which readings (time or 1, jaw, row, column) are saturated; a taxel of which no times are known is so all the time.

    Raises
    ------
    InputError
        If the result does not hold it as numbers in arrays of one shape.
    """
    return jaws_over_time(result, SATURATED) > 0


def _of_jaws(name: str, read: Callable[[str], Array], axis: int) -> Array:
    try:
        return np.stack([read(f"{name}_{side}") for side in JAWS], axis=axis)
    except (LookupError, TypeError, ValueError):
        raise InputError(f"{name} of both jaws are not numbers in matrices of one shape, as a run writes them") from None
