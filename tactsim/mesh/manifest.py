"""The list of the meshes that are shipped with the cases."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from tactsim.errors import StorageError
from tactsim.outside.files import opened
from tactsim.units import FrozenModel

MANIFEST = "manifest.yaml"


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
    return _entries(place, state.st_mtime_ns)


@lru_cache(maxsize=4)
def _entries(place: Path, modified: int) -> tuple[ManifestEntry, ...]:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        return _ENTRIES.validate_python(tuple(YAML(typ="safe", pure=True).load(opened(place, "description").text()) or ()))
    except (OSError, YAMLError, ValidationError, TypeError, ValueError) as error:
        raise StorageError(f"cannot read {place}: {error}") from None


def add_entry(folder: Path, entry: ManifestEntry) -> None:
    """Append an entry to a folder's manifest.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    lines = [f"{'- ' if k == 0 else '  '}{key}: {value!r}\n" for k, (key, value) in enumerate(entry.model_dump().items())]
    try:
        with open(folder / MANIFEST, "a", encoding="utf-8") as file:
            file.write("".join(lines))
    except OSError as error:
        raise StorageError(f"cannot write {folder / MANIFEST}: {error.strerror or error}") from None
