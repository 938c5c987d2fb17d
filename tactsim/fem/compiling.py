"""Compiling of the loops, which numba does where its cache has none of them: the user is told, and its time is counted."""

from __future__ import annotations

from numba.core import event

from tactsim.progress import COMPILATION


class _Follower(event.Listener):
    """Hands numba's events over; what a cache holds raises none."""

    def on_start(self, event: event.Event) -> None:
        COMPILATION.begin()

    def on_end(self, event: event.Event) -> None:
        COMPILATION.end()


event.register("numba:compile", _Follower())
