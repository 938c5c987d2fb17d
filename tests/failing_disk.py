"""A disk that fails, or a process that dies, at a chosen step on the disk, whichever library takes it."""

from __future__ import annotations

import asyncio
import builtins
import io
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

CHANGES = ("mkdir", "rename", "replace", "link", "fsync", "truncate", "unlink", "rmdir", "remove")


class Killed(BaseException):
    """The process is dead: nothing that it would do from here on happens."""


class At:
    """Raises ``error`` at step ``number``, and if ``for_good`` at every later one too; counts the steps."""

    def __init__(self, number: int, error: Callable[[], BaseException] = Killed, *, for_good: bool = True):
        self.number, self.error, self.for_good, self.count = number, error, for_good, 0
        self._lock = threading.Lock()  # Zarr writes in threads

    def __call__(self) -> None:
        with self._lock:
            self.count += 1
            reached = self.count == self.number or (self.for_good and 0 < self.number < self.count)
        if reached:
            raise self.error()


@contextmanager
def disk(act: Callable[[], None]) -> Iterator[None]:
    """Calls ``act`` before every step on the disk, which it may refuse, in whichever thread it is taken."""

    def guarded(function: Callable[..., Any], writes: Callable[[tuple[Any, ...], dict[str, Any]], bool]) -> Callable[..., Any]:
        def call(*arguments: Any, **options: Any) -> Any:
            if writes(arguments, options):
                act()
            return function(*arguments, **options)

        return call

    def by_mode(arguments: tuple[Any, ...], options: dict[str, Any]) -> bool:
        mode = str(options.get("mode", arguments[1] if len(arguments) > 1 else "r"))
        return any(letter in mode for letter in "wxa+")

    def by_flags(arguments: tuple[Any, ...], options: dict[str, Any]) -> bool:
        return bool(int(options.get("flags", arguments[1] if len(arguments) > 1 else 0)) & (os.O_CREAT | os.O_TRUNC))

    patches = [patch.object(os, name, guarded(getattr(os, name), lambda *_: True)) for name in CHANGES]
    patches.append(patch.object(os, "open", guarded(os.open, by_flags)))
    patches += [patch.object(module, "open", guarded(builtins.open, by_mode)) for module in (builtins, io)]
    for one in patches:
        one.start()
    try:
        yield
    finally:
        _wait_for_zarr()
        for one in patches:
            one.stop()


def _wait_for_zarr() -> None:
    """Lets what Zarr began in its threads come to its end, which a dead process would not take either."""
    from zarr.core import sync

    async def ended() -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        await asyncio.gather(*others, return_exceptions=True)
        await asyncio.get_running_loop().run_in_executor(None, time.sleep, 0.0)

    loop = sync.loop[0]
    if loop is not None:
        asyncio.run_coroutine_threadsafe(ended(), loop).result()
    for thread in threading.enumerate():
        while thread.name.startswith("asyncio_") and _is_writing(thread):
            time.sleep(0.001)


def _is_writing(thread: threading.Thread) -> bool:
    frame = sys._current_frames().get(thread.ident or 0)
    while frame is not None:
        if frame.f_code.co_name in ("_put", "_get"):
            return True
        frame = frame.f_back
    return False
