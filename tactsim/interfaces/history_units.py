"""The units of what a run records, checked as its kind is defined: at the end of a first long run it would be too late."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from tactsim.errors import InvalidQuantity
from tactsim.kind import CaseKind
from tactsim.units import check_unit


class KindWithHistory(CaseKind):
    """What records values at every accepted step."""

    history_units: ClassVar[dict[str, str]] = {}
    """Unit of every value that an accepted step records."""

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        units: Any = cls.history_units
        if not isinstance(units, property):  # which has those of its instances
            if not isinstance(units, Mapping):
                raise InvalidQuantity(f"{cls.__name__}.history_units is a {type(units).__name__}; needed: a unit by each name")
            for name, unit in units.items():
                check_unit(f"{cls.__name__}.history_units: {name}", unit)
        super().__pydantic_init_subclass__(**options)
