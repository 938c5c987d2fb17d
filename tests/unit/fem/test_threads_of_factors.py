"""Factors use the same threads whatever a process has computed before its first one."""

from __future__ import annotations

import subprocess
import sys

from mutants import assert_kills

LOOP = """
import numba
import numpy as np
@numba.njit(parallel=True)
def doubled(values):
    for k in numba.prange(len(values)):
        values[k] *= 2
doubled(np.ones(1000))
"""
FACTOR = """
from scipy.sparse import identity
from threadpoolctl import threadpool_info
from tactsim.fem.solvers import pardiso_binding
from tactsim.fem.solvers.pardiso import Pardiso
{change}
Pardiso().factor(identity(10, format="csr"))
print([one["threading_layer"] for one in threadpool_info() if one["internal_api"] == "mkl"])
"""
UNTOLD = "pardiso_binding.LOOPS_THREADS = 'libnowhere.so'"


def threads(before: str, change: str) -> str:
    """Those of MKL in a new process, which has done something before."""
    command = [sys.executable, "-c", before + FACTOR.format(change=change)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_factors_use_the_threads_of_the_loops():
    """Mutant: MKL takes the threads that it finds at its first call."""
    after_a_loop = threads(LOOP, "")
    assert after_a_loop.count("'") == 2

    def check(change):
        assert threads("", change) == after_a_loop

    check("")
    if "gnu" in after_a_loop:  # else the system has no such threads, and there is nothing to find
        assert_kills(check, untold=(UNTOLD,))
