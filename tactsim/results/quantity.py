"""A number or an array with its unit, and what lies along the axes of an array."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.unit_conversion import compact, in_pint
from tactsim.units import conversion, format_quantity

if TYPE_CHECKING:
    import xarray

LISTED = 4
"""Values of a list that are all shown, such as a place."""
ROUND_OFF = 1e-10
"""Part of the largest component of a vector below which another is 0: no sum over 1e5 points solved to 1e-10 is better."""


@dataclass(frozen=True)
class Coordinate:
    """Values along an axis, in SI, or names along it; several may belong to one axis."""

    axis: str
    values: tuple[float, ...] | tuple[str, ...]
    unit: str = ""
    """Empty of names."""
    description: str = ""


@dataclass(frozen=True)
class Quantity(NDArrayOperatorsMixin):
    """A number or an array with its unit; in SI where tactsim made it.

    Operators and numpy's elementwise functions give quantities of pint, with the units that follow; whatever else reads it as an
    array, a sum or a plot, sees plain numbers in ``unit``.

    >>> import tactsim as ts
    >>> forces = ts.Quantity([0.2, 0.3], "N", "forces of two taxels")
    >>> forces.to("mN").value
    [200.0, 300.0]
    >>> forces.array.attrs["units"]
    'N'
    >>> print(forces / ts.Quantity(2.0, "mm", "closing"))
    [0.1 0.15] newton / millimeter

    Attributes
    ----------
    value : number, or nested lists of numbers
    unit : such as ``Pa``; ``1`` for a plain number
    dims : names of the axes of an array, as `array` has them
    coordinates : what lies along them, by name
    """

    value: Any
    unit: str
    description: str
    dims: tuple[str, ...] = field(default=(), compare=False, repr=False)
    coordinates: Mapping[str, Coordinate] = field(default_factory=dict, compare=False, repr=False)

    @property
    def numbers(self) -> np.ndarray:
        """The value as an array of floats of its own shape, NaN where there is none."""
        return np.asarray(self.value, dtype=float)

    @property
    def array(self) -> xarray.DataArray:
        """The value as a `xarray.DataArray` with its unit and description in ``attrs``; a number has no dimensions.

        Coordinates are in SI: the places of rows and columns of taxels in the block, the times of steps.
        """
        import xarray

        attributes = {"units": self.unit, "long_name": self.description}
        along = {
            name: (one.axis, list(one.values), {"units": one.unit, "long_name": one.description} if one.unit else {})
            for name, one in self.coordinates.items()
        }
        return xarray.DataArray(self.numbers, along, self.dims or None, attrs=attributes)

    @property
    def pint(self) -> Any:
        """The value as a quantity of pint's application registry, which computes with units."""
        return in_pint(self.numbers[()], self.unit)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        elementwise = method == "__call__"
        operands = [(one.pint if elementwise else one.numbers) if isinstance(one, Quantity) else one for one in inputs]
        return getattr(ufunc, method)(*operands, **options)

    def to(self, unit: str) -> Quantity:
        """The same quantity in another unit.

        Raises
        ------
        InvalidQuantity
            If the unit is no text, unknown or has another dimension.
        """
        if not isinstance(unit, str):
            raise InvalidQuantity(f"needed: a unit as text, such as {self.unit or '1'!r}, not {unit!r:.60}")
        factor = conversion(self.unit, unit)
        value = self.numbers * factor
        return replace(self, value=float(value) if value.ndim == 0 else value.tolist(), unit=unit)

    def __float__(self) -> float:
        return float(self.value)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.numbers, dtype=dtype)

    def __format__(self, form: str) -> str:
        return f"{_formatted(self.value, form)} {self.unit}".removesuffix(" 1") if form else str(self)

    def __str__(self) -> str:
        return f"{self.value} {self.unit}".removesuffix(" 1")


def _formatted(value: Any, form: str) -> str:
    """A number, or each one of nested lists, None among them as NaN."""
    if isinstance(value, list | tuple | np.ndarray):
        return f"[{', '.join(_formatted(one, form) for one in value)}]"
    return format(np.nan if value is None else value, form)


def _in_one_unit(values: Array, unit: str) -> list[str]:
    """Each of a few values in the unit in which the largest of them reads well, so that they compare."""
    largest = float(np.abs(values).max(initial=0.0))
    if unit in ("", "1", "rad") or not largest:
        return [format_quantity(float(value), unit) for value in values]
    number, shown = compact(largest, unit, "P")
    return [f"{value * (number / largest):.5g} {shown}" for value in values]


def _without_round_off(values: Array) -> Array:
    """Values with zero for what is nothing beside the largest."""
    return np.where(np.abs(values) < ROUND_OFF * np.abs(values).max(initial=0.0), 0.0, values)


def format_values(quantity: Quantity) -> str:
    """A number with its unit, or the shape and range of an array."""
    if quantity.value is None:
        return "none"
    values = quantity.numbers
    if values.ndim == 0:
        return format_quantity(float(values), quantity.unit)
    if values.ndim == 1 and values.size <= LISTED and np.isfinite(values).all():
        return ", ".join(_in_one_unit(_without_round_off(values), quantity.unit))
    finite = values[np.isfinite(values)]
    shape = " x ".join(map(str, values.shape))
    if not finite.size:
        return f"{shape} values, none finite"
    low, high = (
        format_quantity(float(bound), quantity.unit) for bound in _without_round_off(np.array([finite.min(), finite.max()]))
    )
    return f"{shape} values, {low} to {high}" if low != high or finite.size < values.size else f"{shape} values, all {low}"
