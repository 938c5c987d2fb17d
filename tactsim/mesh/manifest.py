"""The list of the meshes that are shipped with the cases."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from tactsim.errors import StorageError
from tactsim.model import FrozenModel
from tactsim.outside.files import opened
from tactsim.outside.json_text import read_json
from tactsim.refusals import first_fault

MANIFEST = "manifest.json"


class ManifestEntry(FrozenModel):
    """One shipped mesh."""

    name: str
    """What the mesh is called."""
    file: str
    """File beside the manifest."""
    key: str
    """Hash of the geometry and the settings that the mesh answers."""
    content: str
    """Hash of its nodes, elements and regions."""
    source: str
    """How it was made."""
    licence: str
    """Under which licence it may be used."""


_ENTRIES = TypeAdapter(tuple[ManifestEntry, ...])


def shipped_entry(folder: Path, key: str) -> ManifestEntry | None:
    """The entry of a folder's manifest with this key, None if there is none.

    Raises
    ------
    StorageError
        If the manifest is damaged.
    """
    return next((entry for entry in entries(folder) if entry.key == key), None)


def entries(folder: Path) -> tuple[ManifestEntry, ...]:
    """All entries of a folder's manifest, none if there is no manifest.

    Raises
    ------
    StorageError
        If the manifest is damaged.
    """
    place = folder / MANIFEST
    try:
        state = place.stat()
    except OSError:
        return ()
    return _entries(place, (state.st_mtime_ns, state.st_size))


@lru_cache(maxsize=4)
def _entries(place: Path, version: tuple[int, int]) -> tuple[ManifestEntry, ...]:
    try:
        return _ENTRIES.validate_python(read_json(opened(place, "description").text(), str(place)))
    except (OSError, ValidationError, StorageError, ValueError) as error:
        fault = first_fault(error) if isinstance(error, ValidationError) else error
        raise StorageError(f"cannot read {place}: {fault}") from None


def add_entry(folder: Path, entry: ManifestEntry) -> None:
    """Append an entry to a folder's manifest.

    Raises
    ------
    StorageError
        If it is damaged or cannot be written.
    """
    listed = [known.model_dump() for known in (*entries(folder), entry)]
    try:
        (folder / MANIFEST).write_text(json.dumps(listed, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise StorageError(f"cannot write {folder / MANIFEST}: {error.strerror or error}") from None
