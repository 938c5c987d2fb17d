"""Who may ask the server: only a page whose address holds the token, under the name that the server was given."""

from __future__ import annotations

import hmac
import ipaddress
from urllib.parse import urlsplit

from aiohttp import web
from aiohttp.typedefs import Handler, Middleware

from tactsim.live.feed_sources import is_loopback

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
"""Sent with every answer: nothing from elsewhere, no address told to elsewhere."""


def guard(token: str, host: str) -> Middleware:
    """Refuses with 403 what has not the token as first part of its path, or names another host than one of this machine.

    A web page elsewhere can make a browser ask this server under a name of its own (DNS rebinding): such a name is neither
    ``host`` nor localhost nor a plain address.
    """

    @web.middleware
    async def guarded(request: web.Request, handler: Handler) -> web.StreamResponse:
        given = request.path.split("/")[1]
        if not hmac.compare_digest(given.encode(), token.encode()) or not _known_host(request.host, host):
            return web.Response(status=403, text="403: the address of this page needs its token", headers=HEADERS)
        if request.method not in ("GET", "HEAD"):
            return web.Response(status=405, text="405: only GET", headers=HEADERS)
        try:
            response = await handler(request)
        except web.HTTPException as error:
            return web.Response(status=error.status, text=f"{error.status}: {error.reason}", headers=HEADERS)
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    return guarded


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
    """Whether a web socket is asked for by a page of this server; browsers always tell the origin."""
    return request.headers.get("Origin") == f"{request.scheme}://{request.host}"
