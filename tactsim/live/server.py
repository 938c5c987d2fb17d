"""The server of the live page: on the loopback address, with a random token, until it is stopped."""

from __future__ import annotations

import asyncio
import secrets
import signal
from collections.abc import Callable
from contextlib import AsyncExitStack, suppress
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import PurePosixPath

from aiohttp import WSCloseCode, WSMsgType, web

from tactsim.errors import StorageError
from tactsim.live.access import guard, same_origin
from tactsim.live.defects import report, reporting_defects
from tactsim.live.session.content import Content
from tactsim.live.session.session import Session
from tactsim.live.session.thinking import Threads
from tactsim.live.sources.feed_sources import FeedPlace, feeding
from tactsim.outside.text import one_line

LOOPBACK = "127.0.0.1"
TOKEN_BYTES = 24
LONGEST_COMMAND = 4096
"""Bytes of a message of the page."""
LONGEST_REASON = 123
"""Bytes of the reason of a closing, by the protocol."""
MOST_PAGES = 32
"""Pages that are open at the same time: more than a room has viewers, each costs time and memory."""
GOODBYE = 0.5
"""Time in s that each part of the end may take; with all of them the page ends within 2 s."""
IDLE = 30
"""Time in s after which a connection that asks for nothing is closed, so that many of them do not keep others out."""
TYPES = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".svg": "image/svg+xml",
    ".md": "text/plain",
    "": "text/plain",
}
CONTENT = web.AppKey("content", Content)
SOCKETS = web.AppKey("sockets", set[web.WebSocketResponse])
FILES = web.AppKey("files", dict[str, Traversable])
THREADS = web.AppKey("threads", Threads)


def application(content: Content, token: str, host: str = LOOPBACK) -> web.Application:
    """The server's answers: the page, its files and its web socket below ``/TOKEN/``, and 403 to everything else."""
    app = web.Application(middlewares=[guard(token, host)])
    app[CONTENT] = content
    app[SOCKETS] = set()
    app[FILES] = _page_files()
    app[THREADS] = Threads()
    app.router.add_get(f"/{token}/", _file)
    app.router.add_get(f"/{token}/ws", _socket)
    app.router.add_get(f"/{token}/{{name:.+}}", _file)
    app.on_shutdown.append(_close_sockets)
    return app


def _page_files() -> dict[str, Traversable]:
    """Everything that may be asked for, by its path below the token."""
    served: dict[str, Traversable] = {}
    folders = [("", files("tactsim.live") / "page")]
    while folders:
        above, folder = folders.pop()
        for entry in folder.iterdir():
            name = f"{above}{entry.name}"
            if entry.is_dir():
                folders.append((f"{name}/", entry))
            elif PurePosixPath(name).suffix in TYPES:
                served[name] = entry
    return served


async def _file(request: web.Request) -> web.StreamResponse:
    name = request.match_info.get("name", "index.html")
    file = request.app[FILES].get(name)
    if file is None:
        raise web.HTTPNotFound
    return web.Response(body=file.read_bytes(), content_type=TYPES[PurePosixPath(name).suffix], charset="utf-8")


async def _socket(request: web.Request) -> web.StreamResponse:
    sockets = request.app[SOCKETS]
    if not same_origin(request):
        raise web.HTTPForbidden
    if len(sockets) >= MOST_PAGES:
        raise web.HTTPTooManyRequests
    socket = web.WebSocketResponse(heartbeat=20, max_msg_size=LONGEST_COMMAND, compress=False, timeout=GOODBYE)
    try:
        await socket.prepare(request)
    except ValueError:  # a key that is no base64 text
        raise web.HTTPBadRequest from None
    sockets.add(socket)
    try:
        await _converse(socket, Session(request.app[CONTENT], socket, request.app[THREADS]))
    except Exception as error:  # noqa: BLE001  the page gets it as reason of the closing, the user as a line
        await socket.close(code=WSCloseCode.INTERNAL_ERROR, message=report(error).encode()[:LONGEST_REASON])
    finally:
        sockets.discard(socket)
    return socket


async def _converse(socket: web.WebSocketResponse, session: Session) -> None:
    """Takes commands while the session sends, until the page is gone."""
    pushing = asyncio.create_task(session.run())
    try:
        async for message in socket:
            if message.type in (WSMsgType.TEXT, WSMsgType.BINARY):
                await session.receive(message.data)
                await asyncio.sleep(0)  # other pages have their turn however fast the commands come
    finally:
        pushing.cancel()
        with suppress(asyncio.CancelledError, ConnectionError):
            await pushing


async def _close_sockets(app: web.Application) -> None:
    """Says goodbye to all pages at once; one that does not listen is cut off."""
    closing = [
        asyncio.create_task(socket.close(code=WSCloseCode.GOING_AWAY, message=b"the server ends")) for socket in app[SOCKETS]
    ]
    if closing:
        await asyncio.wait(closing, timeout=GOODBYE)
    app[THREADS].close()


@dataclass(frozen=True)
class Serving:
    """Where the page is served, and where messages go."""

    ready: Callable[[str], None]
    """Called once with the address of the page."""
    report: Callable[[str], None]
    """Called with a line about every defect of the server."""
    host: str = LOOPBACK
    port: int = 0
    live: FeedPlace | None = None


def serve(content: Content, serving: Serving) -> None:
    """Serves until SIGINT or SIGTERM.

    Raises
    ------
    StorageError
        If the port is taken or the address is not one of this machine.
    """
    with reporting_defects(serving.report):
        asyncio.run(_serve(content, serving))


async def _serve(content: Content, serving: Serving) -> None:
    token = secrets.token_urlsafe(TOKEN_BYTES)
    stop = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError, RuntimeError, ValueError):
            asyncio.get_running_loop().add_signal_handler(number, stop.set)
    runner = web.AppRunner(
        application(content, token, serving.host),
        access_log=None,
        auto_decompress=False,
        keepalive_timeout=IDLE,
        lingering_time=GOODBYE,
        shutdown_timeout=GOODBYE,
    )
    async with AsyncExitStack() as stack:
        if serving.live is not None and content.feed is not None:
            await stack.enter_async_context(feeding(content.feed, serving.live))
        await runner.setup()
        stack.push_async_callback(runner.cleanup)
        try:
            await web.TCPSite(runner, serving.host, serving.port).start()
        except (OSError, ValueError) as error:
            cause = f"{getattr(error, 'strerror', None) or one_line(error)}; give another --port or leave it out"
            raise StorageError(f"cannot serve on {one_line(serving.host)} port {serving.port}: {cause}") from None
        serving.ready(f"http://{_in_url(serving.host)}:{runner.addresses[0][1]}/{token}/")
        await stop.wait()


def _in_url(host: str) -> str:
    shown = LOOPBACK if host in ("0.0.0.0", "::") else host
    return f"[{shown}]" if ":" in shown else shown
