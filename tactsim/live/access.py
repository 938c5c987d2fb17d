"""Who may ask the server: only a page whose address holds the token, under the name that the server was given.

The one place, too, where whatever a request does wrong becomes a short answer.
"""

from __future__ import annotations

import asyncio
import hmac
import ipaddress
from urllib.parse import urlsplit

from aiohttp import web
from aiohttp.typedefs import Handler, Middleware

from tactsim.live.defects import report
from tactsim.live.sources.feed_sources import is_loopback

HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""Sent with every answer: nothing from elsewhere, no address given to elsewhere."""


def guard(token: str, host: str) -> Middleware:
    """Refuses with 403 what has not the token as first part of its path, or names another host than one of this machine.

    A web page elsewhere can make a browser ask this server under a name of its own (DNS rebinding): such a name is neither
    ``host`` nor localhost nor a plain address.
    """

    @web.middleware
    async def guarded(request: web.Request, handler: Handler) -> web.StreamResponse:
        if not _allowed(request, token, host):
            return _refusal(403, "the address of this page needs its token")
        if request.method not in ("GET", "HEAD"):
            return _refusal(405, "only GET")
        try:
            response = await handler(request)
        except web.HTTPException as error:
            return _refusal(error.status, error.reason)
        except (ConnectionError, asyncio.CancelledError):
            raise
        except Exception as error:  # noqa: BLE001  whatever a handler does wrong, the client gets an answer and the user a line
            return _refusal(500, report(error))
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    return guarded


def _refusal(status: int, words: str) -> web.Response:
    return web.Response(status=status, text=f"{status}: {words}", headers=HEADERS)


def _allowed(request: web.Request, token: str, host: str) -> bool:
    """Whether the path begins with the token, compared in constant time, and the host named is this machine."""
    given = request.path.removeprefix("/").partition("/")[0]
    has_token = hmac.compare_digest(given.encode("utf-8", "replace"), token.encode())
    return has_token and _known_host(request.headers.get("Host", ""), host)


def _known_host(named: str, host: str) -> bool:
    try:
        name = urlsplit(f"//{named}").hostname or ""
    except ValueError:
        return False
    if name == host or is_loopback(name):
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return not is_loopback(host)


def same_origin(request: web.Request) -> bool:
    """Whether a web socket is asked for by a page of this server; browsers always send the origin."""
    return request.headers.get("Origin") == f"{request.scheme}://{request.headers.get('Host', '')}"
