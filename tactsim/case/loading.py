"""From a case file to a validated case; every fault with its file, line and key."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tactsim.case.explaining import problems_of
from tactsim.case.model import SCHEMA, Case, any_experiment, case_class, experiment_class
from tactsim.case.of_result import case_of_result, is_result
from tactsim.case.overrides import apply_override, set_value
from tactsim.case.writing import case_document
from tactsim.case.yaml_reading import Document, Problem, YamlProblems, read_yaml
from tactsim.case.yaml_reading import Path as KeyPath
from tactsim.errors import CaseError, InputError, StorageError, UnknownName, shown, suggestion
from tactsim.interfaces import Experiment
from tactsim.model import plain
from tactsim.outside.files import LIMITS, TooLarge, Unreadable, named_path, opened
from tactsim.outside.text import counted, one_line
from tactsim.refusals import as_written
from tactsim.registry import kind_names
from tactsim.schema_of_model import value_at
from tactsim.shipped import CASES, case_path, shipped_name

LONGEST_MESSAGE = 2000
"""Characters of the words for one fault: a list of all that is allowed in its place may be long."""
MOST_PROBLEMS = 20
"""Faults that are listed; a file with more is of another kind, and the rest are counted."""
Place = Callable[[Problem], str]


KIND = "case file"
SWEEP_SCHEMA, SWEEP_SECTION = "tactsim/sweep/1", "sweep"
"""Schema of a sweep file, and its section that says how samples are drawn."""
SWEEPS = "tactsim/sweep/"
"""How the schema of a file begins that `tactsim sweep` reads."""
OF_PYTHON = "; a kind that is defined in Python is known in that process alone: load the case there with ts.load_case"
"""What may be wrong with a kind that is like none."""


Overrides = Sequence[str] | Mapping[str, Any]
"""``path.to.key=value`` as text, or key path -> value as a case file would hold it."""


def load_case(path: str | Path | Mapping[str, Any], overrides: Overrides = ()) -> Case:
    """The validated case in a file, of a result, of a shipped name such as ``annulus_icf``, or that a mapping describes.

    >>> import tactsim as ts
    >>> case = ts.load_case("annulus_icf", {"experiment.recess": "0.4 mm"})
    >>> case.experiment.recess  # m
    0.0004

    Parameters
    ----------
    path : of the file, which comes before a shipped case, or of the folder of a result, whose case it is with its overrides; or
        what such a file holds, ``{"schema": ..., "experiment": ...}``
    overrides : ``{"experiment.recess": "0.4 mm"}``, or text such as ``experiment.recess=0.4 mm``; validated like the file

    Raises
    ------
    CaseError
        With one line for every fault: the file, the line, the key path, the value, and what is allowed.
    StorageError
        If the file is missing or cannot be read.
    InputError
        If ``overrides`` are neither a mapping nor texts.
    """
    return validated_case(*read_document(path, overrides))


def read_document(
    path: str | Path | Mapping[str, Any], overrides: Overrides = (), *, option: str = "override"
) -> tuple[Document, Place]:
    """What a case says after the overrides, and how messages name its places; nothing is validated yet.

    An override is called as the ``option`` of the command that it was given to.

    Raises
    ------
    CaseError
        If the text is not YAML, not a mapping, or an override cannot be applied.
    StorageError
        If the file is missing or cannot be read.
    InputError
        If ``overrides`` are neither a mapping nor texts.
    """
    if isinstance(path, Mapping):
        path, document = "case", Document(plain(path))
    else:
        path = case_path(named_path(path, "a case"))
        document = Document(case_document(case_of_result(path))) if is_result(path) else _read_file(path)
    overridden: dict[KeyPath, str] = {}
    overrides = [overrides] if isinstance(overrides, str) else overrides
    if not isinstance(overrides, Mapping) and not (
        isinstance(overrides, list | tuple) and all(isinstance(one, str) for one in overrides)
    ):
        needed = "{'experiment.recess': '0.4 mm'}, or texts such as 'experiment.recess=0.4 mm'"
        raise InputError(f"overrides: {shown(overrides)}; needed: {needed}")
    given = overrides.items() if isinstance(overrides, Mapping) else ((override, None) for override in overrides)
    named = ((str(override), value) for override, value in given)
    for override, value in named:
        try:
            if isinstance(overrides, Mapping):
                key_path = set_value(document, override.split("."), plain(value))
            else:
                key_path = apply_override(document, override)
        except YamlProblems as error:
            raise case_error(error.problems, lambda _, text=override: f"{option} {one_line(text)}") from None  # type: ignore[misc]
        except InputError as error:
            raise CaseError(f"{option} {one_line(override)}: {error}") from None
        overridden[key_path] = f"{option} {override.partition('=')[0].strip()}"
    return document, place_in(path, overridden)


def _read_file(path: Path) -> Document:
    """What a case file says."""
    text = read_case_text(path)
    try:
        document = replace(read_yaml(text), folder=path.parent, first=_first_commands(text) if path.parent == CASES else "")
    except YamlProblems as error:
        raise case_error(error.problems, place_in(path, {})) from None
    if not isinstance(document.value, dict):
        content = "is empty" if document.value is None else f"holds {as_written(document.value)}"
        raise CaseError(f"{one_line(path)}: the file {content}; a case is a mapping that begins with 'schema: {SCHEMA}'")
    return document


def _first_commands(text: str) -> str:
    """The indented lines of the comment at the head of a case: commands that make what it reads."""
    head = itertools.takewhile(lambda line: line.startswith("#"), text.splitlines())
    return "\n".join(line[1:] for line in head if line.startswith("#   "))


def read_case_text(path: str | Path) -> str:
    """The UTF-8 text of a case file.

    Raises
    ------
    CaseError
        If it is too large or not UTF-8.
    StorageError
        If it is missing or cannot be read.
    """
    try:
        content = opened(path, KIND).read()
    except TooLarge:
        raise CaseError(f"{one_line(path)}: larger than {LIMITS[KIND]} bytes, which no case needs") from None
    except Unreadable as error:
        if os.path.isfile(os.path.join(path, "zarr.json")):
            show = f"tactsim show {one_line(path)} and tactsim data info {one_line(path)} say what it holds"
            raise StorageError(f"{one_line(path)} is a data set, not a case; {show}") from None
        if os.path.exists(path) or not (name := shipped_name(path)):
            raise
        raise StorageError(f"{error}; tactsim comes with a case of this name: write {name}, without folder and ending") from None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise CaseError(f"{one_line(path)}:{line}: byte {content[error.start]:#04x} is not UTF-8 text") from None


def validated_case(document: Document, place: Place) -> Case:
    """The case that a document describes; faults are named by ``place``.

    Raises
    ------
    CaseError
        With one line for every fault.
    StorageError
        If a file that its bodies come from is missing or damaged.
    """
    _check_version(document, place)
    problems = _kind_problems(document)
    experiment = document.value.get("experiment")
    model = case_class(Any if problems else any_experiment() if experiment is None else experiment_class(experiment["kind"]))
    try:
        # Strict JSON: a list may become a tuple, but neither true nor "3" becomes a number.
        context = {"units": "required", "folder": document.folder}
        case = model.model_validate_json(json.dumps(document.value), strict=True, context=context)
    except ValidationError as error:
        problems += problems_of(error, document, model)
    except InputError as error:
        problems.append(Problem(("experiment",), document.line(("experiment",)), str(error)))
    except Unreadable as error:
        raise Unreadable(in_words(_blamed_file(document, str(error)), place), error.reason) from None
    except StorageError as error:
        raise StorageError(in_words(_blamed_file(document, str(error)), place)) from None
    if problems:
        raise case_error(problems, place)
    return case


def _check_version(document: Document, place: Place) -> None:
    version, at = document.value.get("schema"), "schema"
    if version == SCHEMA and SWEEP_SECTION not in document.value:
        return
    if version == SCHEMA:
        at, message = SWEEP_SECTION, f"a case has no such section; a sweep begins with 'schema: {SWEEP_SCHEMA}'"
    elif "schema" not in document.value:
        message = f"missing; the file must begin with 'schema: {SCHEMA}'"
    else:
        message = f"the version {as_written(version)} is not supported; this tactsim reads {SCHEMA!r}"
        if str(version).startswith(SWEEPS):
            message = "this is a sweep of many cases; compute it with: tactsim sweep"
    raise case_error([Problem((at,), document.line((at,)), message)], place)


def _kind_problems(document: Document) -> list[Problem]:
    """What is wrong with the kind of the experiment; no module of another kind is loaded to list them."""
    if "experiment" not in document.value:
        return []
    experiment = document.value["experiment"]
    path: KeyPath = ("experiment",)
    if not isinstance(experiment, dict):
        message = f"{as_written(experiment)} is not a mapping with a 'kind'; {_choices()}"
    elif "kind" not in experiment:
        path, message = (*path, "kind"), f"missing; {_choices()}"
    else:
        kind = experiment["kind"]
        try:
            if isinstance(kind, str) and experiment_class(kind):
                return []
            unknown = ""
        except UnknownName:
            unknown = suggestion(kind, kind_names(Experiment))
        path, message = (*path, "kind"), f"unknown kind {as_written(kind)}{unknown}; {_choices()}{'' if unknown else OF_PYTHON}"
    return [Problem(path, document.line(path), message)]


def _blamed_file(document: Document, message: str) -> Problem:
    """A file that cannot be read, at the key that names it."""
    paths = {key: str(value_at(document.value, key)) for key in document.lines if key[-1:] == ("path",)}
    named = [key for key, path in paths.items() if path in message]
    key = max(named, key=lambda one: len(paths[one]), default=("experiment",))  # one path may be part of another
    return Problem(key, document.line(key), message)


def _choices() -> str:
    return f"choices: {', '.join(kind_names(Experiment))}"


def place_in(path: str | Path, overridden: Mapping[KeyPath, str]) -> Place:
    """Names the place of a problem: the override that set the value, such as ``override experiment.recess``, or file and line."""

    def place(problem: Problem) -> str:
        for length in range(len(problem.path), 0, -1):
            if problem.path[:length] in overridden:
                return overridden[problem.path[:length]]
        return f"{one_line(path)}:{problem.line}" if problem.line else one_line(path)

    return place


def in_words(problem: Problem, place: Place) -> str:
    """A problem after its place and its key path."""
    where, key = place(problem), one_line(".".join(map(str, problem.path)))
    return ": ".join(part for part in (where, "" if where.rpartition(" ")[2] == key else key, problem.message) if part)


def case_error(problems: Sequence[Problem], place: Place) -> CaseError:
    """One error with a line for each problem, in the order of the file."""
    short = [replace(one, message=one_line(one.message, LONGEST_MESSAGE)) for one in sorted(problems, key=lambda one: one.line)]
    lines = list(dict.fromkeys(in_words(problem, place) for problem in short))
    if (more := len(lines) - MOST_PROBLEMS) > 0:
        lines[MOST_PROBLEMS:] = [f"and {counted(more, 'more fault')}"]
    return CaseError("\n".join(lines))
