"""What an open page may say to the server: one closed form for every command, bounded, and one reader for all of them."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from tactsim.errors import InputError
from tactsim.model import FrozenModel
from tactsim.refusals import first_fault
from tactsim.results.document import Name

MOST_STEPS = 10**9
"""Largest number of a step or a sample: no recording or data set is as long."""
Number = Annotated[int, Field(ge=0, le=MOST_STEPS)]


class _Command(FrozenModel):
    model_config = ConfigDict(strict=True)


class Drawn(_Command):
    """A frame was drawn."""

    do: Literal["drawn"]


class Play(_Command):
    """The recording moves on by the clock."""

    do: Literal["play"]


class Pause(_Command):
    """The recording stands still."""

    do: Literal["pause"]


class Show(_Command):
    """The recording stands at a step."""

    do: Literal["show"]
    step: Number


class Cancel(_Command):
    """The estimate that is being computed is not wanted."""

    do: Literal["cancel"]


class EstimateNow(_Command):
    """An estimate of what is shown is wanted, after it was cancelled."""

    do: Literal["estimate"]


class ChooseEstimator(_Command):
    """Another estimator."""

    do: Literal["estimator"]
    name: Name


class ChooseSource(_Command):
    """Other forces."""

    do: Literal["source"]
    name: Name


class ChooseSample(_Command):
    """A sample by its number, or the one after or before this one."""

    do: Literal["sample"]
    number: Number | None = None
    move: Literal[1, -1] | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.number is None) == (self.move is None):
            raise ValueError("needed: either number or move")
        return self


class FilterSamples(_Command):
    """Samples of a split and a status only; empty text lets all through."""

    do: Literal["filter"]
    split: Name = ""
    status: Name = ""


Choosing = ChooseEstimator | ChooseSource | ChooseSample | FilterSamples
Command = Drawn | Play | Pause | Show | Cancel | EstimateNow | Choosing
UNKNOWN = ("union_tag_invalid", "union_tag_not_found", "model_attributes_type", "dict_type", "model_type")
"""Kinds of pydantic's errors for something that is no known command at all."""
_COMMANDS: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="do")])


def read_command(text: str | bytes) -> Command:
    """The command in the text of a message.

    Raises
    ------
    InputError
        If it is none; with what is wrong.
    """
    if isinstance(text, bytes):
        raise InputError("a command must be a text message")
    try:
        return _COMMANDS.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        if first["type"] in UNKNOWN:
            raise InputError("the page sent a command that this server does not know; load it anew") from None
        raise InputError(f"a command could not be read: {first_fault(error)}") from None
