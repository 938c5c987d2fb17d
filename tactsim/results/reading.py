"""Reads the folder that a run wrote."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tactsim.errors import StorageError
from tactsim.outside.files import opened, opened_folder
from tactsim.outside.json_text import read_json
from tactsim.outside.text import one_line
from tactsim.results.document import parse_document, result_of
from tactsim.results.fields import field_files, read_fields
from tactsim.results.folder import RESULT_FILE
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

    @property
    def complete(self) -> Result:
        """The result with its provenance, as it was when it was written, and a warning of each file that is not."""
        changed = (f"{name} was changed since tactsim wrote it" for name in self.changed)
        return replace(self.result, provenance=self.provenance, warnings=(*self.result.warnings, *changed))


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
    provenance = _provenance(folder / "provenance.json")
    result = result_of(document)
    frames = read_fields(folder) if fields else ()
    manifest = read_manifest(folder)
    read = (RESULT_FILE, "provenance.json", *(field_files(folder) if fields else ()))
    edited = () if manifest is None else tuple(manifest.changed(folder, *read))
    return StoredResult(replace(result, frames=frames), document.case_id, provenance, folder, edited)


def _provenance(path: Path) -> dict[str, Any]:
    content = read_json(opened(path, "result").text(), str(path))
    if not isinstance(content, dict):
        raise StorageError(f"{one_line(path)} is damaged: it is not a mapping")
    return content
