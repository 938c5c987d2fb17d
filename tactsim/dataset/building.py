"""A file or folder built beside its place under a name of its own, and moved into place when it is whole.

While ``data.zarr`` is made, its content stands in ``.data.zarr.partial``, a folder with a mark in it. What a killed run left
there is removed by the next one; a folder or file of that name without the mark belongs to somebody else and is left alone.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tactsim.errors import StorageError
from tactsim.outside.text import one_line
from tactsim.results.locking import beside, only_one
from tactsim.results.storage import naming, sync, write_bytes

MARK = ".tactsim-partial"
"""Name of the file that says whose the folder is; what it holds is for people."""
WORDS = b"This folder is being written by tactsim; if no tactsim runs, it may be removed.\n"
CONTENT = "content"


@contextmanager
def built_beside(place: Path) -> Iterator[Path]:
    """A path to build at; when the block ends well, what stands there is moved to ``place``. The caller owns the place.

    Raises
    ------
    StorageError
        If the place is taken, or cannot be written; nothing is replaced.
    """
    waiting = beside(place, "partial")
    with naming(place):
        place.parent.mkdir(parents=True, exist_ok=True)
        remove_leftover(place)
        refuse_taken(place)
        waiting.mkdir()
        write_bytes(waiting / MARK, WORDS)
    try:
        yield waiting / CONTENT
        with naming(place):
            _move(waiting / CONTENT, place)
    finally:
        with suppress(OSError):
            remove_leftover(place)


@contextmanager
def owned(place: Path, refusal: str) -> Iterator[None]:
    """Keeps other processes from making the same; makes the folder around the place.

    Raises
    ------
    StorageError
        With the text ``refusal`` if another process does.
    """
    with naming(place):
        place.parent.mkdir(parents=True, exist_ok=True)
    with only_one(place, refusal):
        yield


def refuse_taken(place: Path) -> None:
    """Refuses a place at which something stands, but for an empty folder.

    Raises
    ------
    StorageError
        If it is taken.
    """
    if os.path.lexists(place) and not _is_empty(place):
        raise StorageError(f"{one_line(place)} exists; nothing is replaced: choose another place, or move it away")


def remove_leftover(place: Path) -> None:
    """Removes what a run left beside the place that was killed.

    Raises
    ------
    StorageError
        If something of that name is not of tactsim.
    """
    waiting = beside(place, "partial")
    if not os.path.lexists(waiting):
        return
    names = os.listdir(waiting) if waiting.is_dir() and not waiting.is_symlink() else None
    if names is None or (names and MARK not in names):
        raise StorageError(f"{one_line(waiting)} stands in the way and is not of tactsim; move it away")
    for name in names:
        if name != MARK:
            _remove(waiting / name)
    (waiting / MARK).unlink(missing_ok=True)  # last, so that a kill in between leaves a folder that is known
    waiting.rmdir()


def _move(content: Path, place: Path) -> None:
    """Moves without replacing; the content is on the disk before its name is."""
    for path in [*content.rglob("*"), content] if content.is_dir() else [content]:
        sync(path)
    if content.is_dir():
        if _is_empty(place):
            place.rmdir()
        refuse_taken(place)
        content.rename(place)
    else:
        _move_file(content, place)
    sync(place.parent)


def _move_file(content: Path, place: Path) -> None:
    try:
        os.link(content, place)  # unlike a rename it never replaces
    except FileExistsError:
        refuse_taken(place)
        raise
    except OSError:  # a file system without links
        refuse_taken(place)
        content.rename(place)


def _is_empty(place: Path) -> bool:
    return place.is_dir() and not place.is_symlink() and not any(place.iterdir())


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()
