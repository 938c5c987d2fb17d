"""The live page in a process of its own, and raw requests and web socket frames for it."""

from __future__ import annotations

import base64
import json
import os
import re
import signal
import socket
import struct
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass

from fork_server import forked_command

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
    """The command in a process of its own, forked from one that has loaded it, once it has printed its address."""
    command = [*forked_command("-W", "error"), "show", *arguments, "--web", "--no-browser"]
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
