"""The marks of functions that the tables of the thesis call by their name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from tactsim.marked_functions import MarkedFunction, mark
from tactsim.units import check_unit

Function = TypeVar("Function", bound=Callable[..., Any])


def quantity(*, unit: str | Callable[..., str], check: Callable[..., None] | None = None) -> Callable[[Function], Function]:
    """Marks a function as a number that rows of a thesis table compare, wherever it is defined.

    ::

        @quantity(unit="Pa")
        def initial_modulus(material: str) -> float: ...

    A row asks for it with ``evaluate: {kind: initial_modulus, material: icf_printed}``. The type of an argument sets its unit and
    bounds; its description stands there or under ``Parameters``. A parameter ``inputs: Inputs`` receives the outcomes of the
    table's studies. ``unit`` and ``check`` are those of `MarkedFunction`.

    Raises
    ------
    InvalidQuantity
        When the function is marked, if its unit is unknown.
    """

    def marked(function: Function) -> Function:
        if isinstance(unit, str):
            check_unit(f"the unit of the quantity {function.__name__}", unit)
        mark(MarkedFunction("quantity", function, unit, check))
        return function

    return marked


def drawing(function: Function) -> Function:
    """Marks a function, as `quantity` does, as one that returns the plain data of a figure of a thesis table."""
    mark(MarkedFunction("drawing", function))
    return function
