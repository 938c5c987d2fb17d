"""Reads the folder that a run wrote."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tactsim.errors import StorageError
from tactsim.outside.files import opened, opened_folder
from tactsim.outside.text import one_line
from tactsim.results.document import parse_document, result_of
from tactsim.results.fields import INDEX, field_files, read_fields
from tactsim.results.folder import RESULT_FILE
from tactsim.results.provenance import PROVENANCE_FILE, read_provenance
from tactsim.results.result import Result
from tactsim.storage.own_files import read_manifest


@dataclass(frozen=True)
class StoredResult:
    """A result as it stands on disk, with the identity of its case and what it rests on."""

    result: Result
    case_id: str
    provenance: dict[str, Any]
    directory: Path
    changed: tuple[str, ...] = ()
    """Files that are read here and were changed since tactsim wrote them."""
    without_fields: bool = False
    """Whether tactsim wrote fields there that are asked for and gone."""

    @property
    def case_title(self) -> str:
        """Title of the case, empty without one."""
        return str(self.provenance.get("case", {}).get("title") or "")

    @property
    def changes(self) -> tuple[str, ...]:
        """A sentence for every changed file, and for fields that are gone."""
        gone = (f"{INDEX}, which tactsim wrote, is gone: the result has no fields",) if self.without_fields else ()
        return tuple(f"{name} was changed since tactsim wrote it" for name in self.changed) + gone

    @property
    def complete(self) -> Result:
        """The result with its provenance, as it was when it was written, and a warning of each file that is not or is gone."""
        return replace(self.result, provenance=self.provenance, warnings=(*self.result.warnings, *self.changes))


def result_folder(place: Path) -> Path:
    """The folder of a result that is named by it, or by its result.json."""
    return place.parent if place.name == RESULT_FILE else place


def read_result(directory: str | Path, *, fields: bool = True) -> StoredResult:
    """The result in a folder, with or without its fields.

    Raises
    ------
    StorageError
        If a file is missing, damaged, or of a newer version of tactsim.
    """
    folder, _ = opened_folder(directory, "result of tactsim")
    if not (folder / RESULT_FILE).exists():
        raise StorageError(f"{one_line(directory)} holds no {RESULT_FILE}, so it is not a result of tactsim")
    document = parse_document(opened(folder / RESULT_FILE, "result").text(), str(folder / RESULT_FILE))
    provenance = read_provenance(folder / PROVENANCE_FILE)
    result = result_of(document)
    frames = read_fields(folder) if fields else ()
    manifest = read_manifest(folder)
    read = (RESULT_FILE, PROVENANCE_FILE, *(field_files(folder) if fields else ()))
    edited = () if manifest is None else tuple(manifest.changed(folder, *read))
    gone = fields and manifest is not None and INDEX in manifest.files and not (folder / INDEX).exists()
    return StoredResult(replace(result, frames=frames), document.case_id, provenance, folder, edited, gone)


def read_basis(directory: str | Path) -> StoredResult:
    """The result in a folder, without fields, on which something else rests; a file that was changed is a Python warning.

    Raises
    ------
    StorageError
        As `read_result`.
    """
    stored = read_result(directory, fields=False)
    for change in stored.changes:
        warnings.warn(f"{one_line(directory)}: {change}", stacklevel=2)
    return stored
