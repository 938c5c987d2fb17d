"""The sparse pattern: every element entry has its place, and elements of one colour share no node."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from solids import body_of, box

from tactsim.fem import threads
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
MEASURES = {"axisymmetric": 2, "plane_strain": 2, "solid": 3}


def body(measure: str):
    dim = MEASURES[measure]
    return body_of(box([1.0] * dim, [3] * dim, jitter=0.1), measure, MooneyRivlin2(c10=1.0, c01=0.5, bulk_modulus=10.0))


@pytest.mark.parametrize("measure", MEASURES)
def test_the_pattern_is_that_of_the_elements(measure):
    one = body(measure)
    unknowns = one.space.element_unknowns()
    dense = np.zeros((one.space.size,) * 2, bool)
    for element in unknowns:
        dense[np.ix_(element, element)] = True
    matrix = one.pattern.matrix(np.ones(len(one.pattern.indices)))
    assert (matrix.toarray() == dense).all()
    assert matrix.has_canonical_format


@pytest.mark.parametrize("measure", MEASURES)
def test_positions_find_every_entry(measure):
    pattern = body(measure).pattern
    rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
    chosen = np.random.default_rng(0).permutation(len(rows))
    assert (pattern.positions(rows[chosen], pattern.indices[chosen]) == chosen).all()


@pytest.mark.parametrize("measure", MEASURES)
def test_a_body_with_one_thread_has_one_colour_in_the_order_of_the_mesh(measure):
    one = body(measure)
    assert (one.pattern.order == np.arange(len(one.space.elements))).all()
    assert one.pattern.color_starts.tolist() == [0, len(one.space.elements)]


@pytest.mark.parametrize("measure", MEASURES)
def test_colours_cover_every_element_once_and_share_no_node(measure, monkeypatch):
    monkeypatch.setattr(threads, "SERIAL_ELEMENTS", 0)  # a body so small has one thread otherwise
    one = body(measure)
    pattern, elements = one.pattern, one.space.elements
    assert sorted(pattern.order) == list(range(len(elements)))
    for first, last in itertools.pairwise(pattern.color_starts):
        nodes = elements[pattern.order[first:last]].ravel()
        assert len(nodes) == len(set(nodes))
    both = elements[pattern.order[: pattern.color_starts[1] + 1]].ravel()
    assert len(both) > len(set(both))  # twin: one element more and the first colour shares a node


@pytest.mark.parametrize("measure", MEASURES)
def test_constraints_clear_rows_and_columns_and_put_one_on_the_diagonal(measure):
    one = body(measure)
    fixed = np.array([0, 3, 3, one.space.size - 1])
    data = one.tangent(np.zeros(one.space.size))
    expected = one.pattern.matrix(data.copy()).toarray()
    expected[fixed] = expected[:, fixed] = 0.0
    expected[fixed, fixed] = 1.0
    constraints = Constraints(fixed, one.pattern)
    applied = constraints.apply(data)
    assert applied is data
    assert (one.pattern.matrix(applied).toarray() == expected).all()
    assert isinstance(one.pattern.matrix(applied), csr_matrix)


@pytest.mark.parametrize("measure", MEASURES)
def test_constraints_free_a_copy_of_the_residual(measure):
    one = body(measure)
    constraints = Constraints(np.array([1, 4]), one.pattern)
    residual = np.ones(one.space.size)
    freed = constraints.free(residual)
    assert residual.all()
    assert np.flatnonzero(freed == 0).tolist() == [1, 4]


@pytest.mark.parametrize("measure", MEASURES)
def test_no_constraint_changes_nothing(measure):
    one = body(measure)
    data = one.tangent(np.zeros(one.space.size))
    assert (Constraints(np.zeros(0, int), one.pattern).apply(data.copy()) == data).all()
