"""The units of what a run records, checked as its kind is defined: at the end of a first long run it would be too late."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from tactsim.kind import CaseKind
from tactsim.units import check_unit


class KindWithHistory(CaseKind):
    """What records values at every accepted step."""

    history_units: ClassVar[dict[str, str]] = {}
    """Unit of every value that an accepted step records."""

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        units: Any = cls.history_units
        for name, unit in units.items() if isinstance(units, Mapping) else ():  # a property has those of its instances
            check_unit(f"{cls.__name__}.history_units: {name}", unit)
        super().__pydantic_init_subclass__(**options)
