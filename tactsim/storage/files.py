"""Writing whole files, with errors that name the path."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tactsim.errors import StorageError
from tactsim.outside.text import one_line


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
        reason = getattr(error, "strerror", None) or one_line(error)
        raise StorageError(f"cannot {verb} {one_line(path)}: {reason}") from error


def beside(path: Path, ending: str) -> Path:
    """A hidden name beside a place."""
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
