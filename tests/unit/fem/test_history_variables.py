"""The weight of the bend in a step of time, where its formula cancels."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.fem.assembly.history_variables import SMALL, _bend_weight

AGREEMENT = 1e-10
"""Relative: round-off of terms of 1 / h^2 of which h / 12 is left, 1e-16 * 12 / h^2 at ``SMALL`` and some roundings of it."""


@pytest.mark.parametrize("h", [1e-6, 1e-3, 0.5 * SMALL, np.nextafter(SMALL, 0.0), SMALL, 3 * SMALL, 0.3])
def test_the_weight_of_the_bend_is_its_series_on_both_sides_of_where_the_formula_begins(h: float) -> None:
    """Reference: the series with 20 terms in exact fractions, from those of exp. Mutant: two terms of it."""

    def psi(terms: int) -> float:
        signed = (Fraction((-1) ** (k + 1) * k, 2 * factorial(k + 2)) * Fraction(float(h)) ** k for k in range(1, terms + 1))
        return float(sum(signed, Fraction(0)))

    def check(weight: float) -> None:
        assert abs(weight / psi(20) - 1) <= AGREEMENT

    check(float(_bend_weight(np.array(h))))
    if h > 1e-4:
        assert_kills(check, two_terms=(psi(2),))
