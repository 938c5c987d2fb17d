"""Safe reading of YAML: plain values with the line of each key; nothing is executed, nothing grows without limit."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from tactsim.errors import CaseError, shown
from tactsim.schema_of_model import Path

_STANDARD_TAG = "tag:yaml.org,2002:"
LARGEST_DEPTH = 40
LARGEST_COUNT = 100_000
"""Values in one file, each use of an alias counted in full."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong: where (key path and line, line 0 for the whole file) and what."""

    path: Path
    line: int
    message: str


class YamlProblems(CaseError):
    """The text cannot be used; ``problems`` says why."""

    def __init__(self, *problems: Problem):
        super().__init__("; ".join(problem.message for problem in problems))
        self.problems = problems


@dataclass
class Document:
    """The plain value of a YAML text and the line on which each key path stands."""

    value: Any = None
    lines: dict[Path, int] = field(default_factory=dict)
    folder: FilePath | None = None
    """Folder of the file, in which the files that it names are looked for first."""
    first: str = ""
    """Commands to run before a shipped case, which make what it reads."""

    def line(self, path: Path) -> int:
        """The line of the key path, or of the nearest enclosing key that the text holds."""
        while path and path not in self.lines:
            path = path[:-1]
        return self.lines.get(path, 0)


def read_yaml(text: str) -> Document:
    """The value of a YAML 1.2 text (core schema) with line numbers.

    Raises
    ------
    YamlProblems
        For broken syntax, a tag, a repeated key, a number that is not finite, or too many or too deeply nested values.
    """
    return _composed(_Composer(text))


def first_values(text: str, *wanted: Path) -> dict[Path, Any]:
    """The scalars at these key paths, of a text that is read no further than to the last of them; those that it has.

    Raises
    ------
    YamlProblems
        As `read_yaml`, for what is read.
    """
    seeker = _Seeker(text, wanted)
    with suppress(_AllFound):
        _composed(seeker)
    return seeker.values


def _composed(composer: _Composer) -> Document:
    """What a composer makes of its text; raises as `read_yaml` says."""
    try:
        return composer.document()
    except MarkedYAMLError as error:
        raise YamlProblems(_syntax_problem(error)) from None
    except YAMLError as error:
        raise YamlProblems(Problem((), 0, f"not valid YAML: {str(error).splitlines()[0]}")) from None
    except (ValueError, LookupError, AttributeError, TypeError, ArithmeticError, AssertionError, RecursionError):
        raise YamlProblems(Problem((), 0, "not valid YAML")) from None


def _syntax_problem(error: MarkedYAMLError) -> Problem:
    """What the parser stumbled over, and where what it was reading began: a quote or a bracket is missed only lines later."""
    mark, begin = error.problem_mark or error.context_mark, error.context_mark
    if "'\\t'" in (error.problem or ""):
        return Problem((), mark.line + 1, "not valid YAML: a tab; write spaces, as many as its neighbours have")
    since = f" (begun on line {begin.line + 1})" if mark and begin and begin.line < mark.line else ""
    what = " ".join(part for part in (error.context and f"{error.context}{since}", error.problem) if part)
    before = "" if since else "; the slip may be on the line before"
    words = f"not valid YAML: {what}; a line is 'key: value', indented as its neighbours{before}"
    return Problem((), mark.line + 1 if mark else 0, words)


class _Composer:
    """Builds plain values from the parser's events, refusing what a case file has no use for."""

    def __init__(self, text: str):
        self.events: Iterator[Any] = YAML(typ="safe", pure=True).parse(text)
        self.lines: dict[Path, int] = {}
        self.problems: list[Problem] = []
        self.anchors: dict[str, tuple[Any, int]] = {}
        self.count = 0

    def document(self) -> Document:
        """The only document of the stream."""
        value, started = None, False
        for event in self.events:
            if isinstance(event, DocumentStartEvent) and started:
                raise YamlProblems(Problem((), _line(event), "a second document starts here; one file holds one document"))
            started = started or isinstance(event, DocumentStartEvent)
            if isinstance(event, ScalarEvent | SequenceStartEvent | MappingStartEvent | AliasEvent):
                value = self._node(event, ())
        if self.problems:
            raise YamlProblems(*self.problems)
        return Document(value, self.lines)

    def _node(self, event: Any, path: Path) -> Any:
        before = self.count
        self._count(event, path, 1)
        self.lines.setdefault(path, _line(event))
        if isinstance(event, AliasEvent):
            return self._alias(event, path)
        if event.tag is not None:
            self._problem(
                event, path, f"the tag {shown(str(event.tag).replace(_STANDARD_TAG, '!!'))} is not allowed; write plain values"
            )
        value = self._content(event, path)
        if event.anchor is not None:
            self.anchors[event.anchor] = value, self.count - before
        return value

    def _content(self, event: Any, path: Path) -> Any:
        if isinstance(event, MappingStartEvent):
            return self._mapping(path)
        return self._sequence(path) if isinstance(event, SequenceStartEvent) else self._scalar(event, path)

    def _mapping(self, path: Path) -> dict[str, Any]:
        value: dict[str, Any] = {}
        for event in self.events:
            if isinstance(event, MappingEndEvent):
                break
            key = event.value if isinstance(event, ScalarEvent) else ""
            place = (*path, key)
            if not key or event.tag is not None or not _is_text(key):
                self._problem(event, path, "a key must be plain text")
            elif key in value:
                self._problem(event, place, f"repeated key; it stands already on line {self.lines[place]}")
            else:
                self.lines[place] = _line(event)
            if not isinstance(event, ScalarEvent):
                self._node(event, place)
            value[key] = self._node(next(self.events), place)
        return value

    def _sequence(self, path: Path) -> list[Any]:
        value: list[Any] = []
        for event in self.events:
            if isinstance(event, SequenceEndEvent):
                break
            value.append(self._node(event, (*path, len(value))))
        return value

    def _scalar(self, event: ScalarEvent, path: Path) -> Any:
        if not _is_text(event.value):
            self._problem(event, path, f"{shown(event.value)} is not valid Unicode")
        if event.style is not None:
            return event.value
        value = plain_scalar(event.value)
        if isinstance(value, int | float) and (not math.isfinite(value) or abs(value) > 1e300):
            self._problem(event, path, f"{shown(event.value)} is not a finite number")
            return 0
        return value

    def _alias(self, event: AliasEvent, path: Path) -> Any:
        if event.anchor not in self.anchors:
            raise YamlProblems(Problem(path, _line(event), f"the alias {shown(event.anchor)} is not defined above"))
        value, size = self.anchors[event.anchor]
        self._count(event, path, size)
        return _copied(value)

    def _count(self, event: Any, path: Path, amount: int) -> None:
        self.count += amount
        if self.count > LARGEST_COUNT:
            raise YamlProblems(Problem(path, _line(event), f"more than {LARGEST_COUNT} values, aliases counted in full"))
        if len(path) > LARGEST_DEPTH:
            raise YamlProblems(Problem((), _line(event), f"nested more than {LARGEST_DEPTH} levels deep"))

    def _problem(self, event: Any, path: Path, message: str) -> None:
        self.problems.append(Problem(path, _line(event), message))


class _AllFound(Exception):
    """Nothing more is wanted of a text."""


class _Seeker(_Composer):
    """Stops once it has the scalars at all key paths that are wanted."""

    def __init__(self, text: str, wanted: Sequence[Path]):
        super().__init__(text)
        self._wanted = set(wanted)
        self.values: dict[Path, Any] = {}

    def _scalar(self, event: ScalarEvent, path: Path) -> Any:
        value = super()._scalar(event, path)
        if path in self._wanted:
            self.values[path] = value
            if len(self.values) == len(self._wanted):
                raise _AllFound
        return value


_INTEGER = re.compile(r"[-+]?[0-9]+", re.ASCII)
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", re.ASCII)
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_WORDS: dict[str, bool | None] = {"": None, "~": None, "null": None, "Null": None, "NULL": None}
_WORDS |= {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}


def plain_scalar(text: str) -> Any:
    """The value of an unquoted scalar in the YAML 1.2 core schema, without its hexadecimal and octal integers."""
    if text in _WORDS:
        return _WORDS[text]
    if _NOT_FINITE.fullmatch(text):
        return math.nan
    if _INTEGER.fullmatch(text):
        return int(text) if len(text) <= 300 else math.inf
    return float(text) if _FLOAT.fullmatch(text) else text


def _is_text(value: str) -> bool:
    return not any("\ud800" <= character <= "\udfff" for character in value)


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1


def _copied(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copied(item) for key, item in value.items()}
    return [_copied(item) for item in value] if isinstance(value, list) else value
