"""The parts of a tangent of displacements and pressures, taken out of it row by row: its pattern is known and never changes."""

from __future__ import annotations

import numba
import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix

from tactsim.array import Array


class TangentBlocks:
    """Where the parts of tangents [[A, B'], [B, -C]] of one pattern stand: A in blocks of nodes, B' and C in rows.

    scipy's slices of the rows and columns and its blocks take 4.6 s for 321 000 unknowns, these loops 0.3 s.

    Parameters
    ----------
    matrix : (n, n), its indices sorted, the rows of a node's components of one structure, as a `Pattern` makes them
    split : number of displacements, which stand before the pressures
    dim : components of a node
    """

    def __init__(self, matrix: csr_matrix, split: int, dim: int):
        self._dim, self._split, self._size = dim, split, matrix.shape[0]
        self._before = before = _entries_before(matrix.indptr, matrix.indices, split)
        self._block_starts = _starts(before[:split:dim] // dim)
        self._block_indices = np.empty(self._block_starts[-1], np.int32)
        _block_columns(matrix.indptr, matrix.indices, dim, self._block_starts, self._block_indices)
        lengths = np.diff(matrix.indptr) - before
        self._gradient_starts, self._compliance_starts = _starts(lengths[:split]), _starts(lengths[split:])
        self._gradient_indices = _after(matrix.indptr, matrix.indices, before, 0, split) - split
        self._compliance_indices = _after(matrix.indptr, matrix.indices, before, split, self._size) - split

    def stiffness(self, matrix: csr_matrix, added: Array, factor: float) -> tuple[bsr_matrix, Array]:
        """A plus ``factor`` times ``added`` (blocks, d, d) on free unknowns, in single precision, and which (n, d) are free.

        An unknown that is held has one entry in its row of A, on the diagonal.
        """
        dim, starts, indices = self._dim, self._block_starts, self._block_indices
        data = np.empty((len(indices), dim, dim), np.float32)
        free = np.zeros((len(starts) - 1, dim), np.bool_)
        _take_blocks(matrix.indptr, matrix.data, starts, indices, data, free)
        _add_where_free(starts, indices, free, added, factor, data)
        return bsr_matrix((data, indices, starts), shape=(self._split, self._split)), free

    def gradient(self, matrix: csr_matrix) -> csr_matrix:
        """B'."""
        data = _after(matrix.indptr, matrix.data, self._before, 0, self._split)
        shape = (self._split, self._size - self._split)
        return csr_matrix((data, self._gradient_indices, self._gradient_starts), shape=shape)

    def compliance(self, matrix: csr_matrix) -> csr_matrix:
        """C."""
        data = -_after(matrix.indptr, matrix.data, self._before, self._split, self._size)
        count = self._size - self._split
        return csr_matrix((data, self._compliance_indices, self._compliance_starts), shape=(count, count))


def _starts(lengths: Array) -> Array:
    return np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)


@numba.njit(cache=True)
def _entries_before(indptr, indices, split):  # type: ignore[no-untyped-def]
    """Number (n,) of entries of each row in the columns before ``split``."""
    counts = np.zeros(len(indptr) - 1, np.int32)
    for row in range(len(counts)):
        for k in range(indptr[row], indptr[row + 1]):
            counts[row] += indices[k] < split
    return counts


@numba.njit(cache=True)
def _block_columns(indptr, indices, dim, starts, columns):  # type: ignore[no-untyped-def]
    for node in range(len(starts) - 1):
        first = indptr[node * dim]
        for k in range(starts[node + 1] - starts[node]):
            columns[starts[node] + k] = indices[first + k * dim] // dim


@numba.njit(cache=True)
def _after(indptr, values, before, begin, end):  # type: ignore[no-untyped-def]
    """The values of the entries behind the first ``before`` (n,) of the rows from ``begin`` to ``end``."""
    total = 0
    for row in range(begin, end):
        total += indptr[row + 1] - indptr[row] - before[row]
    taken, place = np.empty(total, values.dtype), 0
    for row in range(begin, end):
        for k in range(indptr[row] + before[row], indptr[row + 1]):
            taken[place] = values[k]
            place += 1
    return taken


@numba.njit(cache=True)
def _take_blocks(indptr, values, starts, columns, data, free):  # type: ignore[no-untyped-def]
    """Fill ``data`` (blocks, d, d), and ``free`` (n, d) where a row has an entry beside its diagonal."""
    dim = data.shape[1]
    for node in range(len(starts) - 1):
        for i in range(dim):
            place = indptr[node * dim + i]
            for k in range(starts[node], starts[node + 1]):
                for j in range(dim):
                    value = values[place]
                    data[k, i, j] = value
                    if value != 0.0 and not (columns[k] == node and i == j):
                        free[node, i] = True
                    place += 1


@numba.njit(cache=True)
def _add_where_free(starts, columns, free, added, factor, data):  # type: ignore[no-untyped-def]
    """Add ``factor`` times ``added`` (blocks, d, d) to the entries of ``data`` whose row and column are free."""
    dim = data.shape[1]
    for node in range(len(starts) - 1):
        for k in range(starts[node], starts[node + 1]):
            for i in range(dim):
                for j in range(dim):
                    if free[node, i] and free[columns[k], j]:
                        data[k, i, j] += factor * added[k, i, j]
