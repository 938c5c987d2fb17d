"""The variables of the environment that numerical libraries read, checked before one of them crashes on them."""

from __future__ import annotations

from collections.abc import Mapping

from tactsim.errors import InputError
from tactsim.outside.text import one_line

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
ONE_THREAD = dict.fromkeys(THREADS, "1")
"""So that processes beside each other do not fight for the same cores, and a result does not depend on their number."""
MOST_THREADS = 4096
"""More threads than any machine has cores are a mistake that libraries answer with a crash."""


def check_environment(variables: Mapping[str, str]) -> None:
    """Refuses numbers of threads with which numerical libraries crash.

    Raises
    ------
    InputError
        Naming the variable, its value and what is allowed.
    """
    for name in THREADS:
        value = variables.get(name, "")
        first = value.split(",")[0].strip()  # OpenMP takes a list, one number for each level
        if value and not (first.isdecimal() and 1 <= int(first) <= MOST_THREADS):
            raise InputError(
                f"the environment variable {name} is {one_line(value, 80)!r}; allowed: 1 to {MOST_THREADS}, or unset"
            )
