"""``tactsim show --web``: serves the live page until it is stopped."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser

from tactsim.cli import console
from tactsim.cli.option_values import quantity_of
from tactsim.errors import InputError


def run_page(arguments: argparse.Namespace) -> int:
    """Serves the page; 0 when the user ends it.

    Raises
    ------
    InputError
        If there is nothing to show, or an option is out of its range.
    StorageError
        If a folder, the feed or the port cannot be used.
    """
    from tactsim.live.server import LOOPBACK, Serving, serve
    from tactsim.live.session.content import opened_content
    from tactsim.live.sources.feed import Feed
    from tactsim.live.sources.feed_sources import FeedPlace, is_loopback

    if arguments.save is not None:
        raise InputError("--save and --web: one at a time; leave one out")
    port, host = arguments.port or 0, LOOPBACK if arguments.host is None else arguments.host
    if not 0 <= port <= 65535:
        raise InputError(f"--port {port}: not a port; allowed: 1 to 65535, or 0 for any that is free")
    noise = None if arguments.noise is None else quantity_of("--noise", arguments.noise, "N")
    if noise is not None and noise <= 0:
        raise InputError(f"--noise {arguments.noise}: allowed: more than 0 N")
    live = None if arguments.live is None else FeedPlace.of(arguments.live)
    feed = None if live is None else Feed(live.name)
    content = opened_content(arguments.result, feed=feed, reference=arguments.reference, noise=noise, learned=arguments.learned)
    if not is_loopback(host):
        console.note(f"warning: the page is served on {host}: others on the network who learn its address can see it")

    def ready(address: str) -> None:
        console.out(f"{address}\nCtrl-C ends the page")
        if not arguments.no_browser and _has_desktop():
            webbrowser.open(address)

    serve(content, Serving(ready, console.note, host, port, live))
    return 0


def _has_desktop() -> bool:
    """Whether a browser would open a window, rather than take over the terminal."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
