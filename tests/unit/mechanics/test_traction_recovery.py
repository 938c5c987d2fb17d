"""The traction that taxels are cut out of: the same sum and the same constants, without what swings within facets."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.fem.assembly.space import FACET_POINTS
from tactsim.mechanics.contact import traction_recovery
from tactsim.mechanics.contact.traction_recovery import recovered_forces, shape_functions
from tactsim.mesh.quadratic import quadratic_mesh

SIDE = 1e-3
"""Of the squares in m that are halved into facets."""


def plane(cells=12):
    """Facets (F, 6) of a square and the places (n, 2) of their nodes in m, moved off the grid as a mesher would."""
    generator = np.random.default_rng(1)
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    corners = np.stack(np.meshgrid(*[np.arange(cells + 1.0)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    inner = ((corners > 0) & (corners < cells)).all(axis=1)
    corners[inner] += generator.uniform(-0.2, 0.2, (inner.sum(), 2))
    a, b, c, d = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    mesh = quadratic_mesh(SIDE * corners, np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]))
    elements = mesh.elements[:, [0, 1, 2, 3, 4, 5]]
    return elements, mesh.nodes


def weights_of(facets, nodes):
    a, b, c = (nodes[facets[:, k]] for k in range(3))
    area = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    values = shape_functions(FACET_POINTS)
    return area[:, None] * np.linalg.solve(values.T, np.array([0, 0, 0, 1, 1, 1]) / 6)


FACETS, NODES = plane()
WEIGHTS = weights_of(FACETS, NODES)
AT = np.einsum("qa,fad->fqd", shape_functions(FACET_POINTS), NODES[FACETS])


def recovered(traction):
    return recovered_forces(FACETS, traction * WEIGHTS, WEIGHTS, FACET_POINTS) / WEIGHTS


def test_a_constant_traction_stays():
    traction = np.broadcast_to(np.array([1.0, -2.0, 3e3])[:, None, None], (3, *WEIGHTS.shape))
    np.testing.assert_allclose(recovered(traction), traction, rtol=1e-10)


def test_the_sum_of_forces_stays():
    forces = np.random.default_rng(2).normal(size=(3, *WEIGHTS.shape)) * WEIGHTS
    after = recovered_forces(FACETS, forces, WEIGHTS, FACET_POINTS)
    np.testing.assert_allclose(after.sum(axis=(1, 2)), forces.sum(axis=(1, 2)), atol=1e-12 * np.abs(forces).sum())


def test_a_long_wave_stays_and_what_swings_from_facet_to_facet_does_not():
    long = np.cos(2 * np.pi * AT[..., 0] / (6 * SIDE))  # level at both ends, as the smoothing wants it
    missed = recovered(np.stack([long] * 3))[0] - long
    assert (
        np.sqrt((missed**2 * WEIGHTS).sum() / (long**2 * WEIGHTS).sum()) < 0.03
    )  # an even mesh keeps 99.9 % of a wave of six sides
    swinging = np.broadcast_to(np.where(np.arange(len(FACETS)) < len(FACETS) // 2, 1.0, -1.0)[:, None], long.shape)
    assert np.abs(recovered(np.stack([swinging] * 3))).mean() < 0.5


def kept_of_waves(lengths, cells=24):
    """Part that is kept of waves so many sides long along x in the middle of a plane of equal triangles."""
    i, j = np.meshgrid(*[np.arange(cells + 1.0)] * 2, indexing="ij")
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    corners = SIDE * np.stack([i - j / 2, np.sqrt(0.75) * j], axis=-1).reshape(-1, 2)
    mesh = quadratic_mesh(corners, np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]))
    weights = weights_of(mesh.elements, mesh.nodes)
    at = np.einsum("qa,fad->fqd", shape_functions(FACET_POINTS), mesh.nodes[mesh.elements])
    inner = np.abs(at - corners.mean(axis=0)).max(axis=2) < 4 * SIDE
    waves = np.stack([np.cos(2 * np.pi * at[..., 0] / (length * SIDE)) for length in lengths])
    after = recovered_forces(mesh.elements, waves * weights, weights, FACET_POINTS)
    return [(r * w)[inner].sum() / (weights * w**2)[inner].sum() for r, w in zip(after, waves, strict=True)]


def test_waves_fade_as_the_smoothing_says(monkeypatch):
    """1 - (c k^2 / (1 + c k^2))^3 of a wave of 2 pi / k sides, but for what facets cannot follow. Mutants: half of c, none."""

    def check():
        k = np.pi / np.array([1.0, 1.5, 2.0])
        left = 0.1 * k**2 / (1 + 0.1 * k**2)
        np.testing.assert_allclose(kept_of_waves([2.0, 3.0, 4.0]), 1 - left**3, atol=0.015)

    check()
    for wrong in (0.05, 1e-6):
        monkeypatch.setattr(traction_recovery, "SMOOTHING", wrong)
        assert_kills(check, smoothing=())


@pytest.mark.parametrize("order", [(1, 2, 0), (1, 0, 2)])
def test_the_order_of_the_corners_does_not_matter(order):
    middles = {(0, 1): 3, (1, 2): 4, (0, 2): 5}
    sides = [(order[0], order[1]), (order[1], order[2]), (order[0], order[2])]
    columns = [*order, *(middles[tuple(sorted(side))] for side in sides)]
    facets = FACETS.copy()
    facets[::3] = facets[::3][:, columns]
    places = np.einsum("qa,fad->fqd", shape_functions(FACET_POINTS), NODES[facets])
    field = np.sin(700 * places[..., 0]) * places[..., 1] / SIDE
    forces = recovered_forces(facets, np.stack([field * WEIGHTS] * 3), WEIGHTS, FACET_POINTS)
    plain = np.sin(700 * AT[..., 0]) * AT[..., 1] / SIDE
    before = recovered_forces(FACETS, np.stack([plain * WEIGHTS] * 3), WEIGHTS, FACET_POINTS)
    np.testing.assert_allclose(forces.sum(axis=2), before.sum(axis=2), atol=1e-10 * np.abs(before).sum(axis=2).max())


def test_facets_without_force_keep_none():
    forces = np.zeros((3, *WEIGHTS.shape))
    forces[2, :40] = WEIGHTS[:40]
    after = recovered_forces(FACETS, forces, WEIGHTS, FACET_POINTS)
    assert not after[:, 40:].any()
    assert not recovered_forces(FACETS, 0 * forces, WEIGHTS, FACET_POINTS).any()
