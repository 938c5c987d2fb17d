"""What looks wrong in a case, beside what its run refuses."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tactsim.errors import InputError


@contextmanager
def doubts_beside(doubts: Callable[[], list[str]]) -> Iterator[None]:
    """Puts ``doubts`` below what the block refuses, a line each: a block of metres for millimetres is refused for its mesh.

    Raises
    ------
    InputError
        What the block raised, with the doubts in its message.
    """
    try:
        yield
    except InputError as error:
        error.args = ("\n".join([str(error), *doubts()]), *error.args[1:])
        raise
