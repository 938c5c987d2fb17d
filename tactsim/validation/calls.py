"""Calls of marked functions as tables write them, ``{kind: NAME, argument: value}``: closed models made from the signatures."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from functools import cache
from typing import Annotated, Any, ClassVar, Literal, Self, Union, get_type_hints

from pydantic import Field, create_model, model_validator

from tactsim.errors import InputError
from tactsim.model import FrozenModel
from tactsim.registry import MarkedFunction, marked_functions
from tactsim.validation.inputs import Inputs

PACKAGE = "tactsim.validation.quantities"
INPUTS = "inputs"
"""Parameter that receives the inputs; all others are arguments."""
NEEDED = "it needs a type, a name other than 'kind', and must be passed by its name"


class Call(FrozenModel):
    """A marked function with its arguments; to call it with the inputs computes what it returns."""

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


def callable_now(family: str) -> tuple[MarkedFunction, ...]:
    """The functions of a family, ``quantity`` or ``drawing``, that a table may call.

    Raises
    ------
    InputError
        If functions of two modules have the same name.
    """
    return tuple(marked_functions(PACKAGE, family).values())


def any_call(functions: Iterable[MarkedFunction]) -> Any:
    """The type of the calls of these functions, distinguished by ``kind``.

    Raises
    ------
    InputError
        If a signature does not say what a table may write.
    """
    return _union_of({marked.name: call_class(marked) for marked in functions})


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


def _union_of(known: dict[str, Any]) -> Any:
    """Pydantic type of these classes, told apart by ``kind``."""
    choices = tuple(known[kind] for kind in sorted(known))
    return choices[0] if len(choices) == 1 else Annotated[Union[choices], Field(discriminator="kind")]  # noqa: UP007
