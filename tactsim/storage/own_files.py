"""Which files in a folder tactsim wrote, and whether they are unchanged: only those are ever replaced or removed.

A folder that is wholly tactsim's, such as a result, holds ``manifest.json``, written last, with the size and checksum of every
file. A folder that its user may write into too, such as a data set, holds ``.tactsim.json``: of each file the checksums of the
content before and of the last one, so that a kill between the list and the file leaves a file that is known.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, Strict, ValidationError

from tactsim.errors import StorageError
from tactsim.outside.files import opened
from tactsim.outside.json_text import read_json
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.storage.files import naming, replace_file

MANIFEST, OWN_LIST = "manifest.json", ".tactsim.json"
OWN_LIST_SCHEMA = "tactsim/manifest/1"
IGNORED = frozenset({".DS_Store", "Thumbs.db", "desktop.ini"})
"""Files that file managers put into every folder that is looked at; nobody misses them."""
OWN_NAME = re.compile(r"\w[\w.-]*(/\w[\w.-]*)?")
"""Files in ``.tactsim.json`` stand in the folder or in one within it."""


class WrittenFile(BaseModel):
    """One file: its size in bytes and the SHA-256 of its content."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    size: int = Field(ge=0)
    sha256: str = Field(pattern=r"[0-9a-f]{64}")


class Manifest(BaseModel):
    """Every file of a folder but the manifest itself, by its path with ``/`` from the folder."""

    model_config = ConfigDict(frozen=True)

    schema_version: Annotated[int, Strict(), Field(ge=1, le=1)] = 1
    files: dict[str, WrittenFile]

    def foreign(self, folder: Path) -> list[str]:
        """What stands in the folder and is not as tactsim wrote it, in words: files it did not write, and changed ones.

        Raises
        ------
        StorageError
            If a file cannot be read.
        """
        unknown = sorted(names_in(folder) - self.files.keys() - {MANIFEST})
        return described(folder, unknown) + [
            f"{one_line(name)!r}, which was changed since tactsim wrote it" for name in self.changed(folder)
        ]

    def changed(self, folder: Path, *names: str) -> list[str]:
        """Files, all or those named, whose content is another than was written; one that is missing is not.

        Raises
        ------
        StorageError
            If a file cannot be read.
        """
        chosen = sorted(set(names) & self.files.keys()) if names else self.files
        return [name for name in chosen if os.path.lexists(folder / name) and not self._is_unchanged(folder, name)]

    def _is_unchanged(self, folder: Path, name: str) -> bool:
        path, written = folder / name, self.files[name]
        return is_plain(folder, name) and path.stat().st_size == written.size and checksum(path) == written.sha256


def described(folder: Path, unknown: Iterable[str]) -> list[str]:
    """What in a folder does not belong to it, in words: files, or a folder within it that tactsim wrote for itself."""
    words = []
    for name in unknown:
        above = (place.as_posix() for place in reversed(PurePosixPath(name).parents[:-1]))
        within = next((place for place in above if (folder / place / MANIFEST).is_file()), None)
        words.append(
            f"{one_line(name)!r}, which tactsim did not write"
            if within is None
            else f"{one_line(within)!r}, which is another result or report of tactsim"
        )
    return list(dict.fromkeys(words))


def manifest_of(folder: Path) -> bytes:
    """The manifest of all files that stand in a folder, as its file holds it.

    Raises
    ------
    StorageError
        If a file cannot be read.
    """
    names = sorted(names_in(folder) - {MANIFEST})
    written = {name: WrittenFile(size=(folder / name).stat().st_size, sha256=checksum(folder / name)) for name in names}
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
    except ValidationError as error:
        raise StorageError(f"{one_line(place)} is damaged: {first_fault(error)}") from None
    except (ValueError, RecursionError) as error:
        if isinstance(error, StorageError):
            raise
        raise StorageError(f"{one_line(place)} is damaged: {one_line(error, 200)}") from None


def names_in(folder: Path) -> set[str]:
    """Paths of the files, links and empty folders below a folder, but for what file managers leave; links are not followed."""
    names: set[str] = set()
    for place, folders, files in os.walk(folder):
        kept = [name for name in files if name not in IGNORED]
        links = [name for name in folders if os.path.islink(os.path.join(place, name))]
        names |= {(Path(place) / name).relative_to(folder).as_posix() for name in [*kept, *links]}
        if not (folders or kept) and Path(place) != folder:
            names.add(Path(place).relative_to(folder).as_posix())
    return names


def is_plain(folder: Path, name: str) -> bool:
    """Whether a path in a folder is a regular file that no link leads to."""
    path = folder / name
    return os.path.realpath(path) == os.path.join(os.path.realpath(folder), *name.split("/")) and path.is_file()


def checksum(path: Path) -> str:
    """SHA-256 of the content of a file.

    Raises
    ------
    StorageError
        If it cannot be read.
    """
    with naming(path, "read"), open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


class ForeignFile(StorageError):
    """A file stands where tactsim would write, and tactsim did not write it."""


class OwnFiles:
    """The files of tactsim in a folder that its user may write into too."""

    def __init__(self, folder: Path):
        self.folder = folder

    def sums(self) -> dict[str, list[str]]:
        """Path in the folder -> SHA-256 of what tactsim wrote there.

        Raises
        ------
        ForeignFile
            If the list is not of tactsim.
        """
        path = self.folder / OWN_LIST
        if not os.path.lexists(path):
            return {}
        try:
            if path.is_symlink():
                raise StorageError(f"{one_line(path)} is a link")
            content = read_json(opened(path, "description").text(), str(path))
        except StorageError as error:
            raise ForeignFile(f"{error}; move {one_line(path)} away, what it lists is then kept as yours") from None
        files = content.get("files") if isinstance(content, dict) and content.get("schema") == OWN_LIST_SCHEMA else None
        if not isinstance(files, dict) or not all(OWN_NAME.fullmatch(n) and isinstance(sums, list) for n, sums in files.items()):
            raise ForeignFile(f"{one_line(path)} is no list of tactsim's files; move it away")
        return {str(name): list(map(str, sums)) for name, sums in files.items()}

    def written(self, name: str) -> str | None:
        """SHA-256 of a file if it is there and tactsim wrote it.

        Raises
        ------
        ForeignFile
            If the list is not of tactsim.
        """
        current = self._current(name)
        return current if current in self.sums().get(name, []) else None

    def refuse_foreign(self, *names: str) -> None:
        """Refuses names at which something stands that tactsim did not write.

        Raises
        ------
        ForeignFile
            Naming the first.
        """
        for name in names:
            if os.path.lexists(self.folder / name) and self.written(name) is None:
                where = one_line(self.folder / name)
                raise ForeignFile(f"{where} is not what tactsim wrote there, and is kept; move it away or choose another place")

    def replace(self, name: str, content: bytes) -> None:
        """Writes a file, or writes it anew if tactsim wrote what stands there.

        Raises
        ------
        ForeignFile
            If something else stands there, which is kept.
        StorageError
            If it cannot be written.
        """
        self.refuse_foreign(name)
        current, new = self._current(name), hashlib.sha256(content).hexdigest()
        with naming(self.folder / name):
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        if current != new:
            self._list(name, current, new)
            replace_file(self.folder / name, content)

    def adopt(self, name: str) -> None:
        """Lists a file, if it is there, that an earlier version wrote, which kept no list.

        Raises
        ------
        ForeignFile
            If the list of files is not of tactsim.
        StorageError
            If the file cannot be read, or the list cannot be written.
        """
        current = self._current(name)
        if current is not None:
            self._list(name, current)

    def _list(self, name: str, *sums: str | None) -> None:
        files = {**self.sums(), name: list(dict.fromkeys(known for known in sums if known is not None))}
        content = {"schema": OWN_LIST_SCHEMA, "files": dict(sorted(files.items()))}
        replace_file(self.folder / OWN_LIST, (json.dumps(content, indent=1) + "\n").encode())

    def _current(self, name: str) -> str | None:
        """SHA-256 of the file of a name, None if there is none."""
        return checksum(self.folder / name) if is_plain(self.folder, name) else None
