"""Work of a library that an interruption must not break, such as that of zarr, whose own thread goes on writing."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Made = TypeVar("Made")


def uninterrupted(make: Callable[[], Made]) -> Made:
    """What a function returns, which runs in a thread, where no signal is handled; an interruption waits for its end.

    Raises
    ------
    KeyboardInterrupt
        Once the function has ended, if one came meanwhile.
    """
    with ThreadPoolExecutor(max_workers=1) as thread:  # left only when the thread has ended
        return thread.submit(make).result()
