"""The base of every value that a case holds: closed, immutable, and refused in words when it is made in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, ValidationError

from tactsim.errors import Refused
from tactsim.refusals import refusals_of
from tactsim.units import written

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)


class _MadeInPython(ModelMetaclass):
    """What is wrong with a value made in Python raises the message that a case file has for it; fields may go by position."""

    def __call__(cls, *values: Any, **fields: Any) -> Any:
        named = dict(zip((name for name in cls.model_fields if name != "kind"), values, strict=False))  # type: ignore[attr-defined]
        if len(named) < len(values):
            raise TypeError(f"{cls.__name__} takes at most {len(named)} values by position, {len(values)} were given")
        if twice := named.keys() & fields.keys():
            raise TypeError(f"{cls.__name__}: {', '.join(sorted(twice))} is given by position and by name")
        try:
            return super().__call__(**named, **fields)
        except ValidationError as error:
            refusals = refusals_of(error, written(named | fields), cls)  # type: ignore[arg-type]
            places = {".".join(map(str, path)): message for path, message in refusals.items()}
            lines = [": ".join(part for part in (cls.__name__, place, message) if part) for place, message in places.items()]
            raise Refused("\n".join(lines), error) from None


class FrozenModel(BaseModel, metaclass=_MadeInPython):
    """A closed, immutable value: unknown keys, NaN and later changes are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
