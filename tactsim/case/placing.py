"""Where in a case stands what its run refuses: the mesh and all else that no schema can judge."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from tactsim.case.loading import Place
from tactsim.case.model import Case
from tactsim.case.yaml_reading import Document, Problem
from tactsim.errors import CaseError, InputError

_KEY_PATH = re.compile(r"(?P<key>[a-z]\w*)(?P<within>(\.\w+)*)(?=(?P<colon>:)?)")


@contextmanager
def placed(case: Case, document: Document, place: Place) -> Iterator[None]:
    """Names file and line before each line of what the block refuses that begins with a key path of the experiment.

    Raises
    ------
    InputError
        What the block raised, with the places in its message.
    """
    try:
        yield
    except CaseError:
        raise  # it names its places itself
    except InputError as error:
        lines = [_placed(line, case, document, place) for line in str(error).split("\n")]
        error.args = ("\n".join(lines), *error.args[1:])
        raise


def _placed(line: str, case: Case, document: Document, place: Place) -> str:
    """A line of a message, after its place in the case if it begins with a key path; a single word is one before a colon."""
    named = _KEY_PATH.match(line)
    if named is None or named["key"] not in type(case.experiment).model_fields or not (named["within"] or named["colon"]):
        return line
    path = ("experiment", named["key"], *named["within"].split(".")[1:])
    return f"{place(Problem(path, document.line(path), line))}: experiment.{line}"
