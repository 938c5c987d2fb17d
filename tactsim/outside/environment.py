"""What numerical libraries read around them: variables on which they crash, and files by which others could steer them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from tactsim.errors import InputError, StorageError
from tactsim.outside.text import one_line

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
ONE_THREAD = dict.fromkeys(THREADS, "1")
"""So that processes beside each other do not fight for the same cores, and a result does not depend on their number."""
MOST_THREADS = 4096
"""More threads than any machine has cores are a mistake that libraries answer with a crash."""


STEERING = ".numba_config.yaml"
"""Numba reads it from the working folder; it may name a folder of compiled code, which then runs."""


def check_environment(variables: Mapping[str, str], folder: Path) -> None:
    """Refuses numbers of threads with which numerical libraries crash, and a working folder that is gone or whose files would
    steer them.

    Raises
    ------
    InputError
        Naming the variable or the file, and what is allowed.
    StorageError
        If the working folder was removed.
    """
    try:
        os.getcwd()
    except OSError:
        raise StorageError("the working folder is gone; change to another folder") from None
    if os.path.lexists(folder / STEERING):
        raise InputError(
            f"the working folder holds {STEERING}, which would decide what code the compiler runs; "
            "work in another folder or remove the file, and set what you need as NUMBA_... variables"
        )
    for name in THREADS:
        value = variables.get(name, "")
        first = value.split(",")[0].strip()  # OpenMP takes a list, one number for each level
        if value and not (first.isdecimal() and 1 <= int(first) <= MOST_THREADS):
            raise InputError(
                f"the environment variable {name} is {one_line(value, 80)!r}; allowed: 1 to {MOST_THREADS}, or unset"
            )


def own_cores() -> list[int]:
    """Numbers of the cores that this process may use; none where the system does not say."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


def usable_cores() -> int:
    """How many cores this process may use."""
    return len(own_cores()) or os.cpu_count() or 1
