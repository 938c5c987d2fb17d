"""An output folder that one run owns: written beside its place under another name, moved into place last.

Beside ``results/press`` may stand, while a run is alive, ``results/.press.lock`` (held by the operating system, so it ends with
its process) and ``results/.press.partial``; ``results/.press.replaced`` is the folder about to be replaced. What a killed run
left of these is tidied by the next one.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from tactsim.errors import StorageError
from tactsim.results.locking import beside, only_one
from tactsim.results.storage import naming

RESULT_FILE = "result.json"
_OWN_NAME = re.compile(r"result\.json|history\.csv|provenance\.json|figures|fields\.pvd|fields_\d+\.vtu")
_IGNORED_NAMES = frozenset({".DS_Store", "Thumbs.db", "desktop.ini"})


@dataclass(frozen=True)
class OutputFolder:
    """The claim of one run on its output folder."""

    path: Path
    replace: bool

    @property
    def partial(self) -> Path:
        """Where the files are written before they are complete."""
        return beside(self.path, "partial")

    @property
    def replaced(self) -> Path:
        """Where the earlier folder stands for the moment of the exchange."""
        return beside(self.path, "replaced")

    def start(self) -> Path:
        """An empty folder to write into."""
        with naming(self.path):
            _remove(self.partial)
            self.partial.mkdir(parents=True)
        return self.partial

    def publish(self, keep_earlier: bool = False) -> Path | None:
        """Moves the written folder into place; returns where an earlier one is kept, if it is.

        Raises
        ------
        StorageError
            If the place was taken meanwhile or cannot be written; an earlier folder is then where it was.
        """
        with naming(self.path):
            if not os.path.lexists(self.path):
                self.partial.rename(self.path)
                return None
            check_replaceable(self.path, self.replace)
            self.path.rename(self.replaced)
            try:
                self.partial.rename(self.path)
            except BaseException:
                self.replaced.rename(self.path)
                raise
        return self._retire(keep_earlier)

    def discard(self) -> None:
        """Removes what was written so far."""
        with suppress(OSError):
            _remove(self.partial)

    def recover(self) -> None:
        """Puts right what a killed run left: brings back a folder caught in the exchange, removes partial files."""
        with naming(self.path):
            if self.replaced.exists() and not os.path.lexists(self.path):
                self.replaced.rename(self.path)
            _remove(self.replaced)
            _remove(self.partial)

    def _retire(self, keep: bool) -> Path | None:
        kept = self.path.with_name(f"{self.path.name}.earlier")
        with suppress(OSError):
            if keep and (not os.path.lexists(kept) or _is_own(kept)):
                _remove(kept)
                self.replaced.rename(kept)
                return kept
            _remove(self.replaced)
        return None


@contextmanager
def claimed(directory: str | Path, *, replace: bool = False) -> Iterator[OutputFolder]:
    """The output folder, owned until the block ends.

    Parameters
    ----------
    replace
        Whether an earlier result of tactsim may give way; a folder that holds anything else never does.

    Raises
    ------
    StorageError
        If the folder exists, is in use by another run, or its parent cannot be written.
    """
    path = Path(directory)
    path = path if path.name not in ("", "..") else Path(os.path.abspath(path))
    folder = OutputFolder(path, replace)
    with naming(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    with only_one(path, f"the output folder {path} is in use by another run; wait for it or choose another with --out"):
        try:
            folder.recover()
            check_replaceable(path, replace)
            folder.start()
            yield folder
        finally:
            folder.discard()


def check_replaceable(path: Path, replace: bool) -> None:
    """Refuses a place that is taken by something which must not be replaced."""
    if not os.path.lexists(path) or (path.is_dir() and not path.is_symlink() and not any(path.iterdir())):
        return
    if path.is_symlink() or not path.is_dir():
        raise StorageError(f"the output folder {path} exists and is not a folder; choose another with --out")
    if not _is_own(path):
        foreign = _foreign_names(path)
        what = f"holds {foreign[0]!r}, which tactsim did not write" if foreign else "holds no result of tactsim"
        raise StorageError(f"the output folder {path} exists and {what}; choose another with --out")
    if not replace:
        raise StorageError(f"the output folder {path} exists; use --force to replace it or choose another with --out")


def _is_own(path: Path) -> bool:
    return (path / RESULT_FILE).is_file() and not _foreign_names(path)


def _foreign_names(path: Path) -> list[str]:
    """Names in the folder that no run writes, sorted."""
    names = sorted(entry.name for entry in path.iterdir())
    return [name for name in names if not _OWN_NAME.fullmatch(name) and name not in _IGNORED_NAMES]


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
