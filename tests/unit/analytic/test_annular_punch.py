"""The solved annular punch: shapes, edges, limits, self-consistency, adaptivity and what is refused."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad

from tactsim.analytic import annular_punch
from tactsim.analytic.annular_punch import TERMS, solve_annular_punch
from tactsim.errors import ConvergenceError, InvalidQuantity, UnknownName

RATIOS = (0.0, 1e-6, 0.05, 0.5, 0.9, 0.999)


def force_by_quadrature(punch):
    """kappa = (pi / 2) integral of p r, with r = (1 + b) / 2 - (1 - b) / 2 cos(angle) against the singular edges."""
    middle, half = (1 + punch.radius_ratio) / 2, (1 - punch.radius_ratio) / 2

    def integrand(angle):
        r = middle - half * np.cos(angle)
        return float(punch.pressure(r)) * r * half * np.sin(angle)

    return np.pi / 2 * quad(integrand, 0, np.pi, limit=400, epsabs=1e-11, epsrel=1e-11)[0]


@pytest.mark.parametrize("slenderness", [0.0, 1.0, 10.0])
@pytest.mark.parametrize("ratio", RATIOS)
def test_the_force_is_the_integral_of_the_pressure(ratio, slenderness):
    punch = solve_annular_punch(ratio, radius_over_thickness=slenderness)
    tolerance = 1e-6 if ratio in (1e-6, 0.999) else 1e-8  # 1e-6: pressure peaks in 1e-6 of the width; 0.999: 1 - r has 13 digits
    assert force_by_quadrature(punch) == pytest.approx(punch.force_factor, rel=tolerance)


def test_the_pressure_of_a_tissue_barely_compressible_has_another_force():
    punch, other = (solve_annular_punch(0.5, radius_over_thickness=1.0, poisson_ratio=nu) for nu in (0.5, 0.4999))
    assert force_by_quadrature(other) != pytest.approx(punch.force_factor, rel=1e-6)


def test_a_solid_punch_on_the_half_space_is_the_closed_form():
    """Boussinesq 1885; Johnson 1985, Contact Mechanics, chapter 3: p = (2 / pi) / sqrt(1 - r^2), u = (2 / pi) asin(1 / r)."""
    punch = solve_annular_punch(0.0)
    assert punch.force_factor == pytest.approx(1, rel=1e-13)
    assert punch.rise_factor == 0
    r = np.array([0, 1e-9, 1e-4, 1e-3, 0.2, 0.9, 0.999999])
    np.testing.assert_allclose(punch.pressure(r), 2 / np.pi / np.sqrt((1 - r) * (1 + r)), rtol=2e-11)  # parabola at the centre
    far = np.array([1 + 1e-12, 1.001, 1.5, 20, 1e6, 1e100])
    np.testing.assert_allclose(punch.surface_displacement(far), 2 / np.pi * np.arcsin(1 / far), rtol=1e-13)


@pytest.mark.parametrize("slenderness", [0.0, 2.0, pytest.param(20.0, marks=pytest.mark.slow)])
def test_tiny_holes_pass_into_no_hole(slenderness):
    solid = solve_annular_punch(0.0, radius_over_thickness=slenderness)
    tiny = solve_annular_punch(1e-6, radius_over_thickness=slenderness)
    assert tiny.force_factor == pytest.approx(solid.force_factor, rel=1e-10)
    np.testing.assert_allclose(tiny.pressure([0.01, 0.5, 0.99]), solid.pressure([0.01, 0.5, 0.99]), rtol=1e-9)


def test_a_hole_below_all_digits_is_none():
    assert solve_annular_punch(1e-13) == dataclasses.replace(solve_annular_punch(0.0), radius_ratio=1e-13)


@pytest.mark.parametrize("slenderness", [0.0, 1.0, 20.0])
@pytest.mark.parametrize("ratio", [1e-6, 0.3, 0.9, 0.999])
def test_the_surface_leaves_the_edges_continuously(ratio, slenderness):
    """It leaves like the root of the distance; the coefficient is that of the singular pressure."""
    punch = solve_annular_punch(ratio, radius_over_thickness=slenderness)
    width = 1 - ratio
    for edge, side in ((1.0, 1), (ratio, -1)):
        length = min(width, edge, 1 / (1 + slenderness))
        near, far = (float(punch.rise(edge + side * d * length)) for d in (1e-8, 1e-6))
        assert 0 < near < 1e-3 * punch.force_factor * (1 + slenderness)
        assert far / near == pytest.approx(10, rel=1e-2)
    np.testing.assert_array_equal(punch.surface_displacement([ratio, (1 + ratio) / 2, 1]), 1)


def test_the_edges_are_singular_and_the_free_surface_is_free():
    punch = solve_annular_punch(0.5)
    np.testing.assert_array_equal(punch.pressure([0, 0.25, 0.5, 1, 1.001, 7]), [0, 0, np.inf, np.inf, 0, 0])
    assert punch.pressure(0.5 + 1e-12) > 1e4
    solid = solve_annular_punch(0.0, radius_over_thickness=1.0)
    np.testing.assert_array_equal(np.isinf(solid.pressure([0, 1e-8, 0.5, 1])), [False, False, False, True])


def test_shapes_follow_the_radii():
    punch = solve_annular_punch(0.4, radius_over_thickness=0.5)
    r = np.linspace(0, 3, 24).reshape(2, 3, 4)
    for method in (punch.pressure, punch.surface_displacement, punch.rise):
        values = method(r)
        assert values.shape == r.shape
        assert method(0.7).shape == ()
        assert method([]).shape == (0,)
        np.testing.assert_allclose(values.ravel(), [float(method(x)) for x in r.ravel()], rtol=1e-10, atol=1e-13)


def test_many_radii_are_done_in_pieces():
    punch = solve_annular_punch(0.5, radius_over_thickness=1.0)
    r = np.linspace(0, 2, 2501)
    np.testing.assert_allclose(punch.rise(r)[::250], punch.rise(r[::250]), rtol=1e-9, atol=1e-13)


def test_the_far_field_is_that_of_the_force():
    """A point force on the half-space: u = (1 - nu) P / (2 pi G r) = (2 / pi) kappa / r."""
    punch = solve_annular_punch(0.7)
    r = np.array([1e4, 1e8])
    np.testing.assert_allclose(punch.surface_displacement(r), 2 / np.pi * punch.force_factor / r, rtol=1e-8)


@pytest.mark.parametrize("base", ["bonded", "slipping"])
def test_a_layer_is_at_rest_far_from_the_punch(base):
    punch = solve_annular_punch(0.5, radius_over_thickness=2.0, base=base)
    np.testing.assert_allclose(punch.surface_displacement([19.0, 25.9, 26.1, 1e9]), 0, atol=1e-10)
    assert punch.surface_displacement(26.1) == 0


@pytest.mark.parametrize("base", ["bonded", "slipping"])
@pytest.mark.parametrize("ratio", [0.0, 0.5, 0.95])
def test_a_thick_layer_passes_into_the_half_space(ratio, base):
    half_space = solve_annular_punch(ratio)
    excess = [
        solve_annular_punch(ratio, radius_over_thickness=slenderness, base=base).force_factor / half_space.force_factor - 1
        for slenderness in (1e-3, 1e-6, 1e-9)
    ]
    assert excess[0] == pytest.approx(1e3 * excess[1], rel=5e-3)  # first order in a / h
    assert 0 < excess[1] < 2e-6
    assert abs(excess[2]) < 2e-9


def test_a_slipping_layer_does_not_feel_poissons_ratio():
    for slenderness in (0.5, 5.0):
        first, second = (
            solve_annular_punch(0.3, radius_over_thickness=slenderness, base="slipping", poisson_ratio=nu) for nu in (0.5, -0.5)
        )
        assert first.force_factor == second.force_factor
        assert first.rise_factor == second.rise_factor
    bonded = [solve_annular_punch(0.3, radius_over_thickness=1.0, poisson_ratio=nu).force_factor for nu in (0.5, 0.49)]
    assert bonded[0] > 1.02 * bonded[1]


@pytest.mark.parametrize("poisson_ratio", [-0.9, *(pytest.param(value, marks=pytest.mark.slow) for value in (0.0, 0.3)), 0.5])
@pytest.mark.parametrize("ratio", RATIOS)
def test_every_layer_to_twenty_radii_settles(ratio, poisson_ratio):
    for slenderness in (0.1, 3.0, 20.0):
        punch = solve_annular_punch(ratio, radius_over_thickness=slenderness, poisson_ratio=poisson_ratio)
        assert punch.error <= 1e-10
        assert punch.force_factor > 0


def test_points_are_added_until_the_answer_stands():
    terms = [solve_annular_punch(0.25, radius_over_thickness=slenderness).terms for slenderness in (0.0, 20.0)]
    assert terms[0] < terms[1]
    assert set(terms) <= set(TERMS)
    rough, fine = (solve_annular_punch(0.0, radius_over_thickness=5.0, tolerance=tolerance) for tolerance in (1e-2, 1e-13))
    assert rough.terms < fine.terms
    assert rough.force_factor == pytest.approx(fine.force_factor, rel=1e-2)


def test_giving_up_names_the_contact_and_keeps_the_changes(monkeypatch):
    monkeypatch.setattr(annular_punch, "TERMS", TERMS[:3])
    message = rf"radius over thickness 90 still changes by .* not 1e-10, at {TERMS[2]} points"
    with pytest.raises(ConvergenceError, match=message) as caught:
        solve_annular_punch(0.0, radius_over_thickness=90.0)
    assert len(caught.value.history) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"radius_ratio": -0.1}, r"radius ratio -0.1 .* allowed: \[0, 0.9999\]"),
        ({"radius_ratio": 1.0}, "radius ratio 1.0"),
        ({"radius_ratio": np.nan}, "radius ratio nan"),
        ({"radius_ratio": 0.5, "radius_over_thickness": -1.0}, "radius over thickness -1.0"),
        ({"radius_ratio": 0.5, "radius_over_thickness": np.inf}, "radius over thickness inf"),
        ({"radius_ratio": 0.5, "poisson_ratio": 0.6}, "Poisson's ratio 0.6"),
        ({"radius_ratio": 0.5, "tolerance": 0.0}, "tolerance 0.0"),
    ],
)
def test_arguments_out_of_range_are_refused(arguments, message):
    with pytest.raises(InvalidQuantity, match=message):
        solve_annular_punch(**arguments)


def test_other_bases_and_radii_are_refused():
    with pytest.raises(UnknownName, match="base of a layer 'glued'"):
        solve_annular_punch(0.5, base="glued")
    punch = solve_annular_punch(0.5)
    for method in (punch.pressure, punch.surface_displacement, punch.rise):
        for radius in (-0.1, np.nan, np.inf):
            with pytest.raises(InvalidQuantity, match=r"radius over outer radius .* allowed: \[0, inf\)"):
                method([0.5, radius])
