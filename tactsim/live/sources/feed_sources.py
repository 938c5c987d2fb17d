"""Where the frames of a live feed come from: a file that grows, standard input, or a socket on this machine."""

from __future__ import annotations

import asyncio
import ipaddress
import os
import sys
import threading
from collections.abc import AsyncIterator, Callable
from concurrent.futures import CancelledError
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from tactsim.errors import InputError, StorageError
from tactsim.live.defects import LOGGER
from tactsim.live.sources.feed import Feed
from tactsim.outside.files import OutsideFile, Unreadable, opened
from tactsim.outside.text import one_line

CHUNK = 2**16
"""Bytes that are read at once."""
POLL = 0.01
"""Time in s after which a file that has ended is looked at again."""
KIND = "file of frames"
LONGEST_FILE = 2**50
"""Bytes: it is read piece by piece and may grow for ever."""
SCHEME = "tcp://"


@dataclass(frozen=True)
class FeedPlace:
    """What ``--live`` names: a file, standard input (neither is set), or a socket."""

    file: OutsideFile | None = None
    socket: tuple[str, int] | None = None

    @classmethod
    def of(cls, text: str) -> FeedPlace:
        """The place that the text of ``--live`` names.

        Raises
        ------
        InputError
            If it is a socket on another address than the loopback one.
        StorageError
            If it is a file that does not exist, cannot be read or is no regular file, such as a named pipe.
        """
        if text == "-":
            return cls()
        if text.startswith(SCHEME):
            return cls(socket=_socket(text))
        try:
            return cls(file=opened(text, KIND, LONGEST_FILE))
        except Unreadable as error:
            raise StorageError(f"--live: {error}{_advice(text)}") from None

    @property
    def name(self) -> str:
        """How the page calls it."""
        if self.socket:
            return f"{SCHEME}{self.socket[0]}:{self.socket[1]}"
        return "standard input" if self.file is None else one_line(self.file.path.name)


def _advice(text: str) -> str:
    """What to do with something that is there but is no file."""
    if Path(text).is_dir() or not Path(text).exists():
        return ""
    return f"; a pipe is taken from standard input: tactsim show --web --live - < {one_line(text)}"


def _socket(text: str) -> tuple[str, int]:
    try:
        parts = urlsplit(text)
        host, port = parts.hostname or "", parts.port
    except ValueError:
        host, port = "", None
    if port is None or parts.path or parts.query:
        raise InputError(f"--live {one_line(text)}: not a socket; write tcp://127.0.0.1:PORT")
    if not is_loopback(host):
        raise InputError(
            f"--live {one_line(text)}: the socket listens on this machine only; write tcp://127.0.0.1:{port}, "
            "and forward a sensor elsewhere through a tunnel"
        )
    return host, port


def is_loopback(host: str) -> bool:
    """Whether a host is this machine as seen by itself."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@asynccontextmanager
async def feeding(feed: Feed, place: FeedPlace) -> AsyncIterator[None]:
    """A block during which the feed takes what its place gives.

    Raises
    ------
    StorageError
        If the socket cannot be opened.
    """
    if place.socket:
        async with _listening(feed, *place.socket):
            yield
        return
    if place.file is None:
        _read_input(feed, asyncio.get_running_loop())
        yield
        return
    task = asyncio.create_task(_follow(feed, place.file))
    try:
        yield
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


async def _follow(feed: Feed, source: OutsideFile) -> None:
    """Reads a file from its begin and goes on when it grows; one that is shorter than before, or another, is read anew."""
    while True:
        try:
            with source.stream() as file:
                await _follow_file(feed, source.path, file.read, file.fileno())
        except StorageError as error:
            feed.end(one_line(error))
        except OSError as error:
            feed.end(f"{one_line(source.path.name)} cannot be read: {error.strerror}")
        await asyncio.sleep(0.2)


async def _follow_file(feed: Feed, path: Path, read: Callable[[int], bytes], descriptor: int) -> None:
    stream, position = feed.stream(), 0
    while True:
        chunk = read(CHUNK)
        if chunk:
            position += len(chunk)
            stream.take(chunk)
            await asyncio.sleep(0)
            continue
        now, there = os.fstat(descriptor), os.stat(path)
        if now.st_size < position or (now.st_dev, now.st_ino) != (there.st_dev, there.st_ino):
            return
        await asyncio.sleep(POLL)


def _read_input(feed: Feed, loop: asyncio.AbstractEventLoop) -> None:
    """Reads standard input in a separate thread, which may wait for ever and ends with the process."""
    if sys.stdin is None:  # the caller closed it before the start
        feed.end("standard input is closed")
        return
    stream, descriptor = feed.stream(), sys.stdin.fileno()

    async def take(chunk: bytes) -> None:
        stream.take(chunk) if chunk else feed.end("the input has ended; the last frame stays")

    def read() -> None:
        try:
            chunk = b"?"
            while chunk:
                chunk = os.read(descriptor, CHUNK)
                work = take(chunk)
                try:
                    asyncio.run_coroutine_threadsafe(work, loop).result()
                finally:
                    work.close()
        except (RuntimeError, OSError, ValueError, CancelledError):
            return  # the page was closed in the meantime
        except Exception:  # noqa: BLE001  a defect in a thread would print a traceback
            LOGGER.exception("the live input")

    threading.Thread(target=read, daemon=True, name="live input").start()


@asynccontextmanager
async def _listening(feed: Feed, host: str, port: int) -> AsyncIterator[None]:
    busy, open_ones = asyncio.Lock(), set[asyncio.StreamWriter]()

    async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        open_ones.add(writer)
        try:
            if busy.locked():
                feed.blame("a second connection was refused: another one is sending")
                return
            async with busy:
                await _receive(feed, reader)
        except (OSError, asyncio.CancelledError):
            return
        finally:
            open_ones.discard(writer)
            writer.close()

    try:
        server = await asyncio.start_server(connected, host, port)
    except OSError as error:
        raise StorageError(f"cannot listen on {SCHEME}{host}:{port}: {error.strerror or error}") from None
    try:
        yield
    finally:
        server.close()
        for writer in tuple(open_ones):  # a sender that goes on sending must not hold up the end
            writer.transport.abort()


async def _receive(feed: Feed, reader: asyncio.StreamReader) -> None:
    """Takes a connection; one that does not begin with lines of this format, such as a browser's, is closed at once."""
    stream = feed.stream(trusted=False)
    while chunk := await reader.read(CHUNK):
        stream.take(chunk)
        if stream.refused:
            feed.blame("a connection was closed: its first line is neither a description nor a frame")
            return
        await asyncio.sleep(0)
    feed.end("the sender has gone; the last frame stays")
