"""Calls of marked functions as tables write them, ``{kind: NAME, argument: value}``: closed models made from the signatures."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any, ClassVar, Literal, Self, get_type_hints

from pydantic import Field, ValidationInfo, create_model, model_validator
from pydantic_core import PydanticCustomError

from tactsim.errors import IncompleteInstallation, InputError
from tactsim.marked_functions import MarkedFunction, marked_function, marked_names
from tactsim.model import FrozenModel
from tactsim.registry import Registered
from tactsim.validation.inputs import Inputs

PACKAGE = "tactsim.validation.quantities"
INPUTS = "inputs"
"""Parameter that receives the inputs; all others are arguments."""
NEEDED = "it needs a type, a name other than 'kind', and must be passed by its name"


class Call(FrozenModel):
    """A marked function with its arguments; calling it with the inputs computes what the function returns."""

    marked: ClassVar[MarkedFunction]
    kind: str
    """Name of the function."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.marked.check is not None:
            self._apply(self.marked.check)
        return self

    @property
    def result_unit(self) -> str:
        """SI unit of the number."""
        unit = self.marked.unit
        return unit if isinstance(unit, str) else self._apply(unit)

    def __call__(self, inputs: Inputs) -> Any:
        """The number in SI, or the plain data of a figure with a ``form`` that says how it is drawn.

        Raises
        ------
        TactsimError
            If it cannot be computed.
        """
        return self._apply(self.marked.function, inputs)

    def _apply(self, function: Callable[..., Any], inputs: Inputs | None = None) -> Any:
        """What a function returns for those of the arguments that it names."""
        return function(
            **{name: inputs if name == INPUTS else getattr(self, name) for name in inspect.signature(function).parameters}
        )


class AnyCall(Registered):
    """Annotation of a field that takes a call of every marked function of a family, ``quantity`` or ``drawing``."""

    def __init__(self, family: str):
        super().__init__(Call)
        self.family = family

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """As `Registered.read`; what already is a call stays as it is."""
        return value if isinstance(value, Call) else super().read(value, info)

    def kinds(self) -> dict[str, Any]:
        """Name -> calls of the functions whose modules can be loaded.

        Raises
        ------
        InputError
            If a parameter of a function has no type or cannot be passed by its name.
        """
        calls = {}
        for name in marked_names(PACKAGE, self.family):
            with suppress(IncompleteInstallation):
                calls[name] = self._called(name)
        return calls

    def class_of(self, kind: str) -> type[Call]:
        """The calls of the function of this name; of the package, only the modules that state it are loaded.

        Raises
        ------
        UnknownName, PydanticCustomError
            If there is none; if the module that states it needs one that is not there.
        AmbiguousKind, InputError
            If two modules mark it; if its signature does not say what a table may write.
        """
        try:
            return self._called(kind)
        except IncompleteInstallation as error:
            raise PydanticCustomError("incomplete_installation", "{message}", {"message": str(error)}) from None

    def _called(self, name: str) -> type[Call]:
        return call_class(marked_function(PACKAGE, self.family, name))


@cache
def call_class(marked: MarkedFunction) -> type[Call]:
    """The calls of a function: its arguments with the types and defaults of the signature and the descriptions of the docstring.

    Raises
    ------
    InputError
        If a parameter has no type or cannot be passed by its name.
    """
    types = get_type_hints(marked.function, include_extras=True)
    described: dict[str, Any] = descriptions(marked.function)
    fields: dict[str, Any] = {"kind": (Literal[marked.name], marked.name)}
    for name, parameter in inspect.signature(marked.function).parameters.items():
        if name == INPUTS:
            continue
        by_name = parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
        if name not in types or name in fields or not by_name:
            raise InputError(
                f"{marked.family} {marked.name} of {marked.module}: a table cannot write the argument {name}; {NEEDED}"
            )
        default = ... if parameter.default is parameter.empty else parameter.default
        description = {"description": described[name]} if name in described else {}
        fields[name] = (types[name], Field(default, **description))
    model = create_model(marked.name, __base__=Call, __module__=marked.module, __doc__=marked.function.__doc__, **fields)
    model.marked = marked
    return model


def descriptions(function: Callable[..., Any]) -> dict[str, str]:
    """Argument -> description under ``Parameters`` in a docstring, whose lines read ``name : text`` or ``name, name : text``."""
    section = re.search(r"^Parameters\n-+\n((?:.+\n?)+)", inspect.getdoc(function) or "", re.MULTILINE)
    entries = re.findall(r"^(\w+(?:, \w+)*) : (.+(?:\n +.+)*)", section[1] if section else "", re.MULTILINE)
    return {name: " ".join(text.split()) for names, text in entries for name in names.split(", ")}
