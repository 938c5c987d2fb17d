"""What numba's cache holds of loops whose source has changed."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any


def forget_stale(loop: Any, *taken_in: ModuleType) -> None:
    """Remove from numba's cache the loops of a module that were compiled before a module changed that they take in.

    numba looks for changes in a loop's own file, and else goes on with what the other file held before: "cache invalidation
    fails to recognize changes in functions defined in a different file" (its manual, Notes on Caching).

    Parameters
    ----------
    loop : one of the module, compiled with ``cache=True``
    taken_in : where the loops and constants stand that those of the module call or hold
    """
    if not hasattr(loop, "stats"):  # NUMBA_DISABLE_JIT: nothing is compiled
        return
    changed = max(Path(str(module.__file__)).stat().st_mtime_ns for module in taken_in)
    for index in Path(loop.stats.cache_path).glob(f"{loop.__module__.rpartition('.')[2]}.*.nbi"):
        if index.stat().st_mtime_ns < changed:
            index.unlink(missing_ok=True)
