"""A sweep: a case in which places vary, read from a file or from the text that workers are given."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path as FilePath
from typing import Any, TypeVar

from pydantic import ValidationError

from tactsim.case.explaining import problems_of
from tactsim.case.loading import SWEEP_SCHEMA, SWEEP_SECTION, case_error, read_document
from tactsim.case.loading import Place as Where
from tactsim.case.model import SCHEMA as CASE_SCHEMA
from tactsim.case.yaml_reading import Document, Path, Problem, YamlProblems
from tactsim.dataset.sampling.places import Place, places_of, sizes_of
from tactsim.dataset.sampling.settings import LICENCE, OF_THE_CARD, SweepSettings
from tactsim.dataset.store.arrays import MOST_SAMPLES
from tactsim.errors import CaseError, suggestion
from tactsim.refusals import as_written
from tactsim.schema_of_model import value_at

Read = TypeVar("Read")


@dataclass(frozen=True, eq=False)
class Sweep:
    """``document`` is the case without the section, with distributions in it."""

    document: Document
    where: Where
    settings: SweepSettings
    samples: int
    per_specimen: int
    specimen_places: tuple[Place, ...]
    """Drawn once per specimen."""
    sample_places: tuple[Place, ...]
    """Drawn for each sample of a specimen."""
    checked: bool = False
    """Whether its distributions were checked against their places before, as were those of a text that `Sweep.text` wrote."""

    @property
    def places(self) -> tuple[Place, ...]:
        """All places."""
        return self.specimen_places + self.sample_places

    @property
    def kind(self) -> str:
        """Kind of the experiment, empty if it is missing."""
        experiment = self.document.value.get("experiment")
        return str(experiment.get("kind", "")) if isinstance(experiment, dict) else ""

    @cached_property
    def text(self) -> str:
        """The whole sweep as canonical JSON; `sweep_of_text` reads it."""
        section = self.settings.model_dump(mode="json") | {"samples": self.samples}
        if section["license"] == LICENCE:
            del section["license"]  # so that the text of stores from before there was the key is the same
        return json.dumps(
            {**self.document.value, "schema": SWEEP_SCHEMA, SWEEP_SECTION: section}, sort_keys=True, allow_nan=False
        )

    @property
    def folder(self) -> str | None:
        """Folder of the file, in which the files that it names are looked for first; no part of the identity."""
        return None if self.document.folder is None else os.path.abspath(self.document.folder)

    @property
    def identity(self) -> str:
        """Sixteen hexadecimal digits that say which data the sweep makes; of designs that go on, for any number of samples.

        What the card says, and how long a sample may take, make no other data.
        """
        content = deciding(json.loads(self.text))
        if self.extendable:
            content[SWEEP_SECTION].pop("samples")
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]

    def error(self, path: Path, message: str) -> CaseError:
        """An error at a key path of the file, with its line."""
        return self.errors([Problem(path, 0, message)])

    def placed(self, error: CaseError) -> CaseError:
        """An error whose message begins with a key path of the section, with file and line before it."""
        key, _, message = str(error).partition(": ")
        return self.error(tuple(key.split(".")), message) if key.startswith(f"{SWEEP_SECTION}.") else error

    def errors(self, problems: list[Problem]) -> CaseError:
        """An error of a line for each problem of the file; their lines are looked up."""
        return case_error([replace(one, line=self.document.line(one.path)) for one in problems], self.where)

    @property
    def extendable(self) -> bool:
        """Whether adding samples leaves the earlier ones unchanged."""
        return self.settings.design in ("sobol", "random")


def deciding(content: dict[str, Any]) -> dict[str, Any]:
    """The plain content of a sweep without what makes no other data."""
    section = content.get(SWEEP_SECTION)
    if isinstance(section, dict):
        section = {key: value for key, value in section.items() if key not in (*OF_THE_CARD, "time_limit")}
    return {key: value for key, value in content.items() if key != "title"} | {SWEEP_SECTION: section}


def load_sweep(
    path: str | FilePath, overrides: tuple[str, ...] = (), samples: int | None = None, *, option: str = "override"
) -> Sweep:
    """The sweep in a file, after the overrides ``path.to.key=value``; ``samples`` replaces that of the file.

    Raises
    ------
    CaseError
        With one line for every fault: the file, the line, the key path, the value, and what is allowed.
    StorageError
        If the file is missing or cannot be read.
    """
    return sweep_of_document(*read_document(path, overrides, option=option), samples)


def sweep_of_document(
    document: Document, where: Where = lambda problem: "", samples: int | None = None, *, checked: bool = False
) -> Sweep:
    """The sweep that a mapping describes, of Python or of the file that ``where`` names; ``samples`` replaces its own.

    One that is ``checked`` was once read and written by `Sweep.text`: its numbers have no units.

    Raises
    ------
    CaseError
        With one line for every fault: the key path, the value, and what is allowed.
    """
    value = dict(document.value)
    try:
        if value.get("schema") != SWEEP_SCHEMA:
            stated = as_written(value["schema"]) if "schema" in value else "missing"
            instead = "; compute a case with: tactsim run" if value.get("schema") == CASE_SCHEMA else ""
            raise YamlProblems(Problem(("schema",), 0, f"{stated}; a sweep begins with 'schema: {SWEEP_SCHEMA}'{instead}"))
        section, problems = value.pop(SWEEP_SECTION, None), list[Problem]()
        value["schema"] = CASE_SCHEMA
        settings = _unless_wrong(lambda: _settings(document, section, units=not checked), problems)
        places = _unless_wrong(lambda: places_of(value, ()), problems)
        if settings is None or places is None:
            raise YamlProblems(*problems)
        plain = replace(document, value=value)
        return replace(_sized(plain, where, settings, samples, places), checked=checked)
    except YamlProblems as error:
        problems = [Problem(p.path, document.line(p.path), p.message) for p in error.problems]
        raise case_error(problems, where) from None


def _unless_wrong(read: Callable[[], Read], problems: list[Problem]) -> Read | None:
    """What is read; None if something is wrong with it, which is added to the problems."""
    try:
        return read()
    except YamlProblems as error:
        problems += error.problems
        return None


@lru_cache(maxsize=4)
def sweep_of_text(text: str, folder: str | None = None) -> Sweep:
    """The sweep that `Sweep.text` describes; the files that it names are looked for in the folder first.

    Raises
    ------
    CaseError
        If the text is not that of a sweep.
    """
    document = Document(json.loads(text), folder=None if folder is None else FilePath(folder))
    return sweep_of_document(document, lambda problem: "the sweep", checked=True)


def _settings(document: Document, section: Any, units: bool) -> SweepSettings:
    if not isinstance(section, dict):
        raise YamlProblems(Problem((SWEEP_SECTION,), 0, "missing; expected a mapping, such as 'sweep: {samples: 1000}'"))
    try:
        context = {"units": "required"} if units else None
        return SweepSettings.model_validate_json(json.dumps(section), strict=True, context=context)
    except ValidationError as error:
        problems = problems_of(error, Document(section), SweepSettings)
        raise YamlProblems(*(Problem((SWEEP_SECTION, *p.path), 0, p.message) for p in problems)) from None


def _sized(document: Document, where: Where, settings: SweepSettings, samples: int | None, places: tuple[Place, ...]) -> Sweep:
    if not places:
        hint = "nothing varies; write a distribution for a number: {uniform: [2 mm, 7 mm]}"
        raise YamlProblems(Problem(("experiment",), 0, hint))
    for place in places:
        if place.path[:1] != ("experiment",) or place.path[1:] in ((), ("kind",)):
            written = f"{as_written(value_at(document.value, place.path))} is a distribution, which may only stand"
            raise YamlProblems(Problem(place.path, 0, f"{written} within the experiment, whose kind is fixed; write one value"))
    keys = {place.key for place in places}
    for key in settings.within_specimen:
        if key not in keys:
            near = suggestion(key, keys)
            raise _wrong("within_specimen", f"{key!r} is not a place that varies{near}; these vary: {', '.join(sorted(keys))}")
    inner = tuple(place for place in places if place.key in settings.within_specimen)
    outer = tuple(place for place in places if place.key not in settings.within_specimen)
    wanted = samples or settings.samples
    if settings.design == "grid":
        return _grid(document, where, settings, wanted, (outer, inner))
    if inner and settings.samples_per_specimen == 1:
        raise _wrong("samples_per_specimen", "is 1, so that nothing varies within a specimen; take 2 or more")
    if settings.samples_per_specimen > 1 and not inner:
        raise _wrong("within_specimen", "names nothing, so that the samples of a specimen would be equal; name what varies")
    if wanted is None:
        raise _wrong("samples", f"missing; expected a number of samples up to {MOST_SAMPLES}, or --samples N")
    if wanted > MOST_SAMPLES:  # of an option, which no field of the file has checked
        raise _wrong("samples", f"{wanted} asked for; allowed: up to {MOST_SAMPLES}")
    return Sweep(document, where, settings, wanted, settings.samples_per_specimen, outer, inner)


def _grid(
    document: Document, where: Where, settings: SweepSettings, wanted: int | None, places: tuple[tuple[Place, ...], ...]
) -> Sweep:
    for place in (*places[0], *places[1]):
        if place.distribution.options is None or "choice" in place.path:
            raise YamlProblems(Problem(place.path, 0, "a grid takes lists: values, range or choice, and none within a choice"))
    outer, inner = (math.prod(sizes_of(part)) for part in places)
    if outer * inner > MOST_SAMPLES:
        raise _wrong("design", f"the grid has {outer * inner} points; allowed: {MOST_SAMPLES}")
    if wanted not in (None, outer * inner):
        raise _wrong("samples", f"{wanted} asked for, but the grid has {outer * inner} points; leave it out")
    return Sweep(document, where, settings, outer * inner, inner, places[0], places[1])


def _wrong(key: str, message: str) -> YamlProblems:
    return YamlProblems(Problem((SWEEP_SECTION, key), 0, message))
