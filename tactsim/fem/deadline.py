"""A limit on the time that solving may take, for callers that would rather lose one case than wait for it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from tactsim.errors import OutOfTime

_LIMIT: ContextVar[tuple[float, float] | None] = ContextVar("limit", default=None)
"""When solving in this thread must end, on the monotonic clock, and the seconds that it had."""


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Solving inside ends with an error once so many seconds have passed; None means no limit."""
    token = _LIMIT.set(None if seconds is None else (time.monotonic() + seconds, seconds))
    try:
        yield
    finally:
        _LIMIT.reset(token)


def check_time() -> None:
    """Called before each linear system.

    Raises
    ------
    OutOfTime
        If the limit has passed.
    """
    limit = _LIMIT.get()
    if limit is not None and time.monotonic() > limit[0]:
        raise OutOfTime(f"took longer than the {limit[1]:g} s that it was given")
