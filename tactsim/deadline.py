"""A limit on the time that a computation may take, a way to stop it from another thread, and the time that a part took."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from numbers import Real

from tactsim.errors import InvalidQuantity, OutOfTime, shown
from tactsim.units import parse_quantity

TOO_LONG = "took longer than the"
"""How the reason of a computation begins that its time did not suffice for."""

_LIMIT: ContextVar[tuple[float, float] | None] = ContextVar("limit", default=None)
"""When the computation in this thread must end, on the monotonic clock, and the seconds that it had."""

_STOPPED: ContextVar[Callable[[], bool] | None] = ContextVar("stopped", default=None)
"""Asked now and then whether the computation in this thread is to stop."""


def allowed_seconds(limit: float | str | None) -> float | None:
    """The time in s that a limit such as 300 or "5 min" allows; None for none.

    Raises
    ------
    InvalidQuantity
        If it is no time, or not positive.
    """
    seconds = parse_quantity(limit, "s") if isinstance(limit, str) else limit
    if seconds is not None and (not isinstance(seconds, Real) or isinstance(seconds, bool) or not seconds > 0):
        raise InvalidQuantity(f"time_limit is {shown(limit)}; needed: a positive number of seconds, or text such as '5 min'")
    return None if seconds is None else float(seconds)


@contextmanager
def stopped_by(asked: Callable[[], bool]) -> Iterator[None]:
    """The computation inside ends with an error once ``asked``, called before each linear system, is true."""
    token = _STOPPED.set(asked)
    try:
        yield
    finally:
        _STOPPED.reset(token)


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """The computation inside ends with an error once so many seconds have passed; None leaves the limit that stands."""
    if seconds is None:
        yield
        return
    token = _LIMIT.set((time.monotonic() + seconds, seconds))
    try:
        yield
    finally:
        _LIMIT.reset(token)


def seconds_left() -> float:
    """Time in s that is left, negative once the limit has passed, infinite without one."""
    limit = _LIMIT.get()
    return math.inf if limit is None else limit[0] - time.monotonic()


def check_time() -> None:
    """Called before each linear system, and in every other loop that may take long.

    Raises
    ------
    OutOfTime
        If the limit has passed, or another thread has stopped the computation.
    """
    stopped = _STOPPED.get()
    if stopped is not None and stopped():
        raise OutOfTime("was stopped")
    limit = _LIMIT.get()
    if limit is not None and seconds_left() < 0:
        raise OutOfTime(f"{TOO_LONG} {limit[1]:g} s that it was given")


@contextmanager
def timed(timing: dict[str, float], name: str) -> Iterator[None]:
    """Adds the time in s that its block took, under a name; nothing if the block is left by an error."""
    started = time.perf_counter()
    yield
    timing[name] = time.perf_counter() - started
