"""Forces on taxels: exact for uniform pressure on straight facets, nothing lost on curved ones, borders where they should be."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import ElementTriP2, MeshTri
from skfem.quadrature import get_quadrature

from tactsim.errors import CaseError, InputError
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.mechanics.contact.surface_forces import taxel_forces

X, W = get_quadrature(ElementTriP2(), 4)
POINTS = X.T
MIDDLES = ((0, 1), (1, 2), (0, 2))


def sheet(width, cells, *, bend=0.0, seed=1):
    """Quadratic facets (F, 6, 2) of a square about the origin with jittered nodes; ``bend`` moves the mid-sides inside."""
    mesh = MeshTri.init_tensor(*[np.linspace(-width / 2, width / 2, cells + 1)] * 2)
    generator = np.random.default_rng(seed)
    nodes = mesh.p.T.copy()
    inner = (np.abs(nodes) < width / 2 * (1 - 1e-9)).all(axis=1)
    nodes[inner] += generator.uniform(-0.2, 0.2, (inner.sum(), 2)) * width / cells
    corners = nodes[mesh.t.T]
    middles = np.stack([(corners[:, a] + corners[:, b]) / 2 for a, b in MIDDLES], axis=1)
    wave = np.cos(np.pi * middles / width).prod(axis=-1, keepdims=True)
    return np.concatenate([corners, middles + bend * width / cells * wave], axis=1)


def areas(places):
    (ux, uy), (vx, vy) = (np.moveaxis(places[:, k] - places[:, 0], -1, 0) for k in (1, 2))
    return np.abs(ux * vy - uy * vx) / 2


def pressed(places, traction):
    """Forces (3, F, 6) of a traction (3,) per area of the straight triangles."""
    return np.asarray(traction)[:, None, None] * (2 * areas(places))[:, None] * W


@pytest.mark.parametrize("cells", [1, 4, 9])
@pytest.mark.parametrize(
    "layout",
    [
        TaxelLayout(),
        TaxelLayout(rows=5, columns=2, pitch=7e-3, size=7e-3),
        TaxelLayout(rows=32, columns=32, pitch=1e-3, size=0.8e-3),
    ],
)
def test_uniform_pressure_reads_itself(cells, layout):
    places = sheet(40e-3, cells)
    forces = taxel_forces(layout, places, pressed(places, [1.0, -2.0, 3e3]), POINTS)
    expected = np.array([1.0, -2.0, 3e3]) * layout.area
    np.testing.assert_allclose(forces.taxels, np.broadcast_to(expected[:, None, None], forces.taxels.shape), rtol=1e-10)
    width, depth = layout.extent()
    matrix = width * depth - layout.rows * layout.columns * layout.area
    np.testing.assert_allclose(forces.gaps, np.array([1.0, -2.0, 3e3]) * matrix, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(forces.total, np.array([1.0, -2.0, 3e3]) * 1.6e-3, rtol=1e-12)


def test_a_linear_pressure_has_its_moment():
    places = sheet(40e-3, 6)
    at = np.einsum("qk,fkd->fqd", np.stack([1 - X[0] - X[1], X[0], X[1]], axis=1), places[:, :3])
    forces = np.zeros((3, *at.shape[:2]))
    forces[2] = (1e3 + 1e5 * at[..., 0]) * (2 * areas(places))[:, None] * W
    layout = TaxelLayout()
    moments = taxel_forces(layout, places, forces, POINTS).taxels[2]
    expected = (1e3 + 1e5 * layout.borders("x").mean(axis=1)) * layout.area
    np.testing.assert_allclose(moments, np.broadcast_to(expected, (3, 3)), rtol=1e-10, atol=1e-15)


def test_curved_facets_lose_nothing_and_converge():
    layout = TaxelLayout(pitch=9e-3, size=8e-3)
    bent = sheet(40e-3, 8, bend=0.1)
    forces = np.random.default_rng(2).normal(size=(3, len(bent), 6))
    np.testing.assert_allclose(taxel_forces(layout, bent, forces, POINTS).total, forces.sum(axis=(1, 2)), atol=1e-12)


def test_tissue_that_covers_half_a_taxel_and_none():
    layout = TaxelLayout(rows=1, columns=2, pitch=10e-3, size=8e-3)
    places = sheet(10e-3, 3) + np.array([5e-3, 0.0])
    forces = taxel_forces(layout, places, pressed(places, [0.0, 0.0, 1.0]), POINTS)
    assert forces.taxels[2, 0] == pytest.approx([0.0, 8e-3**2], abs=1e-15)
    shifted = taxel_forces(layout, places + np.array([4e-3, 0.0]), pressed(places, [0.0, 0.0, 1.0]), POINTS)
    assert shifted.taxels[2, 0] == pytest.approx([0.0, 5e-3 * 8e-3], abs=1e-15)


def test_row_one_is_at_the_front_and_column_one_at_the_left():
    layout = TaxelLayout()
    places = sheet(4e-3, 1) + np.array([-10e-3, 10e-3])
    forces = taxel_forces(layout, places, pressed(places, [0.0, 0.0, 1.0]), POINTS).taxels[2]
    assert np.unravel_index(forces.argmax(), (3, 3)) == (2, 0)
    assert np.count_nonzero(forces) == 1


def test_impossible_layouts_and_points_are_refused():
    with pytest.raises(CaseError, match="overlap at a pitch"):
        TaxelLayout(pitch=1e-3, size=2e-3)
    places = sheet(4e-3, 1)
    with pytest.raises(InputError, match="six points"):
        taxel_forces(TaxelLayout(), places, np.zeros((3, 2, 6)), np.tile(POINTS[:1], (6, 1)))
