"""An output folder that one run owns: written beside its place under another name, moved into place last.

Beside ``results/press`` may stand, while a run is alive, ``results/.press.lock`` (held by the operating system, so it ends with
its process) and ``results/.press.partial``, in which the result waits; ``results/.press.replaced`` is the folder about to be
replaced. What a killed run left of these is tidied by the next one. A folder gives way only if its manifest names everything in
it, unchanged; one without a manifest, and one that is to be kept, is renamed to ``results/press.earlier`` at once.
"""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from tactsim.errors import StorageError
from tactsim.outside.text import first_names, one_line
from tactsim.storage.building import (
    begin,
    is_empty,
    is_marked,
    moved_aside,
    refuse_within_data_set,
    remove,
    remove_leftover,
    remove_marked,
    settle,
    waiting_content,
    waiting_folder,
)
from tactsim.storage.files import beside, naming, refuse_few_descriptors, write_bytes
from tactsim.storage.locking import only_one
from tactsim.storage.own_files import MANIFEST, described, manifest_of, names_in, read_manifest

RESULT_FILE = "result.json"
_OWN_NAME = re.compile(
    r"result\.json|history\.csv|provenance\.json|figures|figures/\w+\.(png|svg|pdf)|fields\.pvd|fields_\d+\.vtu|validation\.(html|json|md)"
)
"""Paths in the folders that tactsim wrote before it wrote manifests."""
SPARE = 6
"""Files that a run opens at once before its result is written: libraries, their fonts, and the folder with a file in it."""
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
        return waiting_content(self.path)

    @property
    def replaced(self) -> Path:
        """Where the earlier folder stands for the moment of the exchange, if it is not kept.

        Raises
        ------
        StorageError
            If the place has no name, as ``.`` and ``/``.
        """
        return beside(self.path, "replaced")

    def start(self) -> Path:
        """An empty folder to write into.

        Raises
        ------
        StorageError
            If it cannot be made, or something that tactsim did not write stands in its place.
        """
        with naming(self.path):
            self._remove_unmarked()
            begin(self.path).mkdir()
        return self.partial

    def finish(self) -> None:
        """Writes the manifest of what stands in the partial folder.

        Raises
        ------
        StorageError
            If it cannot be written.
        """
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
            settle(self.partial)
            if is_empty(self.path):
                self.path.rmdir()
            if not os.path.lexists(self.path):
                self.partial.rename(self.path)
                return None
            check_replaceable(self.path, self.replace)
            if keep_earlier or not (self.path / MANIFEST).exists():  # what no manifest names may be somebody's
                return self._publish_beside_earlier()
            with moved_aside(self.path, self.replaced):
                self.partial.rename(self.path)
        with suppress(OSError):
            _remove_own(self.replaced)
        return None

    def discard(self) -> None:
        """Removes what was written so far."""
        with suppress(OSError):
            if is_marked(waiting_folder(self.path)):
                remove_leftover(self.path)

    def recover(self) -> None:
        """Puts right what a killed run left: brings back a folder caught in the exchange, removes partial files.

        A folder without a manifest that an earlier version was about to replace is kept.

        Raises
        ------
        StorageError
            If the folder cannot be written, or holds under such a name what tactsim did not write.
        """
        with naming(self.path):
            if self.replaced.exists() and not os.path.lexists(self.path):
                self.replaced.rename(self.path)
            _refuse_foreign_names(self.replaced)
            if names_in(self.replaced) and not (self.replaced / MANIFEST).exists():
                kept = self._place_for_earlier()
                remove(kept)
                self.replaced.rename(kept)
            _remove_own(self.replaced)
            self._bring_back_outdated()
            self._remove_unmarked()
            remove_leftover(self.path)

    def _publish_beside_earlier(self) -> Path:
        """The exchange in which the earlier folder gets its lasting name at once, so that no kill leaves it under another."""
        kept = self._place_for_earlier()
        with ExitStack() as exchange:
            if os.path.lexists(kept):
                exchange.enter_context(moved_aside(kept, waiting_folder(self.path) / kept.name))
            exchange.enter_context(moved_aside(self.path, kept))
            self.partial.rename(self.path)
        return kept

    def _place_for_earlier(self) -> Path:
        """The first name beside the folder that is free, or holds an earlier result with a manifest, which may go."""
        for number in range(1, MOST_EARLIER):
            kept = self.path.with_name(f"{self.path.name}.earlier{'' if number == 1 else f'-{number}'}")
            if not os.path.lexists(kept) or ((kept / MANIFEST).exists() and not _foreign(kept)):
                return kept
        raise StorageError(f"{one_line(self.path)} has {MOST_EARLIER} earlier results beside it; remove some")

    def _bring_back_outdated(self) -> None:
        """Puts a kept result back that a killed run moved aside and put nothing in its place."""
        waiting = waiting_folder(self.path)
        for outdated in waiting.glob(f"{glob.escape(self.path.name)}.earlier*") if is_marked(waiting) else ():
            if not os.path.lexists(self.path.with_name(outdated.name)):
                outdated.rename(self.path.with_name(outdated.name))

    def _remove_unmarked(self) -> None:
        """Removes partial files of an earlier version, which did not mark them."""
        waiting = waiting_folder(self.path)
        if os.path.lexists(waiting) and not is_marked(waiting):
            _remove_own(waiting)


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
    with only_one(path, f"the output folder {one_line(path)} is in use by another run; wait for it or choose another folder"):
        try:
            refuse_within_data_set(path)
            folder.recover()
            check_replaceable(path, replace)
            folder.start()
            refuse_few_descriptors(path.absolute().parent, SPARE)
            yield folder
        finally:
            folder.discard()


def check_replaceable(path: Path, replace: bool, *others: Path) -> None:
    """Refuses places that are taken by something which must not be replaced.

    Raises
    ------
    StorageError
        Naming every place with what is in the way, and how to replace it.
    """
    taken = [place for place in (path, *others) if _is_taken(place)]
    refusals = {place: reason for place in taken if (reason := _why_never(place))}
    existing = [] if replace else [one_line(place) for place in taken if place not in refusals]
    words = list(refusals.values())
    if len(existing) == 1:
        how = "use --force (in Python: force=True) to replace it, or choose another folder"
        words.append(f"the output folder {existing[0]} exists; {how}")
    elif existing:
        named = f"{', '.join(existing[:-1])} and {existing[-1]}"
        words.append(f"the output folders {named} exist; use --force to replace them, or choose another folder")
    if words:
        raise StorageError("; ".join(words))


def refuse_others(path: Path, file: str, what: str) -> None:
    """Refuses a folder of tactsim without the file by which those are known that a command replaces without asking.

    Raises
    ------
    StorageError
        If the folder holds anything else; ``what`` is what the command calls those that it replaces.
    """
    if (path / RESULT_FILE).exists():
        raise StorageError(f"{one_line(path)} holds a result, which no {what} replaces; choose another folder")
    if (path / MANIFEST).exists() and not (path / file).exists():
        raise StorageError(f"{one_line(path)} holds something else than a {what}, which is not replaced; choose another folder")


def _is_taken(path: Path) -> bool:
    return os.path.lexists(path) and (path.is_symlink() or not path.is_dir() or any(path.iterdir()))


def _why_never(path: Path) -> str:
    """Why what stands at a place is never replaced, in words; empty if it may be."""
    if path.is_symlink() or not path.is_dir():
        link = " but a link" if path.is_symlink() else ""
        return f"the output folder {one_line(path)} exists and is not a folder{link}; choose another place"
    strangers = _foreign(path)
    advice = "move that away or choose another folder"
    return f"the output folder {one_line(path)} holds {first_names(strangers, 1)}; {advice}" if strangers else ""


def _foreign(path: Path) -> list[str]:
    """What in a folder must not be lost, in words: what its manifest does not name, or what no earlier version wrote."""
    try:
        manifest = read_manifest(path)
    except StorageError as error:
        return [f"a manifest that cannot be read ({one_line(error, 200)})"]
    if manifest is not None:
        return manifest.foreign(path)
    unknown = [name for name in sorted(names_in(path)) if not _OWN_NAME.fullmatch(name)]
    if not unknown and not (path / RESULT_FILE).is_file() and not (path / "validation.json").is_file():
        return ["no result of tactsim"]
    return described(path, unknown)


def _remove_own(path: Path) -> None:
    """Removes what a run left half-written or replaced, if anything, unless somebody put something else there."""
    _refuse_foreign_names(path)
    if path.is_dir() and not path.is_symlink():
        remove_marked(path, MANIFEST)
    else:
        remove(path)


def _refuse_foreign_names(path: Path) -> None:
    """Refuses what neither the manifest of the folder names nor, without one, an earlier version wrote.

    Contents are not read again: what is replaced was held against its manifest a moment before.
    """
    manifest = read_manifest(path)
    written = set(manifest.files) if manifest is not None else set()
    written |= {str(above) for name in written for above in PurePosixPath(name).parents}  # a removal cut short leaves them empty
    strangers = sorted(name for name in names_in(path) - written - {MANIFEST} if not _OWN_NAME.fullmatch(name))
    if strangers:
        raise StorageError(f"{one_line(path)} holds {one_line(strangers[0])!r}, which tactsim did not write; move that away")
