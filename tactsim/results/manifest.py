"""The list of what tactsim wrote into a folder, with checksums: only that may ever be replaced or removed."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from tactsim.errors import StorageError
from tactsim.outside.files import opened
from tactsim.outside.text import one_line

MANIFEST = "manifest.json"
IGNORED = frozenset({".DS_Store", "Thumbs.db", "desktop.ini"})
"""Files that file managers leave; nobody misses them."""
CHUNK = 2**20
"""Bytes that are read at once."""


class WrittenFile(BaseModel):
    """One file: its size in bytes and the SHA-256 of its content."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: int = Field(ge=0)
    sha256: str = Field(pattern=r"[0-9a-f]{64}")


class Manifest(BaseModel):
    """Every file of a folder but the manifest itself, by its path with ``/`` from the folder."""

    model_config = ConfigDict(frozen=True)

    schema_version: Literal[1] = 1
    files: dict[str, WrittenFile]


def manifest_of(folder: Path) -> bytes:
    """The manifest of all files that stand in a folder."""
    written = {name: _written(folder / name) for name in sorted(names_in(folder)) if name != MANIFEST}
    return (Manifest(files=written).model_dump_json(indent=1) + "\n").encode()


def read_manifest(folder: Path) -> Manifest | None:
    """The manifest in a folder, None if there is none.

    Raises
    ------
    StorageError
        If it is damaged.
    """
    place = folder / MANIFEST
    if not os.path.lexists(place):
        return None
    try:
        return Manifest.model_validate(json.loads(opened(place, "description").text()))
    except (ValueError, RecursionError, ValidationError) as error:
        if isinstance(error, StorageError):
            raise
        raise StorageError(f"{one_line(place)} is damaged: {one_line(error, 200)}") from None


def foreign(folder: Path, manifest: Manifest) -> list[str]:
    """What stands in a folder and is not as tactsim wrote it, in words: files it did not write, and files that were changed."""
    names = names_in(folder)
    told = [f"{one_line(name)!r}, which tactsim did not write" for name in sorted(names - manifest.files.keys() - {MANIFEST})]
    return told + [f"{one_line(name)!r}, which was changed since tactsim wrote it" for name in changed(folder, manifest)]


def changed(folder: Path, manifest: Manifest, names: frozenset[str] | None = None) -> list[str]:
    """Files of the manifest, all or those named, whose content is another than was written; one that is missing is not."""
    chosen = manifest.files if names is None else {name: manifest.files[name] for name in sorted(names & manifest.files.keys())}
    return [name for name, written in chosen.items() if os.path.lexists(folder / name) and not _is(folder / name, written)]


def _is(path: Path, written: WrittenFile) -> bool:
    if path.is_symlink() or not path.is_file() or path.stat().st_size != written.size:
        return False
    return _written(path) == written


def _written(path: Path) -> WrittenFile:
    summed, size = hashlib.sha256(), 0
    with open(path, "rb") as file:
        while chunk := file.read(CHUNK):
            summed.update(chunk)
            size += len(chunk)
    return WrittenFile(size=size, sha256=summed.hexdigest())


def names_in(folder: Path) -> set[str]:
    """Paths of the files, links and empty folders below a folder, but for what file managers leave; links are not followed."""
    found: set[str] = set()
    for place, folders, files in os.walk(folder):
        kept = [name for name in files if name not in IGNORED]
        links = [name for name in folders if os.path.islink(os.path.join(place, name))]
        found |= {(Path(place) / name).relative_to(folder).as_posix() for name in [*kept, *links]}
        if not (folders or kept) and Path(place) != folder:
            found.add(Path(place).relative_to(folder).as_posix())
    return found
