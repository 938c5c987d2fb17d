"""The one place that opens what comes from outside: regular files of a bounded size, looked for where a user expects them.

A path is looked for beside the case that names it and then in the working folder. Nothing else than a regular file is opened, so
that a pipe cannot block a run, nor a device fill the memory; the size is known before anything is read.
"""

from __future__ import annotations

import errno
import os
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal, Self

from tactsim.errors import InputError, StorageError
from tactsim.outside.text import one_line
from tactsim.shipped import PROGRAM

Place = Literal["beside the case", "in the working folder", "with the program", "elsewhere"]
"""Where a file or folder was found; ``elsewhere`` is outside of all the others, links followed."""
SHIPPED, STORED = "meshes", "cases/stored"
"""Folders of the program, of meshes and of stored results, whose files a case may name from anywhere."""
MEBIBYTE = 2**20
LIMITS = {
    "case file": 1 * MEBIBYTE,
    "table": 256 * MEBIBYTE,
    "mesh": 2048 * MEBIBYTE,
    "surface": 512 * MEBIBYTE,
    "weights": 256 * MEBIBYTE,
    "result": 512 * MEBIBYTE,
    "field file": 2048 * MEBIBYTE,
    "description": 64 * MEBIBYTE,
    "kept file": 2048 * MEBIBYTE,
}
"""Largest file in bytes that is read, by what it is: some ten times what the largest sensible one of its kind takes."""


class CasePath(str):
    """A path as a case file names it, with the folder of that file, in which it is looked for first."""

    __slots__ = ("beside",)
    beside: Path | None

    def __new__(cls, text: str, beside: Path | None = None) -> Self:
        """The text, and the folder beside which it stands."""
        path = super().__new__(cls, text)
        path.beside = beside
        return path

    def __getnewargs__(self) -> tuple[str, Path | None]:  # type: ignore[override]  # pickle calls __new__ with these
        return str(self), self.beside


class Unreadable(StorageError):
    """A file or folder is missing, is no regular one, is too large or may not be read; ``reason`` says which."""

    def __init__(self, message: str, reason: str):
        super().__init__(message)
        self.reason = reason


class TooLarge(Unreadable):
    """A file is larger than anything of its kind."""


@dataclass(frozen=True)
class OutsideFile:
    """A file that may be read: what it is, how the user named it, where it was found and how long it was in bytes.

    It is ``quotable`` in messages unless a case, which may be a stranger's, names a file that stands anywhere on the machine.
    """

    kind: str
    named: str
    path: Path
    size: int
    limit: int
    quotable: bool = True
    beside: Path | None = None
    """Folder of the case that names it."""

    @property
    def place(self) -> Place:
        """Where it stands, links followed."""
        return _place(self.path, self.beside)

    def read(self) -> bytes:
        """The content.

        Raises
        ------
        Unreadable
            If it has become something else, or longer than the limit, in the meantime.
        """
        try:
            with self.stream() as file:
                content = bytearray()
                while chunk := file.read(MEBIBYTE):
                    content += chunk
                    if len(content) > self.limit:
                        raise _too_large(self.kind, self.named, self.limit)
        except Unreadable:
            raise
        except (OSError, ValueError) as error:
            raise _refused(self.kind, self.named, error) from None
        return bytes(content)

    def stream(self) -> BinaryIO:
        """The file, open for reading from its begin.

        Raises
        ------
        Unreadable
            If it has become something else, or longer than the limit, in the meantime.
        OSError
            If the system refuses.
        """
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOCTTY", 0)
        file = open(self.path, "rb", opener=lambda name, mode: os.open(name, flags))  # noqa: SIM115  the caller closes it
        try:
            _check(os.fstat(file.fileno()), self.kind, self.named, self.limit)
        except Unreadable:
            file.close()
            raise
        return file

    def text(self) -> str:
        """The content as UTF-8, with or without a byte order mark.

        Raises
        ------
        Unreadable
            If it cannot be read or is not UTF-8.
        """
        try:
            return self.read().decode("utf-8-sig")
        except UnicodeDecodeError as error:
            reason = f"byte {error.object[error.start]:#04x} at {error.start} is not UTF-8 text"
            raise Unreadable(f"cannot read the {self.kind} {one_line(self.named)}: {reason}; save it as UTF-8", reason) from None


def opened(path: str | Path, kind: str, limit: int | None = None) -> OutsideFile:
    """The file that a user names, checked but not read.

    Parameters
    ----------
    path : as the user wrote it; a ``CasePath`` that is not absolute is looked for beside its case and then in the working folder
    kind : what it is, one of ``LIMITS``, as messages call it
    limit : largest size in bytes, by default that of the kind

    Raises
    ------
    Unreadable
        If there is none, it is no regular file, or it is too large.
    """
    limit = LIMITS[kind] if limit is None else limit
    candidate, beside, state = _looked_up(path, kind)
    _check(state, kind, str(path), limit)
    quotable = not isinstance(path, CasePath) or _place(candidate, beside) != "elsewhere"
    return OutsideFile(kind, str(path), candidate, state.st_size, limit, quotable, beside)


def named_path(given: object, what: str) -> Path:
    """The path that a user gave in Python; ``what`` it is of begins the message.

    Raises
    ------
    InputError
        If it is no path and no text.
    """
    if not isinstance(given, str | os.PathLike):
        raise InputError(f"{what}: needed: a path or a text, not {one_line(repr(given), 60)}")
    return Path(given)


def opened_folder(path: str | Path, kind: str) -> tuple[Path, Place]:
    """The folder that a user names, looked for as ``opened`` does, and where it stands.

    Raises
    ------
    Unreadable
        If there is none, or it is no folder.
    """
    named = f"{one_line(path)} is not a folder with a {kind}"
    try:
        folder, beside, state = _looked_up(path, kind)
    except Unreadable as error:
        raise Unreadable(f"{named}: {error.reason}", error.reason) from None
    if not stat.S_ISDIR(state.st_mode):
        raise Unreadable(named, "it is not a folder")
    return folder, _place(folder, beside)


def located(path: str | Path) -> Place:
    """Where a file or folder stands that a user names, looked for as ``opened`` does.

    Raises
    ------
    Unreadable
        If there is none, or it is neither a regular file nor a folder.
    """
    candidate, beside, state = _looked_up(path, "file")
    if not stat.S_ISDIR(state.st_mode):
        _check(state, "file", str(path), state.st_size)
    return _place(candidate, beside)


def _looked_up(path: str | Path, kind: str) -> tuple[Path, Path | None, os.stat_result]:
    """The first of the places looked at that holds something, the folder of the case that names it, and its state."""
    beside = path.beside if isinstance(path, CasePath) else None
    tried: list[str] = []
    refusal: OSError | ValueError = FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
    for folder in _folders(Path(path), beside):
        candidate = folder / path
        try:
            state = os.stat(candidate)
        except (OSError, ValueError) as error:
            refusal = refusal if isinstance(error, FileNotFoundError) else error
            tried += [{Path(): "the working folder", PROGRAM: "what comes with tactsim"}.get(folder, "the folder of the case")]
            continue
        return candidate, beside, state
    looked = f"; looked in {' and in '.join(tried)}" if len(tried) > 1 else ""
    raise _refused(kind, str(path), refusal, looked)


def _folders(path: Path, beside: Path | None) -> list[Path]:
    if path.is_absolute():
        return [Path()]
    first = [] if beside is None or os.path.realpath(beside) == os.path.realpath(".") else [beside]
    shipped = ".." not in path.parts and any(path.is_relative_to(folder) for folder in (SHIPPED, STORED))
    return [*first, Path(), *([PROGRAM] if shipped else [])]


def _place(path: Path, beside: Path | None) -> Place:
    """Where a path leads once its links are followed."""
    real = Path(os.path.realpath(path))
    roots: list[tuple[Place, Path]] = [("beside the case", beside)] if beside is not None else []
    shipped: list[tuple[Place, Path]] = [("with the program", PROGRAM / folder) for folder in (SHIPPED, STORED)]
    roots += [("in the working folder", Path(".")), *shipped]
    for place, root in roots:
        if real.is_relative_to(os.path.realpath(root)):
            return place
    return "elsewhere"


def _check(state: os.stat_result, kind: str, named: str, limit: int) -> None:
    if not stat.S_ISREG(state.st_mode):
        reason = f"it is {_what(state.st_mode)}; allowed: a regular file"
        raise Unreadable(f"cannot read the {kind} {one_line(named)}: {reason}", reason)
    if state.st_size > limit:
        raise _too_large(kind, named, limit)


def _too_large(kind: str, named: str, limit: int) -> TooLarge:
    reason = f"it is larger than {limit} bytes, which no {kind} needs"
    return TooLarge(f"cannot read the {kind} {one_line(named)}: {reason}", reason)


def _refused(kind: str, named: str, error: OSError | ValueError, looked: str = "") -> Unreadable:
    reason = f"{getattr(error, 'strerror', None) or one_line(error)}{looked}"
    return Unreadable(f"cannot read the {kind} {one_line(named)}: {reason}", reason)


def _what(mode: int) -> str:
    kinds = ((stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"))
    return next((name for test, name in kinds if test(mode)), "a device")
