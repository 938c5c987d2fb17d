"""The sparse pattern of the tangent: where each element entry lands, and an element order that threads can share."""

from __future__ import annotations

from functools import cached_property

import numba
import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.threads import are_serial


class Pattern:
    """CSR pattern of a tangent assembled from Taylor-Hood elements, made where it is first asked for its entries: a body of which
    a part stands for the whole never makes its own.

    The rows of one node's components have one structure, so an element's entry for nodes (a, b) and components (i, k) stands
    in ``data`` at ``indptr[row of (a, i)] + offsets[e, a, b] + k``; pressures count as nodes of one component after the
    displacements'. ``order`` lists the elements colour by colour, ``color_starts`` where each colour begins: elements of one
    colour share no node, so threads add without locks and every entry is summed in the same order whatever their number. A body
    whose loops use one thread has one colour, in the order of the mesh: neighbours then find one another's numbers in the cache:
    in a section of 7 000 elements the residual takes 4.4 ms instead of 6.1, the tangent 15 instead of 24.

    Parameters
    ----------
    space : numbers the unknowns of the elements
    """

    def __init__(self, space: TaylorHood):
        self._space = space
        self.size = space.size
        """Number of unknowns."""

    @cached_property
    def offsets(self) -> Array:
        """Places (E, A + V, A + V) of the first component of each node of an element in the rows of each other."""
        space = self._space
        leading = np.hstack([space.elements * space.dim, space.displacement_size + space.pressures])
        offsets = np.empty((len(leading), leading.shape[1], leading.shape[1]), np.int32)
        _locate(leading, self.indptr, self.indices, offsets)
        return offsets

    @property
    def indptr(self) -> Array:
        """Where the rows start (size + 1,)."""
        return self._structure[0]

    @property
    def indices(self) -> Array:
        """Columns (nnz,) of the entries, row by row."""
        return self._structure[1]

    @cached_property
    def diagonal(self) -> Array:
        """Places (size,) of the entries on the diagonal."""
        unknowns = np.arange(self.size)
        return self.positions(unknowns, unknowns)

    @property
    def order(self) -> Array:
        """The elements (E,) colour by colour."""
        return self._coloured[0]

    @property
    def color_starts(self) -> Array:
        """Where each colour begins, and the last one ends (colours + 1,)."""
        return self._coloured[1]

    def matrix(self, data: Array) -> csr_matrix:
        """The CSR matrix (size, size) with these entries (nnz,), which are not copied."""
        return csr_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))

    def positions(self, rows: Array, columns: Array) -> Array:
        """Places in ``data`` of the entries (rows, columns), which must be in the pattern."""
        keys = np.repeat(np.arange(self.size, dtype=np.int64), np.diff(self.indptr)) * self.size + self.indices
        return np.searchsorted(keys, rows.astype(np.int64) * self.size + columns)

    def between(self, unknowns: Array) -> Array:
        """Places (F, w, w) in ``data`` of the entries between the unknowns (F, w) of each of some facets."""
        rows = np.repeat(unknowns[:, :, None], unknowns.shape[1], axis=2)
        return self.positions(rows, rows.transpose(0, 2, 1))

    @cached_property
    def _structure(self) -> tuple[Array, Array]:
        return _csr_structure(self._space.element_unknowns(), self.size)

    @cached_property
    def _coloured(self) -> tuple[Array, Array]:
        return _order(self._space.elements, len(self._space.nodes))


def _csr_structure(element_unknowns: Array, size: int) -> tuple[Array, Array]:
    count, width = element_unknowns.shape
    ones = np.ones(element_unknowns.size, np.int8)
    rows = np.repeat(np.arange(count), width)
    incidence = csr_matrix((ones, (element_unknowns.ravel(), rows)), shape=(size, count))
    adjacency = (incidence.astype(np.int32) @ incidence.T.astype(np.int32)).tocsr()
    adjacency.sort_indices()
    return adjacency.indptr.astype(np.int32), adjacency.indices.astype(np.int32)


def _order(elements: Array, node_count: int) -> tuple[Array, Array]:
    """Order of the elements, and where each colour begins."""
    if are_serial(len(elements)):
        return np.arange(len(elements)), np.array([0, len(elements)])
    return _color(elements, node_count)


@numba.njit(cache=True)
def _locate(leading, indptr, indices, offsets):  # type: ignore[no-untyped-def]
    """Places of the unknowns of an element in each other's rows, by bisection: numpy's search takes a second to compile."""
    count, width = leading.shape
    for e in range(count):
        for i in range(width):
            start, stop = indptr[leading[e, i]], indptr[leading[e, i] + 1]
            for j in range(width):
                low, high = start, stop
                while low < high:
                    middle = (low + high) // 2
                    if indices[middle] < leading[e, j]:
                        low = middle + 1
                    else:
                        high = middle
                offsets[e, i, j] = low - start


@numba.njit(cache=True)
def _color(elements, size):  # type: ignore[no-untyped-def]
    """Greedy colouring by 64-bit masks: the lowest colour that no unknown of the element has seen.

    Returns the elements by colour, each colour's in their order, and where each colour starts.
    """
    count, width = elements.shape
    colors = np.full(count, -1, np.int64)
    assigned, base, last = 0, 0, 0
    while assigned < count:
        seen = np.zeros(size, np.uint64)
        for e in range(count):
            if colors[e] >= 0:
                continue
            mask = np.uint64(0)
            for i in range(width):
                mask |= seen[elements[e, i]]
            for c in range(64):
                bit = np.uint64(1) << np.uint64(c)
                if mask & bit == 0:
                    colors[e] = base + c
                    last = max(last, base + c)
                    assigned += 1
                    for i in range(width):
                        seen[elements[e, i]] |= bit
                    break
        base += 64
    starts = np.zeros(last + 2, np.int64)  # sorted by counting: numpy's sort takes two seconds to compile
    for e in range(count):
        starts[colors[e] + 1] += 1
    for c in range(last + 1):
        starts[c + 1] += starts[c]
    order, free = np.empty(count, np.int64), starts[:-1].copy()
    for e in range(count):
        order[free[colors[e]]] = e
        free[colors[e]] += 1
    return order, starts
