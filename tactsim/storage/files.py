"""Writing whole files, with errors that name the path."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tactsim.errors import StorageError
from tactsim.outside.text import one_line

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)
"""Numbers of the system's refusals of a disk that is full or may not be written."""


@contextmanager
def naming(path: str | Path, verb: str = "write") -> Iterator[None]:
    """Turns the system's refusal into an error that names the path.

    Raises
    ------
    StorageError
        If the system refuses a file within the block, with the path and the reason.
    """
    try:
        yield
    except StorageError:
        raise
    except (OSError, ValueError, RecursionError) as error:
        reason = _file_above(path) or getattr(error, "strerror", None) or one_line(error)
        raise StorageError(f"cannot {verb} {one_line(path)}: {reason}") from error


@contextmanager
def room(path: str | Path) -> Iterator[None]:
    """Tells a full or closed disk from damaged content, within a block that reads and writes.

    Raises
    ------
    StorageError
        If there is no room, with the path and the reason.
    """
    try:
        yield
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        raise StorageError(f"cannot write {one_line(path)}: {error.strerror}") from error


def _file_above(path: str | Path) -> str | None:
    """What stands where a folder is needed, in words; None if nothing does."""
    files = [parent for parent in Path(path).parents if os.path.isfile(parent)]
    return f"{one_line(files[0])} is a file, not a folder; name another place" if files else None


def beside(path: Path, ending: str) -> Path:
    """A hidden name beside a place.

    Raises
    ------
    StorageError
        If the place has no name, as ``.`` and ``/``.
    """
    if not path.name:
        raise StorageError(
            f"cannot write {one_line(path)}: it is a folder without a name of its own; name a file or folder in it"
        )
    return path.with_name(f".{path.name}.{ending}")


def write_bytes(path: Path, content: bytes) -> None:
    """Writes a new file down to the disk, so that a full disk shows here and not later."""
    with open(path, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def sync(path: Path) -> None:
    """Brings a file's content, or the names in a folder, down to the disk; systems that cannot open a folder do so themselves."""
    if os.name == "nt" and path.is_dir():
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def replace_file(path: Path, content: bytes) -> None:
    """Writes a file so that its place holds the earlier or the new content, never a part of it.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    waiting = beside(path, f"{os.getpid()}.partial")
    with naming(path):
        try:
            write_bytes(waiting, content)
            os.replace(waiting, path)
            sync(path.parent)
        finally:
            waiting.unlink(missing_ok=True)


def refuse_few_descriptors(folder: Path, spare: int) -> None:
    """Refuses to begin what would break off later because too few files may be open at once.

    Parameters
    ----------
    folder : that exists, and is meant to be read or written
    spare : files that must still be free to be opened

    Raises
    ------
    StorageError
        With how to raise the limit.
    """
    if os.name == "nt":  # which has no such limit and opens no folders
        return
    opened: list[int] = []
    try:
        opened.append(os.open(folder, os.O_RDONLY))
        opened.extend(os.dup(opened[0]) for _ in range(spare - 1))
    except OSError as error:
        reason = f"{error.strerror}; {spare} files must be free to be opened, raise the limit with: ulimit -n 256"
        raise StorageError(f"cannot use {one_line(folder)}: {reason}") from None
    finally:
        for descriptor in opened:
            os.close(descriptor)
