"""A live feed from a file, a pipe and a socket."""

from __future__ import annotations

import asyncio
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from live_pages import description, frame_line, line

from tactsim.errors import InputError, StorageError
from tactsim.live.sources.feed import Feed
from tactsim.live.sources.feed_sources import FeedPlace, feeding


async def until(condition: Callable[[], bool], seconds: float = 10.0) -> None:
    """Waits for a condition."""
    async with asyncio.timeout(seconds):
        while not condition():
            await asyncio.sleep(0.005)


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def test_a_malformed_line_is_counted_with_its_place_and_the_next_is_read() -> None:
    feed = Feed("test")
    stream = feed.stream()
    stream.take(line(description()) + b"nonsense\n" + line(frame_line(1.0)))
    assert (feed.state_now()["frames"], feed.state_now()["malformed"]) == (1, 1)
    assert feed.state_now()["fault"].startswith("line 2: not JSON")
    assert feed.frame is not None
    assert feed.frame.time == 1.0
    stream.take(line(description(4)))
    assert feed.frame is None, "another description begins anew"


def test_a_growing_file_is_followed_and_a_new_one_is_read_anew(tmp_path: Path) -> None:
    path = tmp_path / "frames.jsonl"
    path.write_bytes(line(description()) + line(frame_line(1.0))[:20])

    async def check() -> None:
        feed = Feed("file")
        async with feeding(feed, FeedPlace.of(str(path))):
            await until(lambda: feed.scene is not None)
            assert feed.frame is None, "half a line is no frame"
            with open(path, "ab") as file:
                file.write(line(frame_line(1.0))[20:] + line(frame_line(2.0)))
            await until(lambda: feed.state_now()["frames"] == 2)
            path.write_bytes(line(description()) + line(frame_line(9.0)))
            await until(lambda: feed.frame is not None and feed.frame.time == 9.0)
            path.unlink()
            await until(lambda: "cannot be read" in feed.state)

    asyncio.run(check())


def test_a_socket_takes_one_sender_at_a_time_and_the_next_after_it() -> None:
    port = free_port()

    async def check() -> None:
        feed = Feed("socket")
        async with feeding(feed, FeedPlace.of(f"tcp://127.0.0.1:{port}")):
            _, first = await asyncio.open_connection("127.0.0.1", port)
            first.write(line(description()) + line(frame_line(1.0)))
            await until(lambda: feed.state_now()["frames"] == 1)
            reader, second = await asyncio.open_connection("127.0.0.1", port)
            assert await reader.read() == b"", "closed at once"
            assert "second connection" in feed.state_now()["fault"]
            first.close()
            await until(lambda: "has gone" in feed.state)
            _, third = await asyncio.open_connection("127.0.0.1", port)
            third.write(line(frame_line(2.0)))
            await until(lambda: feed.frame is not None and feed.frame.time == 2.0)
            for writer in (second, third):
                writer.close()

    asyncio.run(check())


def test_what_a_browser_posts_to_the_socket_is_not_taken() -> None:
    port = free_port()

    async def check() -> None:
        feed = Feed("socket")
        async with feeding(feed, FeedPlace.of(f"tcp://127.0.0.1:{port}")):
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(b"POST / HTTP/1.1\r\nHost: x\r\n\r\n" + line(description()) + line(frame_line()))
            assert await reader.read() == b""
            assert feed.scene is None
            assert "connection was closed" in feed.state_now()["fault"]
            writer.close()

    asyncio.run(check())


@pytest.mark.parametrize(
    "text", ["tcp://0.0.0.0:80", "tcp://192.168.1.2:80", "tcp://example.org:80", "tcp://127.0.0.1", "tcp://:1"]
)
def test_a_socket_elsewhere_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"127\.0\.0\.1:"):
        FeedPlace.of(text)


def test_a_missing_file_and_a_busy_port_are_told(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="cannot read"):
        FeedPlace.of(str(tmp_path / "none"))
    with pytest.raises(StorageError, match="is a folder"):
        FeedPlace.of(str(tmp_path))

    async def check() -> None:
        async with feeding(Feed("socket"), place):
            pass

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        place = FeedPlace.of(f"tcp://127.0.0.1:{taken.getsockname()[1]}")
        with pytest.raises(StorageError, match="cannot listen"):
            asyncio.run(check())


PIPE = """
import asyncio, sys
from tactsim.live.sources.feed import Feed
from tactsim.live.sources.feed_sources import FeedPlace, feeding

async def main():
    feed = Feed("pipe")
    async with feeding(feed, FeedPlace.of("-")):
        async with asyncio.timeout(20):
            while "ended" not in feed.state:
                await asyncio.sleep(0.01)
    sys.stdout.write(f"{feed.state_now()['frames']} {feed.state_now()['malformed']} {feed.frame.time}")

asyncio.run(main())
"""


def test_a_pipe_is_read_to_its_end_and_the_last_frame_stays() -> None:
    content = line(description()) + b"".join(line(frame_line(float(k))) for k in range(300)) + b"?\n"
    found = subprocess.run(
        [sys.executable, "-W", "error", "-c", PIPE], input=content, capture_output=True, timeout=60, check=False
    )
    assert (found.returncode, found.stderr.decode()) == (0, "")
    assert found.stdout.decode() == "300 1 299.0"
