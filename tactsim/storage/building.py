"""A file or folder built beside its place under another name, and moved into place when it is whole.

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
from tactsim.storage.files import beside, naming, sync

MARK = ".tactsim-partial"
"""Name of the file that says whose the folder is; what it holds is for people."""
WORDS = b"This folder is being written by tactsim; if no tactsim runs, it may be removed.\n"
CONTENT = "content"
DATA_SET = "zarr.json"
"""Name of a file by which the folder of a data set, and of each of its arrays, is known."""


def waiting_folder(place: Path) -> Path:
    """The folder in which the content of a place waits until it is whole.

    Raises
    ------
    StorageError
        If the place has no name, as ``.`` and ``/``.
    """
    return beside(place, "partial")


def waiting_content(place: Path) -> Path:
    """Where the content of a place is built."""
    return waiting_folder(place) / CONTENT


def begin(place: Path) -> Path:
    """Makes the marked folder beside a place, and the folders around it; returns where to build.

    Raises
    ------
    StorageError
        If something that is not of tactsim stands in the way, or the folder cannot be made.
    """
    with naming(place):
        place.parent.mkdir(parents=True, exist_ok=True)
        remove_leftover(place)
        waiting_folder(place).mkdir()
        (waiting_folder(place) / MARK).write_bytes(WORDS)  # its name is enough, so that nothing waits for the disk
    return waiting_content(place)


@contextmanager
def built_beside(place: Path) -> Iterator[Path]:
    """A path to build at; when the block ends well, what stands there is moved to ``place``. The caller holds the place's lock.

    Raises
    ------
    StorageError
        If the place is taken, or cannot be written; nothing is replaced.
    """
    with naming(place):
        refuse_taken(place)
    content = begin(place)
    try:
        yield content
        with naming(place):
            _move(content, place)
    finally:
        with suppress(OSError):
            remove_leftover(place)


def refuse_taken(place: Path) -> None:
    """Refuses a place at which something stands, but for an empty folder.

    Raises
    ------
    StorageError
        If it is taken.
    """
    if os.path.lexists(place) and not is_empty(place):
        raise StorageError(f"{one_line(place)} exists; nothing is replaced: choose another place, or move it away")


def refuse_within_data_set(place: Path) -> None:
    """Refuses a new place within a data set, whose check would report it as foreign.

    Raises
    ------
    StorageError
        Naming both.
    """
    around = [folder for folder in Path(os.path.realpath(place)).parents if os.path.lexists(folder / DATA_SET)]
    if around:
        raise StorageError(f"{one_line(place)} lies in the data set {one_line(around[-1])}; choose a place outside it")


def is_marked(folder: Path) -> bool:
    """Whether a waiting folder is of tactsim: it is marked, or empty because its maker was killed before it wrote the mark."""
    if not folder.is_dir() or folder.is_symlink():
        return False
    names = os.listdir(folder)
    return not names or MARK in names


def remove_leftover(place: Path) -> None:
    """Removes what a killed run left beside the place.

    Raises
    ------
    StorageError
        If something of that name is not of tactsim.
    """
    waiting = waiting_folder(place)
    if not os.path.lexists(waiting):
        return
    if not is_marked(waiting):
        raise StorageError(f"{one_line(waiting)} stands in the way and is not of tactsim; move it away")
    remove_marked(waiting, MARK)


def remove_marked(folder: Path, mark: str) -> None:
    """Removes a folder, the file by which it is known last, so that a kill in between leaves a folder that is known."""
    for name in os.listdir(folder):
        if name != mark:
            remove(folder / name)
    (folder / mark).unlink(missing_ok=True)
    folder.rmdir()


def remove(path: Path) -> None:
    """Removes a file, a link, or a folder with all that is in it, if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


@contextmanager
def moved_aside(place: Path, aside: Path) -> Iterator[None]:
    """What stands at a place, moved to another name while the block puts something else there; moved back if the block fails."""
    place.rename(aside)
    try:
        yield
    except BaseException:
        aside.rename(place)
        raise


def settle(content: Path) -> None:
    """Brings a file, or a folder with all files and names in it, down to the disk."""
    for path in [*content.rglob("*"), content] if content.is_dir() else [content]:
        sync(path)


def _move(content: Path, place: Path) -> None:
    """Moves without replacing; the content is on the disk before its name is."""
    settle(content)
    if content.is_dir():
        if is_empty(place):
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


def is_empty(place: Path) -> bool:
    """Whether a folder stands at a place, not a link to one, and nothing in it."""
    return place.is_dir() and not place.is_symlink() and not any(place.iterdir())
