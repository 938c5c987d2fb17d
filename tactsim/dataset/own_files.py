"""The files that tactsim writes into a folder which its user may write into, too: only these are replaced.

``.tactsim.json`` in the folder holds their checksums: of each file that of the content before and of the last one, so that a kill
between the list and the file leaves a file that is known.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from pathlib import Path

from tactsim.dataset.array_description import read_json
from tactsim.errors import StorageError
from tactsim.outside.files import opened
from tactsim.outside.text import one_line
from tactsim.results.storage import naming, replace_file

MANIFEST = ".tactsim.json"
SCHEMA = "tactsim/manifest/1"
NAME = re.compile(r"\w[\w.-]*(/\w[\w.-]*)?")
"""Files that are listed stand in the folder or in one within it."""


class ForeignFile(StorageError):
    """A file stands where tactsim would write, and tactsim did not write it."""


class OwnFiles:
    """The files of one folder."""

    def __init__(self, folder: Path):
        self.folder = folder

    def sums(self) -> dict[str, list[str]]:
        """Path in the folder -> SHA-256 of what tactsim wrote there.

        Raises
        ------
        ForeignFile
            If the list is not of tactsim.
        """
        path = self.folder / MANIFEST
        if not os.path.lexists(path):
            return {}
        try:
            told = read_json(path)
        except StorageError as error:
            raise ForeignFile(f"{error}; move {one_line(path)} away, what it lists is then kept as yours") from None
        files = told.get("files") if isinstance(told, dict) and told.get("schema") == SCHEMA else None
        if not isinstance(files, dict) or not all(NAME.fullmatch(n) and isinstance(sums, list) for n, sums in files.items()):
            raise ForeignFile(f"{one_line(path)} is no list of tactsim's files; move it away")
        return {str(name): [str(one) for one in sums] for name, sums in files.items()}

    def written(self, name: str) -> str | None:
        """SHA-256 of a file if it is there and tactsim wrote it."""
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
        """Writes a file, or writes it anew if it is own.

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
            self._note(name, current, new)
            replace_file(self.folder / name, content)

    def adopt(self, name: str) -> None:
        """Counts a file as own that an earlier version wrote, which kept no list."""
        current = self._current(name)
        if current is not None:
            self._note(name, current, current)

    def _note(self, name: str, *sums: str | None) -> None:
        files = {**self.sums(), name: list(dict.fromkeys(one for one in sums if one is not None))}
        told = {"schema": SCHEMA, "files": dict(sorted(files.items()))}
        replace_file(self.folder / MANIFEST, (json.dumps(told, indent=1) + "\n").encode())

    def _current(self, name: str) -> str | None:
        """SHA-256 of a regular file that no link leads to, None if there is none."""
        path = self.folder / name
        if os.path.realpath(path) != os.path.join(os.path.realpath(self.folder), *name.split("/")) or not path.is_file():
            return None
        return hashlib.sha256(opened(path, "kept file").read()).hexdigest()
