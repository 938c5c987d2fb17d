"""Whether a law has its own stress and tangent in the shapes that are needed, and the one as the derivative of the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import Material
from tactsim.materials.kinematics import STRAIN, sampled_deformations

STATES = 3
"""Deformations at which derivatives are compared."""
STEP = 1e-6
"""Of the deformation gradient, for central differences; errors of a smooth law are some 1e-9."""
TOLERANCE = 1e-2
"""Part of the largest derivative that may be missed: far above differences, far below a missing factor or term."""


def check_law(law: Material) -> None:
    """Refuse a law whose stress, tangent or change of volume has a wrong shape, is no number, or does not fit its derivative.

    They are looked at under a pressure as large as the shear modulus: without any, a term of it that is wrong is not seen.

    Raises
    ------
    InvalidQuantity
        Naming the class, the method, and what it must return.
    """
    F = sampled_deformations(STATES)
    pressure = np.full(STATES, law.shear_modulus)
    with np.errstate(all="ignore"):
        _compare(law, ("first_piola_kirchhoff", "tangent"), (3, 3), F, pressure)
        _compare(law, ("volume_change", "volume_change_gradient"), (), F)
        _check_pressure(law, F, pressure)


def _check_pressure(law: Material, F: Array, pressure: Array) -> None:
    """Refuse a stress that does not contain the pressure times the slope of the volume change, which the weak form relies on."""
    stress, without = (_returned(law, "first_piola_kirchhoff", (3, 3, STATES), F, one) for one in (pressure, 0 * pressure))
    needed = pressure * _returned(law, "volume_change_gradient", (3, 3, STATES), F)
    if np.abs(stress - without - needed).max() > TOLERANCE * np.abs(needed).max():
        raise InvalidQuantity(
            f"first_piola_kirchhoff of {type(law).__name__} must contain the pressure times its volume_change_gradient; under a "
            f"pressure of {pressure[0]:.6g} Pa it grows by {np.abs(stress - without).max():.6g} Pa instead of "
            f"{np.abs(needed).max():.6g} Pa at most"
        )


def _compare(law: Material, methods: tuple[str, str], leading: tuple[int, ...], F: Array, *pressure: Array) -> None:
    """Refuses a second method that is not the derivative by F of the first, whose values have these leading axes."""

    def value(at: Array) -> Array:
        return _returned(law, methods[0], (*leading, STATES), at, *pressure)

    value(F)
    stated = _returned(law, methods[1], (*leading, 3, 3, STATES), F, *pressure)
    differences = _differences(value, F)
    off = np.abs(stated - differences)
    if off.max() > TOLERANCE * np.abs(differences).max():
        place = np.unravel_index(int(off.argmax()), off.shape)
        raise InvalidQuantity(
            f"{methods[1]} of {type(law).__name__} is not the derivative of its {methods[0]}: at strains of {STRAIN:.0%} "
            f"its component {[int(k) for k in place[:-1]]} is {stated[place]:.6g}, by differences {differences[place]:.6g}"
        )


def _differences(value: Callable[[Array], Array], F: Array) -> Array:
    """Central differences (..., 3, 3, states) of a function (..., states) of F (3, 3, states)."""
    steps = STEP * np.eye(9).reshape(9, 3, 3, 1)
    columns = [(value(F + step) - value(F - step)) / (2 * STEP) for step in steps]
    return np.moveaxis(np.array(columns), 0, -2).reshape(*columns[0].shape[:-1], 3, 3, STATES)


def _returned(law: Material, method: str, shape: tuple[int, ...], *given: Array) -> Array:
    """What a method returns, of the shape."""
    called = f"{method} of {type(law).__name__}"
    try:
        returned: Any = getattr(law, method)(*given)
    except ValueError as error:
        raise InvalidQuantity(f"{called} failed at strains of {STRAIN:.0%}: {error}") from error
    if not isinstance(returned, np.ndarray) or returned.shape != shape:
        what = f"the shape {returned.shape}" if isinstance(returned, np.ndarray) else f"a {type(returned).__name__}"
        raise InvalidQuantity(f"{called} must return an array of the shape {shape} for F of {given[0].shape}; it returned {what}")
    if not np.isfinite(returned).all():
        raise InvalidQuantity(f"{called} is not finite at strains of {STRAIN:.0%}")
    return returned
