"""Whether the derivatives that an energy of the invariants states are its derivatives, and have the shapes that are needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity

STRETCHES = np.array([0.8, 1.1, 1.3])
"""Of the uniaxial states in which derivatives are compared."""
STEP = 1e-4
"""Of the invariants, for central differences; errors of second order are some 1e-8 of a smooth energy."""
TOLERANCE = 1e-2
"""Part of the largest derivative that may be missed: far above differences, far below a missing factor or term."""


class Energy(Protocol):
    """An energy W of the invariants I1 and I2, with its derivatives."""

    def energy(self, I1: Array, I2: Array) -> Array:
        """W in J/m^3, of the shape of the invariants."""

    def energy_gradient(self, I1: Array, I2: Array) -> tuple[Array, Array]:
        """(W1, W2) in Pa, each of the shape of the invariants."""

    def energy_hessian(self, I1: Array, I2: Array) -> tuple[Array, Array, Array]:
        """(W11, W12, W22) in Pa, each of the shape of the invariants."""


def check_derivatives(law: Energy) -> None:
    """Refuse a law whose derivatives have a wrong shape or are not those of its energy, at the states in which it has one.

    Raises
    ------
    InvalidQuantity
        Naming the class, the method, the state and both numbers.
    """
    I1, I2 = STRETCHES**2 + 2 / STRETCHES, 2 * STRETCHES + STRETCHES**-2
    with np.errstate(all="ignore"):
        gradient = _parts(law, "energy_gradient", ("W1", "W2"), I1, I2)
        hessian = _parts(law, "energy_hessian", ("W11", "W12", "W22"), I1, I2)
        slopes = _differences(lambda a, b: np.asarray(law.energy(a, b))[None], I1, I2)[:, 0]
        bends = _differences(lambda a, b: _parts(law, "energy_gradient", ("W1", "W2"), a, b), I1, I2)
    _compare(law, "energy_gradient", dict(zip(("W1", "W2"), zip(gradient, slopes, strict=True), strict=True)), (I1, I2), 0.0)
    second = {"W11": (hessian[0], bends[0, 0]), "W12": (hessian[1], bends[1, 0]), "W22": (hessian[2], bends[1, 1])}
    _compare(law, "energy_hessian", second, (I1, I2), float(np.nanmax(np.abs(gradient), initial=0.0)))


def _parts(law: Energy, method: str, names: tuple[str, ...], I1: Array, I2: Array) -> Array:
    """What a method returns, (parts, states)."""
    try:
        returned: Any = getattr(law, method)(I1, I2)
    except ValueError as error:
        raise InvalidQuantity(f"{method} of {type(law).__name__} failed at stretches of {STRETCHES.tolist()}: {error}") from error
    needed = f"{method} of {type(law).__name__} must return ({', '.join(names)}), each of the shape of the invariants"
    if not isinstance(returned, tuple) or len(returned) != len(names):
        raise InvalidQuantity(f"{needed}; it returned {_described(returned)}")
    if any(np.shape(part) not in ((), I1.shape) for part in returned):
        raise InvalidQuantity(f"{needed} {I1.shape}; theirs are {', '.join(str(np.shape(part)) for part in returned)}")
    return np.array([np.broadcast_to(np.asarray(part, dtype=float), I1.shape) for part in returned])


def _described(returned: Any) -> str:
    return f"{len(returned)} of them" if isinstance(returned, tuple) else f"a {type(returned).__name__}"


def _differences(function: Callable[[Array, Array], Array], I1: Array, I2: Array) -> Array:
    """Central differences (2, parts, states) of a function (parts, states) of the invariants, by I1 and by I2."""
    by_first = function(I1 + STEP, I2) - function(I1 - STEP, I2)
    by_second = function(I1, I2 + STEP) - function(I1, I2 - STEP)
    return np.array([by_first, by_second]) / (2 * STEP)


def _compare(law: Energy, method: str, pairs: dict[str, tuple[Array, Array]], state: tuple[Array, Array], scale: float) -> None:
    finite = [np.abs(np.concatenate(pair)) for pair in pairs.values()]
    scale = max([scale, *(float(values[np.isfinite(values)].max(initial=0.0)) for values in finite)])
    for name, (stated, differences) in pairs.items():
        off = np.abs(stated - differences) > TOLERANCE * scale  # no number: False
        if off.any():
            k = int(np.argmax(off))
            whose = "its energy" if method == "energy_gradient" else "its energy_gradient"
            raise InvalidQuantity(
                f"{method} of {type(law).__name__} is not the derivative of {whose}: at I1 = {state[0][k]:.4g}, I2 = "
                f"{state[1][k]:.4g} its {name} is {stated[k]:.6g} Pa, by differences {differences[k]:.6g} Pa"
            )
