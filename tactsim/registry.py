"""Every class of an extension point by its ``kind``, found in its package or defined elsewhere; nothing is listed."""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, PydanticCustomError, PydanticKnownError, core_schema

from tactsim.errors import AmbiguousKind, IncompleteKind, UnknownName
from tactsim.kinds_in_source import kinds_in_source, load_all, module_names
from tactsim.marked_functions import forget_function

_registered: dict[type, dict[str, Any]] = {}
"""Extension point -> ``kind`` -> class; filled by `register`, which every concrete subclass calls as it is defined."""


def register(cls: Any) -> None:
    """Make a complete class known by its ``kind``; one defined again in the same module takes the place of the earlier one.

    An incomplete one takes it too, so that nobody computes with the earlier one: its kind is then refused.

    Raises
    ------
    AmbiguousKind
        If another class has that kind, naming both modules.
    """
    known = _registered.setdefault(family(cls), {})
    kind = cls.model_fields["kind"].default
    other = known.get(kind, cls)
    again = (other.__module__, other.__qualname__) == (cls.__module__, cls.__qualname__)
    if lacking(cls):
        if again:
            known.pop(kind, None)
        return
    if not again:
        raise AmbiguousKind(
            f"two {_in_words(family(cls))} kinds are called {kind!r}: "
            f"{other.__module__}.{other.__qualname__} and {cls.__module__}.{cls.__qualname__}; give one of them another kind"
        )
    known[kind] = cls


def lacking(cls: Any) -> list[str]:
    """Methods and class variables that its extension point demands and a class lacks."""
    return sorted({*cls.__abstractmethods__, *(name for name in cls.__class_vars__ if not hasattr(cls, name))})


def _in_words(point: Any) -> str:
    """What messages call an extension point, such as a contact law."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", point.__name__).lower()


def forget(thing: Any) -> None:
    """Remove a registered class or a marked function, such as one that a test or a notebook defined."""
    if not isinstance(thing, type):
        return forget_function(thing)
    cls: Any = thing
    known, kind = _registered.get(family(cls), {}), cls.model_fields["kind"].default
    if kind in known and known[kind] is cls:
        del known[kind]


def registered_outside(package: str) -> list[Any]:
    """The registered classes that are defined outside a package, such as those of a notebook."""
    return [cls for known in _registered.values() for cls in known.values() if cls.__module__.partition(".")[0] != package]


def kinds_outside(package: str) -> dict[str, str]:
    """Kind -> name of the class that is defined outside a package; without kinds that a class of the package has too."""
    outside = registered_outside(package)
    own = {kind for known in _registered.values() for kind, cls in known.items() if cls not in outside}
    named = {cls.model_fields["kind"].default: cls.__name__ for cls in outside}
    return {kind: name for kind, name in named.items() if kind not in own}


def family(cls: Any) -> Any:
    """The extension point that a class extends: the nearest base that names the package where its kinds stand."""
    return next(base for base in cls.__mro__ if "package" in vars(base))


def kind_names(base: Any) -> list[str]:
    """Kinds registered for an extension point, and those that the source of its modules names; loads none of these."""
    return sorted({*_registered.get(base, {}), *kinds_in_source(module_names(base.package, base.modules), base.__name__)})


def kinds(base: Any) -> dict[str, Any]:
    """``kind`` -> class of everything registered for an extension point, sorted by kind."""
    load_all(base.package, base.modules)
    return dict(sorted(_registered.get(base, {}).items()))


def kind_class(base: Any, kind: str) -> Any:
    """The class registered as ``kind``; of the package only the modules that bear its name or state it are loaded.

    Raises
    ------
    AmbiguousKind
        If another class has that kind, too.
    UnknownName, IncompleteKind
        With the nearest registered kind; with what the class of this kind lacks.
    """
    _load_named(base, kind)
    if kind in _registered.get(base, {}):
        return _registered[base][kind]
    what = f"{_in_words(base)} kind"
    for cls in _below(base):
        if cls.model_fields["kind"].default == kind and (missing := lacking(cls)):
            raise IncompleteKind(what, kind, cls, missing)
    raise UnknownName(what, kind, kind_names(base))


def _below(base: Any) -> list[Any]:
    return [one for cls in base.__subclasses__() for one in (cls, *_below(cls))]


@cache
def _load_named(base: Any, kind: str) -> None:
    """Load the modules that bear the name of a kind or whose source states it: two are found here, not when all are listed."""
    names = module_names(base.package, base.modules)
    stating = kinds_in_source(names, base.__name__).get(kind, ())
    for name in names:
        if name in stating or name.rpartition(".")[2] == kind:
            importlib.import_module(name)


class Registered:
    """Annotation of a field that takes every registered kind of an extension point, also those defined after the field's class.

    Parameters
    ----------
    base : the extension point
    fits : which of its classes the field takes; all by default
    default : the kind that is meant if a mapping names none; None demands it
    unfit : what is wrong with a registered kind that does not fit, as the end of a sentence that begins with the kind
    """

    def __init__(
        self, base: Any, fits: Callable[[Any], bool] = lambda cls: True, *, default: str | None = None, unfit: str | None = None
    ):
        self.base, self.fits, self.default, self.unfit = base, fits, default, unfit

    def kinds(self) -> dict[str, Any]:
        """``kind`` -> class of what the field takes."""
        return {kind: cls for kind, cls in kinds(self.base).items() if self.fits(cls)}

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """The instance that a mapping describes; an instance passes as it is.

        Raises
        ------
        PydanticKnownError, PydanticCustomError
            If it is no mapping, has no kind, or one that the field does not take.
        ValueError
            If it is an instance with the kind of another class.
        """
        if isinstance(value, self.base):
            self._class(value.kind)
            value.require_own_kind()
            return value
        if not isinstance(value, Mapping):
            raise PydanticKnownError("model_attributes_type")
        if "kind" not in value and self.default is None:
            raise PydanticKnownError("union_tag_not_found", {"discriminator": "'kind'"})
        cls = self._class(value.get("kind", self.default))
        if info.mode == "json":
            return cls.model_validate_json(json.dumps(value), strict=True, context=info.context)
        return cls.model_validate(value, context=info.context)

    def class_of(self, kind: str) -> Any:
        """The class of a kind, as `kind_class`; a subclass may look elsewhere.

        Raises
        ------
        AmbiguousKind, UnknownName, IncompleteKind
            As `kind_class`.
        """
        return kind_class(self.base, kind)

    def _class(self, kind: Any) -> Any:
        try:
            cls = self.class_of(kind) if isinstance(kind, str) else None
        except UnknownName:
            cls = None
        if cls is not None and not self.fits(cls) and self.unfit is not None:
            message = f"{kind} {self.unfit}; allowed: {', '.join(self.kinds())}"
            raise PydanticCustomError("unfit_kind", "{message}", {"message": message})
        if cls is None or not self.fits(cls):
            known = ", ".join(f"'{name}'" for name in self.kinds())
            raise PydanticKnownError("union_tag_invalid", {"discriminator": "'kind'", "tag": str(kind), "expected_tags": known})
        return cls

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = core_schema.plain_serializer_function_ser_schema(
            lambda value, info: value.model_dump(mode=info.mode, by_alias=info.by_alias, context=info.context), info_arg=True
        )
        return core_schema.with_info_plain_validator_function(self.read, serialization=written)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        choices = {kind: _named_schema(cls) for kind, cls in self.kinds().items()}
        if self.default is not None:
            meant, others = handler(choices.pop(self.default)), [handler(schema) for schema in choices.values()]
            return {"oneOf": [meant, *({"allOf": [one], "required": ["kind"]} for one in others)]} if others else meant
        return handler(core_schema.tagged_union_schema(choices, discriminator="kind"))


def _named_schema(cls: Any) -> Any:
    """The schema of a class with a name, so that the JSON Schema describes the class once."""
    schema = cls.__pydantic_core_schema__
    return schema if "ref" in schema else {**schema, "ref": f"{cls.__module__}.{cls.__qualname__}:{id(cls)}"}


def shipped(what: str, name: str, library: Mapping[str, Any]) -> Any:
    """The shipped set of this name; ``what`` is what a set is called in messages.

    Raises
    ------
    UnknownName
        With the nearest name.
    """
    if not isinstance(name, str) or name not in library:
        raise UnknownName(what, name, library)
    return library[name]


class Named:
    """Annotation that lets a field take the name of a shipped set beside the set itself, in files and in the JSON Schema.

    Parameters
    ----------
    what : what a set is called in messages
    library : gives the shipped sets by name; called when a name is read, so that it may be defined after the field's class
    """

    def __init__(self, what: str, library: Callable[[], Mapping[str, Any]]):
        self.what, self.library = what, library

    def read(self, value: Any) -> Any:
        """The shipped set of this name; anything but text passes.

        Raises
        ------
        PydanticCustomError
            If no shipped set has this name, with the nearest one.
        """
        if not isinstance(value, str):
            return value
        try:
            return shipped(self.what, value, self.library())
        except UnknownName as error:
            raise PydanticCustomError("unknown_name", "{message}", {"message": str(error)}) from None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        name = {"type": "string", "enum": sorted(self.library()), "description": f"Name of a shipped {self.what}."}
        return {"oneOf": [name, handler(schema)]}
