"""A disk that refuses, or a process that dies, at a chosen step of writing."""

from __future__ import annotations

import builtins
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

CHANGES = ("mkdir", "rename", "replace", "fsync")
REMOVALS = ("unlink", "rmdir", "remove")


class Killed(BaseException):
    """The process is dead: nothing that it would do from here on happens."""


@contextmanager
def disk(act: Callable[[], None]) -> Iterator[None]:
    """Calls ``act`` before every step on the disk, which it may refuse."""

    def guarded(function: Callable[..., Any], *, is_open: bool = False) -> Callable[..., Any]:
        def call(*arguments: Any, **options: Any) -> Any:
            mode = str(options.get("mode", arguments[1] if len(arguments) > 1 else "r"))
            if not is_open or any(letter in mode for letter in "wxa+"):
                act()
            return function(*arguments, **options)

        return call

    names = CHANGES + REMOVALS
    patches = [patch.object(os, name, guarded(getattr(os, name))) for name in names]
    patches.append(patch.object(builtins, "open", guarded(builtins.open, is_open=True)))
    for one in patches:
        one.start()
    try:
        yield
    finally:
        for one in patches:
            one.stop()


class At:
    """Raises ``error`` at step ``number``, and if ``for_good`` at every later one too."""

    def __init__(self, number: int, error: Callable[[], BaseException], *, for_good: bool):
        self.number, self.error, self.for_good, self.count = number, error, for_good, 0

    def __call__(self) -> None:
        self.count += 1
        if self.count == self.number or (self.for_good and self.count > self.number):
            raise self.error()
