"""The server of the live page: on the loopback address, with a random token, until it is stopped."""

from __future__ import annotations

import asyncio
import secrets
import signal
from collections.abc import Callable
from contextlib import AsyncExitStack, suppress
from importlib.resources import files
from pathlib import PurePosixPath

from aiohttp import WSMsgType, web

from tactsim.errors import StorageError
from tactsim.live.access import guard, same_origin
from tactsim.live.content import Content
from tactsim.live.feed_sources import FeedPlace, feeding
from tactsim.live.session import Session

LOOPBACK = "127.0.0.1"
TOKEN_BYTES = 24
LONGEST_COMMAND = 4096
"""Bytes of a message of the page."""
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


def application(content: Content, token: str, host: str = LOOPBACK) -> web.Application:
    """The server's answers: the page, its files and its web socket below ``/TOKEN/``, and 403 to everything else."""
    app = web.Application(middlewares=[guard(token, host)])
    app[CONTENT] = content
    app[SOCKETS] = set()
    app.router.add_get(f"/{token}/", _file)
    app.router.add_get(f"/{token}/ws", _socket)
    app.router.add_get(f"/{token}/{{name:.+}}", _file)
    app.on_shutdown.append(_close_sockets)
    return app


async def _file(request: web.Request) -> web.StreamResponse:
    name = request.match_info.get("name", "index.html")
    path = PurePosixPath(name)
    if ".." in path.parts or path.is_absolute() or path.suffix not in TYPES or "\\" in name:
        raise web.HTTPNotFound
    found = files("tactsim.live") / "page"
    for part in path.parts:
        found = found / part
    if not found.is_file():
        raise web.HTTPNotFound
    return web.Response(body=found.read_bytes(), content_type=TYPES[path.suffix], charset="utf-8")


async def _socket(request: web.Request) -> web.StreamResponse:
    if not same_origin(request):
        raise web.HTTPForbidden
    socket = web.WebSocketResponse(heartbeat=20, max_msg_size=LONGEST_COMMAND, compress=False)
    await socket.prepare(request)
    request.app[SOCKETS].add(socket)
    session = Session(request.app[CONTENT], socket)
    pushing = asyncio.create_task(session.run())
    pushing.add_done_callback(lambda task: task.cancelled() or task.exception() is None or asyncio.ensure_future(socket.close()))
    try:
        async for message in socket:
            if message.type is WSMsgType.TEXT:
                await session.receive(message.data)
    finally:
        request.app[SOCKETS].discard(socket)
        pushing.cancel()
        with suppress(asyncio.CancelledError, ConnectionError):
            await pushing
    return socket


async def _close_sockets(app: web.Application) -> None:
    sockets = app[SOCKETS]
    for socket in tuple(sockets):
        await socket.close(code=1001, message=b"the server ends")


def serve(
    content: Content, *, host: str = LOOPBACK, port: int = 0, live: FeedPlace | None = None, ready: Callable[[str], None]
) -> None:
    """Serves until SIGINT or SIGTERM; ``ready`` is called once with the address of the page.

    Raises
    ------
    StorageError
        If the port is taken or the address is not one of this machine.
    """
    asyncio.run(_serve(content, host, port, live, ready))


async def _serve(content: Content, host: str, port: int, live: FeedPlace | None, ready: Callable[[str], None]) -> None:
    token = secrets.token_urlsafe(TOKEN_BYTES)
    stop = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError, RuntimeError, ValueError):
            asyncio.get_running_loop().add_signal_handler(number, stop.set)
    runner = web.AppRunner(application(content, token, host), access_log=None, shutdown_timeout=1.0)
    async with AsyncExitStack() as stack:
        if live is not None and content.feed is not None:
            await stack.enter_async_context(feeding(content.feed, live))
        await runner.setup()
        stack.push_async_callback(runner.cleanup)
        try:
            await web.TCPSite(runner, host, port).start()
        except OSError as error:
            raise StorageError(
                f"cannot serve on {host} port {port}: {error.strerror or error}; give another --port or leave it out"
            ) from None
        ready(f"http://{_in_url(host)}:{runner.addresses[0][1]}/{token}/")
        await stop.wait()


def _in_url(host: str) -> str:
    shown = LOOPBACK if host in ("0.0.0.0", "::") else host
    return f"[{shown}]" if ":" in shown else shown
