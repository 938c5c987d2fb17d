"""What strangers send to the live page: an answer in words for them, nothing in the terminal, and no other page is disturbed."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from live_pages import description, frame_line, grasp_folder, line, made_up_store

from tactsim.errors import InputError
from tactsim.live.commands import read_command
from tactsim.live.defects import LOGGER, telling_defects
from tactsim.live.feed import Feed

END = 2.0
"""Time in s in which Ctrl-C must end the page."""
OP_TEXT, OP_BINARY, OP_CLOSE = 1, 2, 8


@dataclass
class Served:
    """A page in a process of its own."""

    process: subprocess.Popen[str]
    port: int
    token: str

    def connected(self) -> socket.socket:
        """A connection."""
        return socket.create_connection(("127.0.0.1", self.port), timeout=10)

    def asked(self, request: bytes) -> bytes:
        """The first bytes of the answer to a raw request, empty if the connection was closed without one."""
        with self.connected() as connection, suppress(ConnectionError):
            connection.sendall(request)
            return connection.recv(4096)
        return b""

    def page(self) -> socket.socket:
        """A web socket after its handshake."""
        connection = self.connected()
        key = base64.b64encode(os.urandom(16)).decode()
        origin = f"http://127.0.0.1:{self.port}"
        head = f"GET /{self.token}/ws HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nOrigin: {origin}\r\nUpgrade: websocket\r\n"
        connection.sendall(f"{head}Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode())
        answer = b""
        while b"\r\n\r\n" not in answer:
            answer += connection.recv(1)
        assert b" 101 " in answer.splitlines()[0]
        return connection

    def answers(self) -> bool:
        """Whether the page is still served."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/{self.token}/", timeout=5) as answer:
            return b"<title>tactsim</title>" in answer.read()

    def ended(self) -> tuple[float, str]:
        """The time in s that the end took after Ctrl-C, and what stood in the terminal."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        _, said = self.process.communicate(timeout=60)
        assert self.process.returncode == 0
        return time.monotonic() - begin, said


@contextmanager
def served(*arguments: str, **options: object) -> Iterator[Served]:
    """The command in a process of its own, once it has told its address."""
    command = [sys.executable, "-W", "error", "-m", "tactsim.cli", "show", *arguments, "--web", "--no-browser"]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    with subprocess.Popen(command, text=True, **streams) as process:  # type: ignore[call-overload]
        try:
            address = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/([\w-]{32})/", process.stdout.readline().strip())
            assert address, process.stderr.read()
            yield Served(process, int(address[1]), address[2])
        finally:
            process.kill()


def framed(content: bytes, kind: int = OP_TEXT, *, first: int | None = None) -> bytes:
    """A masked frame of a web socket."""
    length = len(content)
    size = (
        bytes([0x80 | length])
        if length < 126
        else struct.pack("!BH" if length < 65536 else "!BQ", 0xFE + (length >= 65536), length)
    )
    return bytes([0x80 | kind if first is None else first]) + size + bytes(4) + content


def received(connection: socket.socket) -> Iterator[tuple[int, bytes]]:
    """Frames of the server until it closes."""
    file = connection.makefile("rb")
    while head := file.read(2):
        length = head[1] & 127
        if length > 125:
            length = int.from_bytes(file.read(2 if length == 126 else 8))
        yield head[0] & 15, file.read(length)


def fault_or_code(connection: socket.socket) -> str:
    """The words of the first fault that the server sends, or the code with which it closes."""
    for kind, content in received(connection):
        if kind == OP_CLOSE:
            return str(int.from_bytes(content[:2]))
        if kind == OP_TEXT and json.loads(content)["is"] == "fault":
            return str(json.loads(content)["words"])
    return "cut"


def requests(token: str) -> list[tuple[bytes, bytes]]:
    """Raw requests and what the first line of the answer must hold."""
    host = b"Host: 127.0.0.1\r\n"
    mine, upgrade = f"/{token}".encode(), b"Upgrade: websocket\r\nConnection: upgrade\r\nOrigin: http://127.0.0.1\r\n"
    ask = lambda first, more=b"": first + b" HTTP/1.1\r\n" + host + more + b"\r\n"  # noqa: E731
    return [
        (ask(b"OPTIONS *"), b" 403 "),
        (ask(b"CONNECT evil.example:443"), b" 40"),
        (ask(b"CONNECT *"), b" 40"),
        (ask(b"GET " + mine + b"/" + b"x" * 300 + b".js"), b" 404 "),
        (ask(b"GET " + mine + b"/" + b"a/" * 2000 + b"x.js"), b" 404 "),
        (ask(b"GET " + mine + b"/a%00.js"), b" 404 "),
        (ask(b"GET " + mine + b"/%ff%fe.js"), b" 40"),
        (ask(b"GET " + mine + b"/\xff\xfe.js"), b" 40"),
        (ask(b"GET /\xff\xfe"), b" 40"),
        (ask(b"GET " + mine + b"/%2e%2e/%2e%2e/server.py"), b" 40"),
        (ask(b"GET http://evil.example" + mine + b"/"), b" "),
        (ask(b"GET //"), b" 403 "),
        (ask(b"GET *"), b" 40"),
        (ask(b"GET /", b"X: " + b"a" * 100_000 + b"\r\n"), b" 400 "),
        (ask(b"GET /" + b"a" * 100_000), b" 400 "),
        (ask(b"GET /", b"".join(b"X-%d: 1\r\n" % k for k in range(2000))), b" 400 "),
        (ask(b"GET /", b"Content-Length: -1\r\n"), b" 400 "),
        (ask(b"GET /", b"Content-Length: 99999999999999999999\r\n"), b" 4"),
        (ask(b"GET /", b"Transfer-Encoding: chunked\r\n") + b"zz\r\n", b" 4"),
        (ask(b"POST " + mine + b"/", b"Content-Length: 1000000000\r\n") + b"x" * 1000, b" 405 "),
        (ask(b"POST " + mine + b"/", b"Content-Encoding: deflate\r\nContent-Length: 4\r\n") + b"\xff\xff\xff\xff", b" 4"),
        (ask(b"GET /", b"Expect: the-unexpected\r\n"), b" 4"),
        (ask(b"BREW " + mine + b"/"), b" 40"),
        (ask(b"DELETE " + mine + b"/page.js"), b" 405 "),
        (ask(b"G\x00T /"), b" 400 "),
        (b"GET " + mine + b"/ HTTP/1.1\r\n\r\n", b" 40"),
        (b"GET " + mine + b"/ HTTP/1.0\r\n\r\n", b" 403 "),
        (b"GET " + mine + b"/ HTTP/1.1\r\nHost: [::1\r\n\r\n", b" 40"),
        (b"GET " + mine + b"/ HTTP/1.1\r\nHost: \xff\xfe\r\n\r\n", b" 40"),
        (b"GET " + mine + b"/ HTTP/1.1\r\nHost: 127.0.0.1:99999999\r\n\r\n", b" "),
        (b"GET / HTTP/9.9\r\n\r\n", b" 4"),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(500), b" 400 "),
        (b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", b" 4"),
        (b"\r\n\r\n\x00\x00\r\n\r\n", b" 400 "),
        (ask(b"GET " + mine + b"/ws"), b" 403 "),
        (ask(b"GET " + mine + b"/ws", upgrade + b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: \xff\xfe\r\n"), b" 400 "),
        (ask(b"GET " + mine + b"/ws", upgrade + b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: \xc3\xa4\r\n"), b" 400 "),
        (ask(b"GET " + mine + b"/ws", upgrade + b"Sec-WebSocket-Version: 99\r\nSec-WebSocket-Key: x\r\n"), b" 400 "),
        (
            ask(b"GET " + mine + b"/ws", upgrade + b"Sec-WebSocket-Protocol: a, \x1b[31m\r\nSec-WebSocket-Version: x\r\n"),
            b" 400 ",
        ),
    ]


FRAMES = {
    "a step that is no number": (framed(b'{"do":"show","step":1e400}'), "could not be read"),
    "a step that is not a number": (framed(b'{"do":"show","step":NaN}'), "could not be read"),
    "a step before the first": (framed(b'{"do":"show","step":-1}'), "greater than or equal to 0"),
    "a step of 4000 digits": (framed(b'{"do":"show","step":' + b"9" * 4000 + b"}"), "could not be read"),
    "true for a step": (framed(b'{"do":"show","step":true}'), "could not be read"),
    "a deep list": (framed(b"[" * 4000), "could not be read"),
    "no JSON": (framed(b"hello"), "could not be read"),
    "a number": (framed(b"7"), "does not know"),
    "an unknown verb": (framed(b'{"do":"__class__"}'), "does not know"),
    "a verb that is a list": (framed(b'{"do":["show"]}'), "does not know"),
    "null": (framed(b"null"), "does not know"),
    "an unknown key": (framed(b'{"do":"play","\\u001b[31m":1}'), "play.\\x1b[31m"),
    "a name with an escape": (framed(b'{"do":"estimator","name":"\\u001b[31m\\u202e"}'), "\\x1b[31m\\u202e"),
    "a lone surrogate": (framed(b'{"do":"source","name":"\\ud800"}'), "could not be read"),
    "a long name": (framed(b'{"do":"source","name":"' + b"x" * 3000 + b'"}'), "at most 200"),
    "bytes": (framed(b"\x00\xff", OP_BINARY), "must be a text message"),
    "a sample without samples": (framed(b'{"do":"sample","number":1}'), "no samples"),
    "a sample and a move": (framed(b'{"do":"sample","number":1,"move":1}'), "either number or move"),
    "too long": (framed(b" " * 5000), "1009"),
    "longer than memory": (b"\x81\xff" + struct.pack("!Q", 2**62) + bytes(4), "10"),
    "not UTF-8": (framed(b"\xff\xfe\xff"), "1007"),
    "an unknown kind": (framed(b"x", first=0x83), "1002"),
    "compressed": (framed(b"x", first=0xC1), "1002"),
    "an endless part": (framed(b"x", first=0x01) + framed(b"x", first=0x00) * 5000, "1009"),
    "a part of nothing": (framed(b"x", first=0x80), "1002"),
    "a long ping": (framed(b"x" * 126, first=0x89), "1002"),
    "a close without reason": (framed(b"\x00", OP_CLOSE), "1002"),
}


def test_nothing_that_strangers_send_reaches_the_terminal_or_another_page(tmp_path: Path) -> None:
    with served(str(grasp_folder(tmp_path / "grasp"))) as server, server.page() as other:
        for request, status in requests(server.token):
            answer = server.asked(request)
            assert status in answer.partition(b"\r\n")[0], (request[:80], answer[:200])
            assert b" 500 " not in answer.partition(b"\r\n")[0], request[:80]
            assert b"Traceback" not in answer
        for name, (frame, words) in FRAMES.items():
            with server.page() as page:
                page.sendall(frame)
                assert words in fault_or_code(page), name
        assert server.answers()
        other.sendall(framed(b'{"do":"show","step":0}') + framed(b"[]"))
        assert "does not know" in fault_or_code(other), "the page that was open all the time still has answers"
        duration, said = server.ended()
    assert said == ""
    assert duration < END


def test_many_idle_connections_and_pages_leave_room_for_others(tmp_path: Path) -> None:
    with served(str(grasp_folder(tmp_path / "grasp"))) as server:
        idle = [server.connected() for _ in range(100)]
        for connection in idle[:50]:
            connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
        pages = [server.page() for _ in range(32)]
        origin = f"http://127.0.0.1:{server.port}".encode()
        upgrade = b"Upgrade: websocket\r\nConnection: upgrade\r\nOrigin: " + origin
        address = f"GET /{server.token}/ws HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n".encode()
        assert b" 429 " in server.asked(address + upgrade + b"\r\n\r\n")
        assert server.answers()
        for connection in idle + pages:
            connection.close()
        time.sleep(0.5)
        with server.page() as page:
            page.sendall(framed(b"?"))
            assert "could not be read" in fault_or_code(page)
        assert server.ended()[1] == ""


def test_the_page_ends_at_once_with_pages_that_do_not_listen_a_sender_and_an_estimate_under_way(tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    folder = str(grasp_folder(tmp_path / "grasp"))
    with (
        served(folder, "--live", f"tcp://127.0.0.1:{port}", "--reference", folder) as server,
        socket.create_connection(("127.0.0.1", port)) as sender,
        server.page() as deaf,
        server.page() as lost,
    ):
        sender.sendall(line(description()) + b"".join(line(frame_line(float(k))) for k in range(100)))
        deaf.sendall(framed(b'{"do":"estimator","name":"hypotheses"}') + framed(b"?") * 2000)
        lost.sendall(framed(b'{"do":"play"}'))
        time.sleep(1.0)
        duration, said = server.ended()
    assert said == ""
    assert duration < END


@pytest.mark.parametrize("source", ["file", "input"])
def test_the_page_ends_at_once_with_a_feed_that_goes_on(tmp_path: Path, source: str) -> None:
    frames = tmp_path / "frames.jsonl"
    frames.write_bytes(line(description()) + line(frame_line(1.0)))
    with served("--live", str(frames) if source == "file" else "-", stdin=subprocess.PIPE) as server:
        if source == "input":
            server.process.stdin.write(frames.read_text())
            server.process.stdin.flush()
        time.sleep(0.3)
        begin = time.monotonic()
        server.process.send_signal(signal.SIGINT)
        assert server.process.wait(timeout=60) == 0
        assert time.monotonic() - begin < END
        assert server.process.stderr.read() == ""


def test_a_page_of_samples_bears_any_command(tmp_path: Path) -> None:
    commands = [
        b'{"do":"sample","number":%s}' % number
        for number in (b"-1", b"6", b"999999999999", b"1.5", b"null", b'"1"', b"[]", b"true")
    ] + [b'{"do":"filter","split":"\\u0000","status":"done"}', b'{"do":"filter","split":[]}', b'{"do":"sample","move":0}']
    with served(str(made_up_store(tmp_path))) as server:
        for command in commands:
            with server.page() as page:
                page.sendall(framed(command))
                assert len(fault_or_code(page)) > 4, command
        assert server.ended()[1] == ""


@pytest.mark.parametrize("how", ["fifo", "device"])
def test_a_pipe_or_a_device_as_a_file_of_frames_is_refused_with_advice(tmp_path: Path, how: str) -> None:
    place = tmp_path / "frames"
    os.mkfifo(place) if how == "fifo" else place.symlink_to("/dev/zero")
    command = [sys.executable, "-m", "tactsim.cli", "show", "--web", "--no-browser", "--live", str(place)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    assert done.returncode == 5
    assert "allowed: a regular file" in done.stderr
    assert "--live - < " in done.stderr


def test_a_closed_standard_input_is_told_on_the_page(tmp_path: Path) -> None:
    with served("--live", "-", preexec_fn=lambda: os.close(0)) as server, server.page() as page:
        told = [json.loads(content) for kind, content in take(received(page), 6) if kind == OP_TEXT]
        assert any(one.get("state") == "standard input is closed" for one in told)
        assert server.ended()[1] == ""


def take(frames: Iterator[tuple[int, bytes]], seconds: float) -> Iterator[tuple[int, bytes]]:
    """Frames until one says how the feed is doing, or the time is up."""
    end = time.monotonic() + seconds
    for frame in frames:
        yield frame
        if b'"is":"feed"' in frame[1] or time.monotonic() > end:
            return


def test_a_line_without_end_takes_no_memory_and_garbage_is_counted() -> None:
    import tracemalloc

    feed = Feed("test")
    stream = feed.stream()
    stream.take(line(description(title="a\x1b[31m\r\nb\u202e")))
    assert feed.scene is not None
    assert feed.scene.title == "a\\x1b[31m\\r\\nb\\u202e"
    chunk = b"[" * 2**20
    tracemalloc.start()
    for _ in range(100):
        stream.take(chunk)
    assert tracemalloc.get_traced_memory()[1] < 64 * 2**20, "a line is at most 8 MiB, whatever comes"
    tracemalloc.stop()
    bad = [
        b"[" * 100_000,
        b'{"schema":"tactsim/frames/1","\\u001b[31m":1}',
        b'{"time":1e400}',
        b"\xff\xfe",
        b"9" * 5000,
        b'{"time":' + b"9" * 400 + b"}",
        line(description(block_size=[1e300, 1, 1])).strip(),
        line(description(block_size=[1e-300, 1, 1])).strip(),
        line(description() | {"matrix": {"rows": 10**9}}).strip(),
        line(frame_line() | {"taxel_force_upper": [[{"a": []}] * 3] * 3}).strip(),
    ]
    stream.take(b"\n" + b"\n".join(bad) + b"\n")
    assert feed.counts.malformed == 1 + len(bad)
    assert feed.counts.fault.isprintable()
    stream.take(line(frame_line(2.0)))
    assert feed.counts.frames == 1


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["do", "step", "name", "number"]), inner, max_size=3)
    ),
    max_leaves=6,
)
KEYS = st.sampled_from(["do", "step", "name", "number", "move", "split", "status", "x"])
VERBS = st.sampled_from(["drawn", "play", "pause", "show", "estimator", "source", "sample", "filter"])


@settings(derandomize=True, deadline=None, max_examples=200, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.text(max_size=40)
    | st.builds(lambda verb, more: json.dumps({**more, "do": verb}), VERBS, st.dictionaries(KEYS, JSON, max_size=3))
)
def test_any_command_is_read_or_refused_in_a_line(text: str) -> None:
    said = "ok"
    try:
        read_command(text)
    except InputError as error:
        said = str(error)
    assert len(said) < 400
    assert said.isprintable()


def test_a_defect_is_told_in_one_line_and_once() -> None:
    told: list[str] = []
    with telling_defects(told.append):
        for _ in range(3):
            LOGGER.error("x", exc_info=ValueError("a\x1b[31m\nb"))
        asyncio.run(_failing_task())
    assert told[0] == "warning: internal error of the page (ValueError: a\\x1b[31m\\nb); please report it"
    assert len(told) == 2
    assert "KeyError" in told[1]


async def _failing_task() -> None:
    import gc

    async def fail() -> None:
        raise KeyError("lost")

    task = asyncio.create_task(fail())
    await asyncio.wait([task])
    del task
    gc.collect()
