"""The bases of every extension point: a complete subclass is registered by its ``kind`` as it is defined."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Self

from tactsim.errors import InvalidQuantity, shown
from tactsim.model import FrozenModel
from tactsim.registry import family, kind_class, kind_names, register


class Kind(FrozenModel, ABC):
    """A base of what is registered by its ``kind``."""

    package: ClassVar[str]
    """Where the kinds of an extension point stand; a subclass that names it is an extension point."""
    modules: ClassVar[str] = ".*"
    """Pattern of the names, within that package, of the modules that define kinds."""
    kind: str

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        super().__pydantic_init_subclass__(**options)
        for name, one in cls.model_fields.items():
            if one.annotation is float and isinstance(one.default, str):  # nothing reads it, and text goes where a number belongs
                raise InvalidQuantity(f"{cls.__name__}.{name}: the default {shown(one.default)} is text; needed: a number in SI")
        if "kind" in vars(cls).get("__annotations__", {}):
            register(cls)

    @classmethod
    def registered_as(cls, kind: Any) -> type[Self] | None:
        """The class of a kind if it is this class or extends it; None for any other and for a kind that is not known."""
        point = family(cls)
        known = kind_class(point, kind) if isinstance(kind, str) and kind in kind_names(point) else None
        return known if known is not None and issubclass(known, cls) else None

    def require_own_kind(self) -> None:
        """Refuse an instance whose class has the kind of its base, as which its case would be written and read again.

        Raises
        ------
        ValueError
            Naming both classes, and what the class lacks; pydantic adds the place.
        """
        cls = type(self)
        named = next(one for one in cls.__mro__ if "kind" in vars(one).get("__annotations__", {}))
        if named is not cls:
            own = cls.__name__.lower()
            borrowed = f"{cls.__name__} has the kind {self.kind!r} of {named.__name__}, as which a case would name it"
            raise ValueError(f"{borrowed}; needed: kind: Literal[{own!r}] = {own!r}")


class CaseKind(Kind):
    """What a case file names by its ``kind``."""

    @classmethod
    @abstractmethod
    def example(cls) -> Self:
        """A valid instance with values from its source; the contract tests start from it."""
