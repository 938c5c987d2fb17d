"""Reads the manifest and the tables; every fault with its file, line and key."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from tactsim.case.explaining import problems_of
from tactsim.case.loading import read_case_text
from tactsim.case.yaml_reading import Problem, YamlProblems, read_yaml
from tactsim.errors import CaseError, UnknownName
from tactsim.validation.table import Manifest, Table, table_class

MANIFEST = "manifest.yaml"
Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True)
class LoadedTables:
    """The tables that were asked for, and what the manifest promises of them."""

    folder: Path
    tables: dict[str, Table]
    manifest: Manifest
    faults: tuple[str, ...]
    """What is absent or not counted; each lets the validation fail."""


def load_tables(folder: Path, names: Sequence[str] = ()) -> LoadedTables:
    """The named tables of a folder, all if none is named, held against its manifest.

    Raises
    ------
    UnknownName
        If a name is neither in the manifest nor a file.
    CaseError
        For a file that is no table, with one line for every fault.
    InputError
        If two numbers or two figures have the same name, or a signature does not say what a table may write.
    StorageError
        If the manifest cannot be read.
    """
    manifest = read_model(folder / MANIFEST, Manifest)
    files = {path.stem: path for path in sorted(folder.glob("*.yaml")) if path.name != MANIFEST}
    known = list(dict.fromkeys([*manifest.tables, *files]))
    for name in names:
        if name not in known:
            raise UnknownName("thesis table", name, known)
    chosen = list(dict.fromkeys(names)) or known
    model = table_class()
    tables = {name: read_model(files[name], model) for name in chosen if name in files}
    faults = [fault for name in chosen for fault in _faults(name, tables.get(name), manifest)]
    return LoadedTables(folder, tables, manifest, tuple(faults))


def read_model(path: Path, model: type[Model]) -> Model:
    """The content of a YAML file as a closed model.

    Raises
    ------
    CaseError
        With one line for every fault.
    StorageError
        If the file cannot be read.
    """
    text = read_case_text(path)
    try:
        document = read_yaml(text)
    except YamlProblems as error:
        raise _error(path, error.problems) from None
    if not isinstance(document.value, dict):
        raise CaseError(f"{path}: the file holds no mapping")
    try:
        return model.model_validate_json(json.dumps(document.value), context={"units": "required"})
    except ValidationError as error:
        raise _error(path, problems_of(error, document, model)) from None


def _faults(name: str, table: Table | None, manifest: Manifest) -> list[str]:
    if name not in manifest.tables:
        return [f"{name}: the manifest does not count this table; enter its chapter and number of rows"]
    chapter, rows = manifest.tables[name]
    if table is None:
        return [f"{name}: the table is absent, and with it {rows} rows of chapter {chapter}"]
    faults = []
    if len(table.rows) != rows:
        faults.append(f"{name}: {len(table.rows)} rows where the manifest counts {rows}")
    if table.chapter != chapter:
        faults.append(f"{name}: the table names chapter {table.chapter}, the manifest chapter {chapter}")
    return faults


def _error(path: Path, problems: Sequence[Problem]) -> CaseError:
    lines = [
        ": ".join(part for part in (f"{path}:{problem.line}", ".".join(map(str, problem.path)), problem.message) if part)
        for problem in sorted(problems, key=lambda problem: problem.line)
    ]
    return CaseError("\n".join(dict.fromkeys(lines)))
