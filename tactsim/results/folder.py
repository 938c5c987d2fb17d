"""An output folder that one run owns: written beside its place under another name, moved into place last.

Beside ``results/press`` may stand, while a run is alive, ``results/.press.lock`` (held by the operating system, so it ends with
its process) and ``results/.press.partial``; ``results/.press.replaced`` is the folder about to be replaced. What a killed run
left of these is tidied by the next one. A folder gives way only if its manifest names everything in it, unchanged.
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
from tactsim.outside.text import one_line
from tactsim.results.locking import beside, only_one
from tactsim.results.manifest import MANIFEST, foreign, manifest_of, names_in, read_manifest
from tactsim.results.storage import naming, write_bytes

RESULT_FILE = "result.json"
_OWN_NAME = re.compile(
    r"result\.json|history\.csv|provenance\.json|figures|figures/\w+\.(png|svg|pdf)|fields\.pvd|fields_\d+\.vtu|validation\.(json|md)"
)
"""Paths in the folders that tactsim wrote before it wrote manifests."""
MOST_EARLIER = 100
"""Earlier results without a manifest that are kept beside one folder; somebody should look at them."""


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
            _remove_own(self.partial)
            self.partial.mkdir(parents=True)
        return self.partial

    def finish(self) -> None:
        """Writes the manifest of what stands in the partial folder and brings its names down to the disk."""
        with naming(self.path):
            write_bytes(self.partial / MANIFEST, manifest_of(self.partial))

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
            keep = keep_earlier or not (self.path / MANIFEST).exists()  # what no manifest names may be somebody's
            self.path.rename(self.replaced)
            try:
                self.partial.rename(self.path)
            except BaseException:
                self.replaced.rename(self.path)
                raise
        return self._retire(keep)

    def discard(self) -> None:
        """Removes what was written so far."""
        with suppress(OSError):
            _remove_own(self.partial)

    def recover(self) -> None:
        """Puts right what a killed run left: brings back a folder caught in the exchange, removes partial files."""
        with naming(self.path):
            if self.replaced.exists() and not os.path.lexists(self.path):
                self.replaced.rename(self.path)
            _remove_own(self.replaced)
            _remove_own(self.partial)

    def _retire(self, keep: bool) -> Path | None:
        with suppress(OSError):
            if not keep:
                _remove_own(self.replaced)
                return None
            kept = self._place_for_earlier()
            _remove(kept)
            self.replaced.rename(kept)
            return kept
        return None

    def _place_for_earlier(self) -> Path:
        """The first name beside the folder that is free, or holds an earlier result with a manifest, which may go."""
        for number in range(1, MOST_EARLIER):
            kept = self.path.with_name(f"{self.path.name}.earlier{'' if number == 1 else f'-{number}'}")
            if not os.path.lexists(kept) or ((kept / MANIFEST).exists() and not _foreign(kept)):
                return kept
        raise StorageError(f"{one_line(self.path)} has {MOST_EARLIER} earlier results beside it; remove some")


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
    """Refuses a place that is taken by something which must not be replaced.

    Raises
    ------
    StorageError
        Naming what is in the way and how to replace it.
    """
    if not os.path.lexists(path) or (path.is_dir() and not path.is_symlink() and not any(path.iterdir())):
        return
    if path.is_symlink() or not path.is_dir():
        raise StorageError(f"the output folder {one_line(path)} exists and is not a folder; choose another with --out")
    if strangers := _foreign(path):
        more = f" and {len(strangers) - 1} more" if len(strangers) > 1 else ""
        advice = "move that away or choose another folder with --out"
        raise StorageError(f"the output folder {one_line(path)} holds {strangers[0]}{more}; {advice}")
    if not replace:
        raise StorageError(f"the output folder {one_line(path)} exists; use --force to replace it or choose another with --out")


def _foreign(path: Path) -> list[str]:
    """What in a folder must not be lost, in words: what its manifest does not name, or what no earlier version wrote."""
    try:
        manifest = read_manifest(path)
    except StorageError as error:
        return [f"a manifest that cannot be read ({one_line(error, 200)})"]
    if manifest is not None:
        return foreign(path, manifest)
    unknown = [name for name in names_in(path) if not _OWN_NAME.fullmatch(name)]
    if not unknown and not (path / RESULT_FILE).is_file() and not (path / "validation.json").is_file():
        return ["no result of tactsim"]
    return [f"{one_line(name)!r}, which tactsim did not write" for name in unknown]


def _remove_own(path: Path) -> None:
    """Removes what a run left half-written or replaced, unless somebody put something else there.

    Raises
    ------
    StorageError
        If it holds what no run writes.
    """
    strangers = [name for name in names_in(path) if name != MANIFEST and not _OWN_NAME.fullmatch(name)]
    if strangers:
        raise StorageError(f"{one_line(path)} holds {one_line(strangers[0])!r}, which tactsim did not write; move that away")
    _remove(path)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
