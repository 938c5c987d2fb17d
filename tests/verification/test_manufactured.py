"""Orders of convergence at finite strain against manufactured solutions (verification.md, 6).

Theory for Taylor-Hood P2/P1: 3 for u in L2, 2 for u in H1, 2 for p in L2 (Boffi, Brezzi & Fortin 2013, section 8.8).
The maps strain by 20 to 40 %; the incompressible ones are compositions of volume-preserving maps.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from manufactured import Manufactured, measured_errors
from solids import box, fitted_order, on_plane

from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
ORDERS = (3.0, 2.0, 2.0)
TOLERANCE = 0.1
"""Of a fitted order: demanded by the style guide; the meshes are fine enough for the leading term to rule."""
INCOMPRESSIBLE = MooneyRivlin2(c10=1.0, c01=0.5)
COMPRESSIBLE = MooneyRivlin2(c10=1.0, c01=0.5, bulk_modulus=5.0)


def isochoric_axisymmetric(X):
    """z moves with r; then z is stretched unevenly and r contracts to keep the volume: r' = r / sqrt(dz'/dz)."""
    r, z = X[0], X[1] + 0.2 * np.cos(2 * X[0])
    return np.stack([r / np.sqrt(1 + 0.2 * np.cos(2 * z)), z + 0.1 * np.sin(2 * z)])


def general_axisymmetric(X):
    """r odd and z even in r, as smoothness on the axis demands."""
    r, z = X
    return np.stack([r * (1 + 0.1 * np.sin(2 * z) - 0.05 * r**2), z + 0.1 * np.sin(z + r**2)])


def isochoric_plane(X):
    """Two shears."""
    x = X[0] + 0.15 * np.sin(2 * X[1])
    return np.stack([x, X[1] + 0.15 * np.sin(1.5 * x)])


def general_plane(X):
    """The two shears and an uneven stretch."""
    x, y = isochoric_plane(X)
    return np.stack([x * (1 + 0.1 * np.sin(y)), y + 0.05 * np.sin(2 * x)])


def isochoric_solid(X):
    """Three shears."""
    x = X[0] + 0.2 * np.sin(X[1] + 0.5 * X[2])
    y = X[1] + 0.2 * np.sin(0.7 * X[2] + 0.6 * x)
    return np.stack([x, y, X[2] + 0.2 * np.sin(0.5 * x + y)])


def general_solid(X):
    """The three shears and an uneven stretch."""
    x, y, z = isochoric_solid(X)
    return np.stack([x * (1 + 0.1 * np.sin(y)), y + 0.05 * np.sin(z), z * (1 + 0.05 * np.cos(x))])


def plane_pressure(X):
    """A smooth pressure, even in the first coordinate."""
    return 0.5 * np.cos(2 * X[0]) * np.cos(X[1])


def solid_pressure(X):
    """A smooth pressure."""
    return 0.5 * np.cos(X[0] + X[1]) * np.cos(X[2])


CASES = {
    "axisymmetric-incompressible": Manufactured("axisymmetric", INCOMPRESSIBLE, isochoric_axisymmetric, plane_pressure),
    "axisymmetric-compressible": Manufactured("axisymmetric", COMPRESSIBLE, general_axisymmetric),
    "plane_strain-incompressible": Manufactured("plane_strain", INCOMPRESSIBLE, isochoric_plane, plane_pressure),
    "plane_strain-compressible": Manufactured("plane_strain", COMPRESSIBLE, general_plane),
    "solid-incompressible": Manufactured("solid", INCOMPRESSIBLE, isochoric_solid, solid_pressure),
    "solid-compressible": Manufactured("solid", COMPRESSIBLE, general_solid),
}

LONG = ("solid-compressible", "plane_strain-compressible", "axisymmetric-incompressible")
"""Orders of the last one on coarse meshes are asked beside each of its mutants."""
AXISYMMETRIC = "axisymmetric-incompressible"
QUICK_MUTANTS = (AXISYMMETRIC,)


def ladder(exact: Manufactured, *, posed: Manufactured | None = None, first: int = 1) -> list[float]:
    """Fitted orders of (u in L2, u in H1, p in L2) over three meshes, the bottom held and the rest under tractions.

    In the plane the meshes are refined ``first`` times and once and twice more.
    """
    if exact.measure == "solid":
        meshes = {1 / count: box([1.0] * 3, [count] * 3) for count in (3, 4, 6)}
    else:
        levels = range(first, first + 3)
        meshes = {2.0**-level: box([1.0] * 2, [5] * 2, jitter=0.2, seed=1, refinements=level) for level in levels}
    bottom = on_plane(2 if exact.measure == "solid" else 1, 0.0)
    errors = np.array([measured_errors(exact, mesh, bottom, posed=posed or exact) for mesh in meshes.values()])
    return [fitted_order(list(meshes), errors[:, column]) for column in range(3)]


def assert_orders(orders: list[float], tolerance: float = TOLERANCE) -> None:
    """Every order within the tolerance of theory."""
    assert np.abs(np.subtract(orders, ORDERS)).max() <= tolerance, f"orders {np.round(orders, 3)}, theory {ORDERS}"


@cache
def coarse_orders(name: str) -> list[float]:
    """Orders on coarse meshes, which several mutants are held against."""
    return ladder(CASES[name], first=0)


def assert_seen(name: str, posed: Manufactured, first: int) -> None:
    """Loads of a wrong model miss an order by more than is allowed, those of the exact one do not."""
    tolerance = TOLERANCE if first else 2 * TOLERANCE  # on coarse meshes the second term of the error still counts
    if not first:
        assert_orders(coarse_orders(name), tolerance)
    with pytest.raises(AssertionError):
        assert_orders(ladder(CASES[name], posed=posed, first=first), tolerance)


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if name in LONG else name for name in CASES])
def test_orders_of_convergence(name, verification_record):
    orders = ladder(CASES[name])
    assert_orders(orders)
    known = {"reference": "manufactured solution; theory of P2/P1 elements", "kind": "convergence", "tolerance": TOLERANCE}
    for norm, order, theory in zip(("u in L2", "u in H1", "p in L2"), orders, ORDERS, strict=True):
        verification_record(f"{name}, {norm}", order=order, theory=theory, mesh="three meshes", **known)


coarse_and_fine = pytest.mark.parametrize("first", [0, pytest.param(1, marks=pytest.mark.slow)])
"""A wrong model is seen on coarse meshes already; on those of the orders themselves it takes four times as long."""


@pytest.mark.parametrize(
    ("name", "first"),
    [
        pytest.param(name, first, marks=pytest.mark.slow if first or name not in QUICK_MUTANTS else ())
        for name, exact in CASES.items()
        for first in ((1,) if exact.measure == "solid" else (0, 1))
    ],
)
def test_loads_of_a_material_with_c01_wrong_by_a_percent_are_seen(name, first):
    wrong = CASES[name].material.model_copy(update={"c01": 0.505})
    assert_seen(name, replace(CASES[name], material=wrong), first)


@coarse_and_fine
def test_a_missing_part_of_the_pressure_is_seen(first):
    exact = CASES[AXISYMMETRIC]
    assert_seen(AXISYMMETRIC, replace(exact, given_pressure=lambda X: 0.99 * exact.given_pressure(X)), first)


@coarse_and_fine
def test_a_body_force_without_the_hoop_stress_is_seen(first):
    """Mutant: the divergence of plane strain on an axisymmetric body, its deformation and stress otherwise the same."""

    class WithoutHoop(Manufactured):
        def body_force(self, X):
            P = self.stress(X)
            return super().body_force(X) + np.stack([(P[0, 0] - P[2, 2]) / X[0], 0 * X[0]])

    exact = CASES[AXISYMMETRIC]
    assert_seen(AXISYMMETRIC, WithoutHoop(exact.measure, exact.material, exact.placement, exact.given_pressure), first)
