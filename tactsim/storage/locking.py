"""A place that one process at a time may write; the system frees it however that process ends."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tactsim.errors import StorageError
from tactsim.storage.files import beside, naming


@contextmanager
def only_one(path: Path, refusal: str) -> Iterator[None]:
    """Keeps other processes out of a place until the block ends, by whatever link they name it; makes the folder around it.

    Raises
    ------
    StorageError
        With the text ``refusal`` if another process is in it, or if the folder around it cannot be written.
    """
    with naming(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        lock = beside(path.resolve() if path.is_dir() else path, "lock")
        descriptor = _locked(lock, refusal)
    try:
        yield
    finally:
        try:
            with suppress(OSError):
                lock.unlink(missing_ok=True)
        finally:
            os.close(descriptor)


def _locked(lock: Path, refusal: str) -> int:
    """The descriptor of the lock file, which this process now holds."""
    while True:
        descriptor = _opened_alone(lock, refusal)
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(descriptor), os.stat(lock)):
                return descriptor
        os.close(descriptor)  # the last owner removed the file between our opening and locking it


def _opened_alone(lock: Path, refusal: str) -> int:
    try:
        import fcntl
    except ImportError:  # Windows deletes the file with its last handle, so that its existence is the lock
        try:
            return os.open(lock, os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_TEMPORARY", 0))
        except FileExistsError:
            raise StorageError(refusal) from None
    descriptor = os.open(lock, os.O_CREAT | os.O_RDWR, 0o666)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise StorageError(refusal) from None
    return descriptor
