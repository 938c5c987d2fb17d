"""A page as the server sees it: a web socket that takes every message, says that it drew each frame, and keeps the last ones."""

from __future__ import annotations

import asyncio
import json
import struct
from collections.abc import Awaitable, Callable
from typing import Any

import numpy as np
from aiohttp import ClientWebSocketResponse, WSMsgType
from aiohttp.test_utils import TestClient, TestServer

from tactsim.live.server import application
from tactsim.live.session.content import Content

TOKEN = "a-token_1"
Client = TestClient[Any, Any]


def with_client(content: Content, act: Callable[[Client], Awaitable[None]], host: str = "127.0.0.1") -> None:
    """Runs ``act`` against a server of its own."""

    async def run() -> None:
        async with TestClient(TestServer(application(content, TOKEN, host))) as client:
            async with asyncio.timeout(40):
                await act(client)

    asyncio.run(run())


class Page:
    """What a page does with its socket: says that it drew every frame, keeps the last of every message."""

    def __init__(self, socket: ClientWebSocketResponse, draws: bool = True):
        self.socket, self.draws = socket, draws
        self.last: dict[str, dict[str, Any]] = {}
        self.frames = 0

    async def until(self, condition: Callable[[], bool]) -> None:
        """Receives until a condition holds."""
        while not condition():
            message = await self.socket.receive()
            if message.type is WSMsgType.TEXT:
                content = json.loads(message.data)
            elif message.type is WSMsgType.BINARY:
                content = self._frame(message.data)
                self.frames += 1
                if self.draws:
                    await self.do("drawn")
            else:
                raise AssertionError(f"the socket ended: {message}")
            self.last[content["is"]] = content

    def _frame(self, data: bytes) -> dict[str, Any]:
        (length,) = struct.unpack_from("<I", data)
        assert length % 4 == 0, "the numbers must stand at a multiple of four"
        content = json.loads(data[4 : 4 + length])
        scene = self.last["scene"]
        count = 2 * scene["rows"] * scene["columns"]
        content["forces"] = np.frombuffer(data, "<f4", count, 4 + length).reshape(2, scene["rows"], -1)
        content["pictures"] = np.frombuffer(data, np.uint8, offset=4 + length + 4 * count).reshape(3, *scene["shape"])
        return content

    async def do(self, what: str, **more: object) -> None:
        """Sends a command."""
        await self.socket.send_str(json.dumps({"do": what, **more}))


async def opened_page(client: Client, **options: Any) -> Page:
    """A page whose socket is open."""
    return Page(await client.ws_connect(f"/{TOKEN}/ws", headers={"Origin": str(client.make_url("")).rstrip("/")}), **options)
