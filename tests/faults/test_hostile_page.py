"""What strangers send to the live page: an answer in words for them, nothing in the terminal, and no other page is disturbed."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from fork_server import forked_command
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from live_pages import description, frame_line, grasp_folder, line, made_up_store
from served_pages import FRAMES, OP_TEXT, fault_or_code, framed, received, requests, served

from tactsim.errors import InputError
from tactsim.live.defects import LOGGER, reporting_defects
from tactsim.live.session.commands import read_command
from tactsim.live.sources.feed import Feed

END = 2.0
"""Time in s in which Ctrl-C must end the page."""


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
        duration, printed = server.ended()
    assert printed == ""
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
        duration, printed = server.ended()
    assert printed == ""
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
    command = [*forked_command(), "show", "--web", "--no-browser", "--live", str(place)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 5
    assert "allowed: a regular file" in done.stderr
    assert "--live - < " in done.stderr


def test_a_closed_standard_input_is_reported_on_the_page(tmp_path: Path) -> None:
    with served("--live", "-", preexec_fn=lambda: os.close(0)) as server, server.page() as page:
        sent = [json.loads(content) for kind, content in take(received(page), 6) if kind == OP_TEXT]
        assert any(one.get("state") == "standard input is closed" for one in sent)
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
    assert feed.state_now()["malformed"] == 1 + len(bad)
    assert feed.state_now()["fault"].isprintable()
    stream.take(line(frame_line(2.0)))
    assert feed.state_now()["frames"] == 1


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
    expected = "ok"
    try:
        read_command(text)
    except InputError as error:
        expected = str(error)
    assert len(expected) < 400
    assert expected.isprintable()


def test_a_defect_is_reported_in_one_line_and_once() -> None:
    reported: list[str] = []
    with reporting_defects(reported.append):
        for _ in range(3):
            LOGGER.error("x", exc_info=ValueError("a\x1b[31m\nb"))
        asyncio.run(_failing_task())
    assert reported[0] == "warning: internal error of the page (ValueError: a\\x1b[31m\\nb); please report it"
    assert len(reported) == 2
    assert "KeyError" in reported[1]


async def _failing_task() -> None:
    import gc

    async def fail() -> None:
        raise KeyError("lost")

    task = asyncio.create_task(fail())
    await asyncio.wait([task])
    del task
    gc.collect()
