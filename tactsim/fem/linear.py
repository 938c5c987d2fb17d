"""Sparse direct solution: MKL Pardiso where it installs, SuperLU elsewhere."""

from __future__ import annotations

import ctypes
import functools
import importlib.util
import platform
from typing import Any, Protocol

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.errors import ConvergenceError, InputError

Array = np.ndarray

LARGEST_RESIDUAL = 1e-3
"""Of a linear solution over its right-hand side; solvable systems, with stiff contact too, leave 1e-13 or so, singular ones 1."""


class DirectSolver(Protocol):
    """Factors matrices of one sparse pattern; the symbolic analysis is made once."""

    name: str

    def factor(self, matrix: csr_matrix) -> None:
        """Factor a matrix; its pattern must be that of the first one."""

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,) with the last factor."""

    def close(self) -> None:
        """Release the factor's memory."""


class Pardiso:
    """MKL Pardiso for nonsymmetric matrices, through pypardiso's binding."""

    name = "pardiso"

    def __init__(self) -> None:
        self._solver = _pardiso_module().PyPardisoSolver(mtype=11)
        self._pattern: tuple[Array, Array] | None = None
        self._matrix: csr_matrix | None = None

    def factor(self, matrix: csr_matrix) -> None:
        """Factor; analyses the pattern on the first call."""
        if self._pattern is None:
            self._pattern = (matrix.indptr.astype(np.int32) + 1, matrix.indices.astype(np.int32) + 1)
            phase = 12
        else:
            phase = 22
        self._matrix = matrix
        self._call(phase, np.zeros(matrix.shape[0]))

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,)."""
        return self._call(33, right)

    def close(self) -> None:
        """Release MKL's memory."""
        if self._pattern is not None:
            self._call(-1, np.zeros(0))
            self._pattern = self._matrix = None

    def _call(self, phase: int, right: Array) -> Array:
        solver, matrix = self._solver, self._matrix
        if self._pattern is None or matrix is None:
            raise InputError("factor a matrix before solving")
        right = np.ascontiguousarray(right, dtype=float)
        solution = np.zeros_like(right)
        error = ctypes.c_int32(0)
        integer = ctypes.POINTER(ctypes.c_int32)
        real = ctypes.POINTER(ctypes.c_double)

        def number(value: int) -> Any:
            return ctypes.byref(ctypes.c_int32(value))

        solver._mkl_pardiso(
            solver.pt.ctypes.data_as(ctypes.POINTER(solver._pt_type[0])),
            number(1),
            number(1),
            number(solver.mtype),
            number(phase),
            number(matrix.shape[0]),
            matrix.data.ctypes.data_as(real),
            self._pattern[0].ctypes.data_as(integer),
            self._pattern[1].ctypes.data_as(integer),
            solver.perm.ctypes.data_as(integer),
            number(1),
            solver.iparm.ctypes.data_as(integer),
            number(0),
            right.ctypes.data_as(real),
            solution.ctypes.data_as(real),
            ctypes.byref(error),
        )
        if error.value != 0:
            raise ConvergenceError(f"the sparse direct solver failed (Pardiso error {error.value}); is the body held?")
        return solution


class SuperLU:
    """scipy's SuperLU, where Pardiso does not install."""

    name = "superlu"

    def __init__(self) -> None:
        self._factor: Any = None

    def factor(self, matrix: csr_matrix) -> None:
        """Factor with a minimum-degree order."""
        from scipy.sparse.linalg import splu

        try:
            self._factor = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": False})
        except RuntimeError as error:
            raise ConvergenceError(f"the sparse direct solver failed ({error}); is the body held?") from error

    def solve(self, right: Array) -> Array:
        """Solution for one right-hand side (n,)."""
        if self._factor is None:
            raise InputError("factor a matrix before solving")
        return self._factor.solve(right)

    def close(self) -> None:
        """Drop the factor."""
        self._factor = None


def solved(solver: DirectSolver, matrix: csr_matrix, right: Array) -> Array:
    """Solution (n,) of one linear system that truly solves it.

    Neither solver reports a singular matrix reliably: both replace zero pivots and return huge numbers.

    Raises
    ------
    ConvergenceError
        If the matrix is singular and the right-hand side not in its range, or holds numbers that are not finite.
    """
    solver.factor(matrix)
    solution = solver.solve(right)
    left = float(np.abs(matrix @ solution - right).max())
    if not left <= LARGEST_RESIDUAL * float(np.abs(right).max()):
        raise ConvergenceError(
            f"the linear system is singular (largest step {np.abs(solution).max():.2e}, left over {left:.2e} "
            f"of {np.abs(right).max():.2e}); is the body held against moving as a whole, and is the material stable?"
        )
    return solution


def direct_solver(name: str | None = None) -> DirectSolver:
    """The named solver ("pardiso" or "superlu"), by default the fastest that is installed."""
    if name is None:
        installed = importlib.util.find_spec("pypardiso") is not None and platform.machine() in ("x86_64", "AMD64")
        name = "pardiso" if installed else "superlu"
    if name not in ("pardiso", "superlu"):
        raise InputError(f"unknown linear solver {name!r}; allowed: pardiso, superlu")
    return Pardiso() if name == "pardiso" else SuperLU()


@functools.cache
def _pardiso_module() -> Any:
    import pypardiso

    return pypardiso
