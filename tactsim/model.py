"""The base of every value that a case holds: closed, immutable, and refused in words when it is made in Python."""

from __future__ import annotations

import inspect
import itertools
import keyword
import math
import os
import sys
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, Self, get_args, get_origin, get_type_hints

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from tactsim.errors import InputError, Refused, shown
from tactsim.field_docstrings import with_fields
from tactsim.refusals import refusals_of
from tactsim.schema_of_model import unit_at
from tactsim.units import written, written_quantity

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)


def _of_class(model: type[BaseModel]) -> dict[str, Any]:
    """What tells the class apart in a file, such as ``kind``, where it must be written there: in Python the class says it."""
    known = {name: model.model_fields[name] for name in ("kind", "control") if name in model.model_fields}
    required = {name: field.annotation for name, field in known.items() if field.is_required()}
    words = {name: get_args(annotation) for name, annotation in required.items() if get_origin(annotation) is Literal}
    return {name: choices[0] for name, choices in words.items() if len(choices) == 1}


def _by_key(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """The fields that a caller may give, by the keys that they have in a file; the kind is that of the class."""
    left_out = {"kind", *_of_class(model)}
    return {field.alias or name: field for name, field in model.model_fields.items() if name not in left_out}


class _Fields:
    """The signature of a model as ``help`` shows it: its fields and their types without the machinery of pydantic."""

    def __get__(self, instance: object, model: type[BaseModel]) -> inspect.Signature:
        if instance is not None:
            raise AttributeError("__signature__")
        fields = _by_key(model)
        typed = SimpleNamespace(__annotations__={name: field.annotation for name, field in fields.items()})
        types = get_type_hints(typed)  # of which it leaves the annotations out, within others too
        empty = inspect.Parameter.empty
        return inspect.Signature(
            [
                inspect.Parameter(
                    f"{name}_" if keyword.iskeyword(name) else name,  # a signature takes no word of the language
                    inspect.Parameter.KEYWORD_ONLY,
                    default=empty if field.is_required() else field.get_default(call_default_factory=True),
                    annotation=types[name],
                )
                for name, field in fields.items()
            ]
        )


def _by_position(model: type[BaseModel], values: Sequence[Any]) -> dict[str, Any]:
    """The values of the first fields by their keys.

    Raises
    ------
    TypeError
        If they are too many, or if the first would fill an optional field though another is needed, as the bulk modulus of a
        rubber stands before its c10, which is meant.
    """
    fields = _by_key(model)
    needed = [key for key, field in fields.items() if field.is_required()]
    named = dict(zip(fields, values, strict=False))
    if needed and next(iter(fields)) not in needed:
        meant = ", ".join(_as_keyword(model, key, value) for key, value in zip(needed, values, strict=False))
        raise TypeError(f"{model.__name__} takes values by name, not by position; did you mean {meant}?")
    if len(named) < len(values):
        raise TypeError(f"{model.__name__} takes at most {len(named)} values by position, {len(values)} were given")
    return named


def _as_keyword(model: type[BaseModel], key: str, value: Any) -> str:
    """A value after its key, a number with a unit as it is without and with it."""
    unit = unit_at(model, {}, (key,))
    if not unit or isinstance(value, bool) or not isinstance(value, int | float):
        return f"{key}={shown(value)}"
    return f"{key}={value!r} in {unit} or {key}={written_quantity(float(value), unit)!r}"


class _MadeInPython(ModelMetaclass):
    """What is wrong with a value made in Python raises the message that a case file has for it; fields may go by position."""

    def __init__(cls, name: str, bases: tuple[type, ...], namespace: dict[str, Any], **options: Any):
        super().__init__(name, bases, namespace, **options)
        cls.__signature__ = _Fields()

    @property
    def __doc__(cls) -> str | None:
        """The docstring of the class and a section of its fields, as ``help`` shows it; its own text stands in its ``vars``."""
        text = vars(cls).get("__doc__")
        return None if text is None else with_fields(text, cls, _by_key(cls))  # type: ignore[arg-type]

    @__doc__.setter
    def __doc__(cls, text: str | None) -> None:
        type.__dict__["__doc__"].__set__(cls, text)

    def __call__(cls, *values: Any, **fields: Any) -> Any:
        named = _by_position(cls, values) if values else {}  # type: ignore[arg-type]
        for name, value in (named | fields).items():
            if isinstance(value, set | frozenset):
                raise InputError(f"{cls.__name__}: {name}: {shown(value)} has no order; expected a list")
        if twice := named.keys() & fields.keys():
            raise TypeError(f"{cls.__name__}: {', '.join(sorted(twice))} is given by position and by name")
        try:
            return super().__call__(**_of_class(cls) | _with_units(named | fields))  # type: ignore[arg-type]
        except ValidationError as error:
            refusals = refusals_of(error, written(named | fields), cls)  # type: ignore[arg-type]
            places = {".".join(map(str, path)): message for path, message in refusals.items()}
            lines = [": ".join(part for part in (cls.__name__, place, message) if part) for place, message in places.items()]
            raise Refused("\n".join(lines), error) from None


class FrozenModel(BaseModel, metaclass=_MadeInPython):
    """A closed, immutable value: unknown keys, NaN and later changes are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in type(self).model_fields:
            cls = type(self).__name__
            raise InputError(f"{cls}: {name} cannot be changed; another value has it: .model_copy(update={{{name!r}: ...}})")
        super().__setattr__(name, value)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """The same value with some of its fields changed, which are refused as where a value is made.

        Raises
        ------
        InputError
            If a field is unknown, or what is given for it is wrong.
        """
        if not update:
            return super().model_copy(deep=deep)
        keys = {name: field.alias or name for name, field in type(self).model_fields.items()}
        given = {keys[name]: getattr(self, name) for name in self.model_fields_set}
        return type(self)(**given | {keys.get(name, name): value for name, value in update.items()})


def _with_units(value: Any) -> Any:
    """A value from Python whose quantities of results are as `written`: no length is taken for a number without a unit."""
    if type(value) is dict:
        return {key: _with_units(item) for key, item in value.items()}
    if type(value) in (list, tuple):
        return type(value)(map(_with_units, value))
    measured = hasattr(value, "unit") and hasattr(value, "value") and not isinstance(value, BaseModel)
    return written(value) if measured and value.unit != "1" else value


def plain(value: Any) -> Any:
    """A value from Python as the plain data of a case file: as `written`, models as mappings and paths as text.

    Raises
    ------
    InputError
        If a case file has no form for it.
    """
    if isinstance(value, FrozenModel):
        return value.model_dump(mode="json", by_alias=True, context={"units": "written"})
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        return math.inf  # as in a file; JSON has no text for a number of thousands of digits
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    leaf = os.fspath(value) if isinstance(value, os.PathLike) else written(value)
    if leaf is not None and not isinstance(leaf, str | int | float | list):
        raise InputError(f"{shown(value)} cannot stand in a case; allowed: texts, numbers, quantities, lists, mappings and parts")
    return plain(leaf) if isinstance(leaf, list) else leaf


def check_increasing(**lists: Sequence[float]) -> None:
    """Check that every list increases strictly.

    Raises
    ------
    ValueError
        Naming the first that does not.
    """
    for name, values in lists.items():
        for place, (earlier, later) in enumerate(itertools.pairwise(values), 1):
            if later <= earlier:
                raise ValueError(f"{name} must increase: entry {place + 1} is not above entry {place}")
