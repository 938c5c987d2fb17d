"""What looks wrong in a case, beside what its run refuses."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from tactsim.errors import InputError
from tactsim.results.checked import checked_texts


class Doubted(Protocol):
    """What says of itself what looks wrong in it, as `Runnable.doubts` does."""

    def doubts(self) -> list[str]:
        """One text for each doubt."""


def doubts_of(experiment: Doubted) -> tuple[str, ...]:
    """What looks wrong in an experiment, one text for each doubt; a single text is one doubt.

    Raises
    ------
    InvalidQuantity
        If its ``doubts`` returns anything else than texts.
    """
    return checked_texts(experiment.doubts(), f"doubts of {type(experiment).__name__}")


@contextmanager
def doubts_beside(experiment: Doubted) -> Iterator[None]:
    """Puts the doubts of an experiment below what the block refuses, a line each: a block of metres for millimetres is refused
    for its mesh.

    Raises
    ------
    InputError
        What the block raised, with the doubts in its message.
    """
    try:
        yield
    except InputError as error:
        error.args = ("\n".join([str(error), *doubts_of(experiment)]), *error.args[1:])
        raise
