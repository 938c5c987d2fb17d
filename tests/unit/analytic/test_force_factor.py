"""The quick force factor: interpolation error, formulas, units, work and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic import force_factor as interpolated
from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.analytic.force_factor import (
    FORMULAS,
    INTERPOLATION_ERROR,
    force_factor,
    rise_factor,
)
from tactsim.errors import InvalidQuantity, UnknownName

RATIOS = np.concatenate([np.linspace(0, 0.99, 151), np.geomspace(1e-9, 0.1, 20), 0.99 * (1 - np.geomspace(1e-9, 0.1, 20))])


def test_the_interpolant_keeps_its_error():
    punches = [solve_annular_punch(ratio, tolerance=1e-12) for ratio in RATIOS]
    force_errors = force_factor(RATIOS) - [punch.force_factor for punch in punches]
    rise_errors = rise_factor(RATIOS) - [punch.rise_factor for punch in punches]
    assert INTERPOLATION_ERROR <= 1e-9
    assert np.abs(force_errors).max() <= INTERPOLATION_ERROR
    assert np.abs(rise_errors).max() <= INTERPOLATION_ERROR
    shifted = force_factor(RATIOS * (1 - 1e-9)) - [punch.force_factor for punch in punches]
    assert np.abs(shifted).max() > INTERPOLATION_ERROR, "a ratio off by 1e-9 is seen"


@pytest.mark.parametrize(
    ("formula", "ratio", "error", "tolerance"),
    [
        ("thesis_4_2_21", 0.5, -0.006, 5e-4),  # errata.md, E6: printed to one digit
        ("thesis_4_2_21", 0.8, -0.020, 5e-4),
        ("thesis_4_2_21", 0.99, 0.23, 5e-3),
        ("small_hole_series", 0.5, 3e-4, 5e-5),  # verification.md, 3.2
        ("small_hole_series", 0.8, 0.0139 / 0.8976, 5e-3),
        ("smythe", 0.75, -0.0034, 5e-5),
        ("smythe", 0.95, -0.019, 5e-4),
        ("exact", 0.5, 0.0, 1e-12),
    ],
)
def test_the_formulas_have_their_known_errors(formula, ratio, error, tolerance):
    computed = float(force_factor(ratio, formula) / force_factor(ratio)) - 1
    assert computed == pytest.approx(error, abs=tolerance)


def test_the_formulas_are_distinguished():
    values = np.array([float(force_factor(0.8, formula)) for formula in FORMULAS])
    apart = np.abs(values[:, None] - values)[~np.eye(values.size, dtype=bool)]
    assert apart.min() > 1e-3


@pytest.mark.parametrize("formula", FORMULAS)
def test_every_formula_starts_at_one_and_keeps_the_shape(formula):
    assert float(force_factor(0.0, formula)) == pytest.approx(1, rel=1e-12)
    ratios = np.linspace(0, 0.99, 12).reshape(3, 4)
    values = force_factor(ratios, formula)
    assert values.shape == (3, 4)
    np.testing.assert_allclose(values[1, 2], force_factor(float(ratios[1, 2]), formula), rtol=1e-15)
    assert force_factor([], formula).shape == (0,)


def test_a_hundred_thousand_pairs_need_no_more_solutions_than_one(monkeypatch):
    force_factor(0.5)  # makes the interpolant
    monkeypatch.setattr(interpolated, "solve_annular_punch", None)
    ratio = np.random.default_rng(3).uniform(0, 0.99, 100_000)
    assert force_factor(ratio).shape == ratio.shape


def test_unknown_formulas_are_refused_with_the_known_ones():
    with pytest.raises(UnknownName, match=r"formula of the force factor 'smyth' \(did you mean 'smythe'\?\); known: exact, "):
        force_factor(0.5, "smyth")


@pytest.mark.parametrize("ratio", [-0.01, 0.9901, 1.0, np.nan])
def test_ratios_out_of_range_are_refused(ratio):
    for function in (force_factor, rise_factor):
        with pytest.raises(InvalidQuantity, match=r"radius ratio .* allowed: \[0, 0.99\]"):
            function([0.5, ratio])
