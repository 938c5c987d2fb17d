"""Force on every taxel as the integral of the contact traction over the tissue that lies on it.

The traction of a facet is the quadratic polynomial through its values at the quadrature points, so that integrals over pieces
of the facet add up to the force that the equilibrium knows. The deformed facets are cut along the borders of the taxels; each
piece then lies on one taxel, in a gap or outside, and what is cut is lost nowhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.mechanics.contact.traction_recovery import shape_functions

AFFINE = 1e-9
"""A facet whose mid-side nodes are off the middles by less than this part of its size is taken as straight."""
SUBDIVISION = 4
"""Parts per side into which a curved facet is divided, each taken as straight when it is cut."""
FACETS_AND_TAXELS_AT_ONCE = 1000
"""Facets that are cut together, and the taxels on them: their pieces fit the cache (100 x 100 taxels in 1.8 s, not 3.0 s)."""
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


@dataclass(frozen=True)
class TaxelForces:
    """Forces of one jaw in N: ``taxels`` (3, rows, columns), ``gaps`` (3,) between and ``outside`` (3,) beyond the matrix."""

    taxels: Array
    gaps: Array
    outside: Array

    @property
    def total(self) -> Array:
        """Sum (3,) of all."""
        return self.taxels.sum(axis=(1, 2)) + self.gaps + self.outside


def taxel_forces(layout: TaxelLayout, places: Array, forces: Array, points: Array) -> TaxelForces:
    """Forces on the taxels of one jaw.

    Parameters
    ----------
    layout : TaxelLayout
    places : (F, 6, 2) deformed nodes of quadratic facets (corners, then mid-sides 01, 12, 02) in the jaw's plane, in m from its
        middle
    forces : (3, F, 6) traction times weight at the quadrature points of each facet, in N
    points : (6, 2) these points on the reference triangle, whose weights integrate quadratic polynomials exactly

    Raises
    ------
    InputError
        If the points do not determine a quadratic polynomial.
    """
    densities = _densities(forces, points)
    taken = max(1, FACETS_AND_TAXELS_AT_ONCE * len(places) // (len(places) + layout.rows * layout.columns))
    parts = [
        _forces_of(layout, places[begin : begin + taken], densities[:, begin : begin + taken])
        for begin in range(0, max(len(places), 1), taken)
    ]
    return TaxelForces(*(np.sum(amounts, axis=0) for amounts in zip(*parts, strict=True)))


def _forces_of(layout: TaxelLayout, places: Array, densities: Array) -> tuple[Array, Array, Array]:
    """Forces on the taxels, the gaps and outside of some facets."""
    pieces, facets = straight_pieces(places)
    for axis, along in enumerate("xy"):
        pieces, facets = cut(pieces, facets, axis, np.unique(layout.borders(along)))
    amounts = _integrals(pieces[:, :, 2:], facets, densities)
    middles = pieces[:, :, :2].mean(axis=1)
    column, between_columns = _cell(middles[:, 0], layout.borders("x"))
    row, between_rows = _cell(middles[:, 1], layout.borders("y"))
    on = (column >= 0) & (row >= 0)
    inside = between_columns & between_rows
    number, count = (row * layout.columns + column)[on], layout.rows * layout.columns
    taxels = np.stack([np.bincount(number, amount[on], count) for amount in amounts])
    taxels = taxels.reshape(3, layout.rows, layout.columns)
    return taxels, amounts[:, inside & ~on].sum(axis=1), amounts[:, ~inside].sum(axis=1)


def straight_pieces(places: Array) -> tuple[Array, Array]:
    """Triangles (T, 3, 4), each corner by its place in m and its reference coordinates, and the facet (T,) of each."""
    corners, middles = places[:, :3], places[:, 3:]
    expected = (corners + np.roll(corners, -1, axis=1)) / 2
    expected[:, 2] = (corners[:, 0] + corners[:, 2]) / 2
    size = np.abs(corners - corners[:, :1]).max(axis=(1, 2))
    curved = np.abs(middles - expected).max(axis=(1, 2)) > AFFINE * size
    parts = []
    for chosen, divisions in ((~curved, 1), (curved, SUBDIVISION)):
        reference = _divided(divisions)
        numbers = np.flatnonzero(chosen)
        mapped = np.einsum("tca,fad->ftcd", shape_functions(reference), places[numbers])
        both = np.concatenate([mapped, np.broadcast_to(reference, mapped.shape)], axis=-1)
        parts.append((both.reshape(-1, 3, 4), np.repeat(numbers, len(reference))))
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def cut(pieces: Array, facets: Array, axis: int, borders: Array) -> tuple[Array, Array]:
    """The triangles cut where their coordinate ``axis`` is one of the ascending ``borders`` (k,) in m, so that none crosses one.

    ``pieces`` (T, 3, 4) and ``facets`` (T,) are as `straight_pieces` gives them, and so are those that are returned.

    All triangles are cut at once, each at the middle one of the borders that it crosses, so that the rounds grow only like the
    logarithm of the number of borders.
    """
    done: list[tuple[Array, Array]] = []
    while len(pieces):
        values = pieces[:, :, axis]
        first = np.searchsorted(borders, values.min(axis=1), side="right")
        beyond = np.searchsorted(borders, values.max(axis=1), side="left")
        crossing = beyond > first
        done.append((pieces[~crossing], facets[~crossing]))
        pieces = _halved(pieces[crossing], axis, borders[(first + beyond)[crossing] // 2])
        facets = np.tile(facets[crossing], 3)
    return (np.concatenate([part[0] for part in done]), np.concatenate([part[1] for part in done])) if done else (pieces, facets)


def _halved(pieces: Array, axis: int, border: Array) -> Array:
    """Three triangles instead of each of (T, 3, 4) that crosses its own border (T,) with its coordinate ``axis``."""
    side = pieces[:, :, axis] - border[:, None]
    # The corner that is alone on its side comes first; a corner on the border belongs to the other two.
    alone = np.where((side > 0).sum(axis=1) == 1, (side > 0).argmax(axis=1), (side < 0).argmax(axis=1))
    order = (alone[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(pieces, order[:, :, None], axis=1), 1, 0)
    da, db, dc = np.take_along_axis(side, order, axis=1).T[:, :, None]
    ab, ac = a + da / (da - db) * (b - a), a + da / (da - dc) * (c - a)
    ab[:, axis] = ac[:, axis] = border  # exactly, or round-off would make it cross again
    return np.concatenate([np.stack(corners, axis=1) for corners in ((a, ab, ac), (ab, b, c), (ab, c, ac))])


def _divided(divisions: int) -> Array:
    """The reference triangle in ``divisions``^2 equal triangles by their corners (T, 3, 2)."""
    step, triangles = 1 / divisions, []
    for i in range(divisions):
        for j in range(divisions - i):
            origin = step * np.array([i, j])
            triangles.append(origin + step * CORNERS)
            if i + j < divisions - 1:
                triangles.append(origin + step * np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    return np.array(triangles)


def _densities(forces: Array, points: Array) -> Array:
    """Nodal values (3, F, 6), per reference triangle, of the polynomial whose weighted values at the points are ``forces``."""
    values = shape_functions(points)
    moments = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]) / 6
    if points.shape != (6, 2) or np.linalg.matrix_rank(values) < 6:
        raise InputError("six points that determine a quadratic polynomial are needed on each facet")
    weights = np.linalg.solve(values.T, moments)
    return np.einsum("aq,cfq->cfa", np.linalg.inv(values), forces / weights)


def _integrals(reference: Array, facets: Array, densities: Array) -> Array:
    """Integral (3, T) of each facet's density over triangles (T, 3, 2) of its reference triangle."""
    middles = (reference + np.roll(reference, -1, axis=1)) / 2
    (ux, uy), (vx, vy) = (np.moveaxis(reference[:, k] - reference[:, 0], -1, 0) for k in (1, 2))
    area = np.abs(ux * vy - uy * vx) / 2
    mean = np.einsum("tma,cta->ct", shape_functions(middles), densities[:, facets]) / 3
    return area * mean


def _cell(values: Array, borders: Array) -> tuple[Array, Array]:
    """Number of the interval that holds each value, -1 if none does, and whether it lies between the first and the last."""
    cell = np.searchsorted(borders[:, 0], values, side="right") - 1
    inside = (cell >= 0) & (values < borders[np.maximum(cell, 0), 1])
    return np.where(inside, cell, -1), (values >= borders[0, 0]) & (values < borders[-1, 1])
