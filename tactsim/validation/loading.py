"""Reads the manifest and the tables; every fault with its file, line and key."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from tactsim.case.explaining import problems_of
from tactsim.case.loading import case_error, place_in, read_case_text
from tactsim.case.yaml_reading import YamlProblems, read_yaml
from tactsim.errors import CaseError, UnknownName
from tactsim.validation.comparison import figures_of
from tactsim.validation.table import Manifest, Table

MANIFEST = "manifest.yaml"
Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True)
class LoadedTables:
    """The tables of a folder that were asked for, and what its manifest promises of them."""

    folder: Path
    """Its name is that of the group: ``thesis``, ``published``."""
    tables: dict[str, Table]
    manifest: Manifest
    faults: tuple[str, ...]
    """What is absent or not counted; each makes the validation fail."""


def load_groups(folders: Sequence[Path], names: Sequence[str] = ()) -> tuple[LoadedTables, ...]:
    """The named tables of several folders; the name of a folder stands for all its tables, and no name for all of all.

    Raises
    ------
    UnknownName
        If a name is neither a folder nor a table of one.
    CaseError, InputError, StorageError
        As `load_tables`.
    """
    known = {folder.name: _names(read_model(folder / MANIFEST, Manifest), _files(folder)) for folder in folders}
    for name in names:
        if name not in known and not any(name in tables for tables in known.values()):
            raise UnknownName("table", name, [*known, *(table for tables in known.values() for table in tables)])
    groups = []
    for folder in folders:
        whole = not names or folder.name in names
        chosen = () if whole else tuple(name for name in dict.fromkeys(names) if name in known[folder.name])
        if whole or chosen:
            groups.append(load_tables(folder, chosen))
    return tuple(groups)


def _files(folder: Path) -> dict[str, Path]:
    """Files of the tables that stand in a folder, by name."""
    return {path.stem: path for path in sorted(folder.glob("*.yaml")) if path.name != MANIFEST}


def _names(manifest: Manifest, files: Mapping[str, Path]) -> list[str]:
    """Tables that a manifest counts, and those that stand there."""
    return list(dict.fromkeys([*manifest.tables, *files]))


def load_tables(folder: Path, names: Sequence[str] = ()) -> LoadedTables:
    """The named tables of a folder, all if none is named, held against its manifest.

    Raises
    ------
    UnknownName
        If a name is neither in the manifest nor a file.
    CaseError
        For a file that is no table, with one line for every fault.
    InputError
        If two numbers or two figures that a table calls have the same name, or a signature does not say what it may write.
    StorageError
        If the manifest cannot be read.
    """
    manifest, files = read_model(folder / MANIFEST, Manifest), _files(folder)
    known = _names(manifest, files)
    for name in names:
        if name not in known:
            raise UnknownName("table", name, known)
    chosen = list(dict.fromkeys(names)) or known
    tables = {name: read_model(files[name], Table) for name in chosen if name in files}
    faults = [fault for name in chosen for fault in _faults(name, tables.get(name), manifest)]
    faults += _number_faults(tables, manifest, whole=not names)
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
        raise case_error(error.problems, place_in(path, {})) from None
    if not isinstance(document.value, dict):
        raise CaseError(f"{path}: the file holds no mapping")
    try:
        return model.model_validate_json(json.dumps(document.value), strict=True, context={"units": "required"})
    except ValidationError as error:
        raise case_error(problems_of(error, document, model), place_in(path, {})) from None


def _faults(name: str, table: Table | None, manifest: Manifest) -> list[str]:
    if name not in manifest.tables:
        return [f"{name}: the manifest does not count this table; enter its chapter and number of rows"]
    chapter, rows = manifest.tables[name]
    if table is None:
        return [f"{name}: the table is absent, and with it {rows} rows of chapter {chapter}"]
    faults = []
    if len(table.rows) != rows:
        faults.append(f"{name}: {len(table.rows)} rows where the manifest counts {rows}")
    if str(table.chapter) != chapter:
        faults.append(f"{name}: the table names chapter {table.chapter}, the manifest chapter {chapter}")
    identifiers = {row.id for row in table.rows} | {"computed", "ratio"}
    faults += [
        f"{name}: the reason of {row.id} has a figure {{{figure}}}, which is no row of the table"
        for row in table.rows
        for figure in sorted(figures_of(row) - identifiers)
    ]
    return faults


def _number_faults(tables: Mapping[str, Table], manifest: Manifest, *, whole: bool) -> list[str]:
    """Numbers that a row names but the manifest does not know, and, if all tables are there, those that no row names."""
    named = {number: name for name, table in tables.items() for row in table.rows for number in row.numbers}
    unknown = [f"{named[number]}: {number} is no number of the manifest" for number in sorted(set(named) - set(manifest.numbers))]
    without = sorted(set(manifest.numbers) - set(named)) if whole else []
    return unknown + [f"{number}: no row names it: {manifest.numbers[number]}" for number in without]
