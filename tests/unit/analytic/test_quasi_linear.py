"""Quasi-linear superposition against closed forms, its order, and the times that it takes."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.quasi_linear import quasi_linear
from tactsim.errors import InvalidQuantity

MODULUS = GeneralizedMaxwell(3.0, [2.0, 5.0], [0.1, 4.0])


def test_a_ramp_is_the_integral_of_the_modulus_on_uneven_times():
    time = np.append(0.0, np.sort(np.random.default_rng(1).uniform(0, 8, 200)))
    terms = MODULUS.moduli * MODULUS.times * -np.expm1(-time[:, None] / MODULUS.times)
    expected = (3.0 * time + terms.sum(axis=1)) / 10.0
    np.testing.assert_allclose(quasi_linear(time, time, MODULUS), expected, rtol=1e-12)
    swapped = GeneralizedMaxwell(3.0, MODULUS.moduli[::-1], MODULUS.times)
    assert not np.allclose(quasi_linear(time, time, swapped), expected, rtol=1e-2, atol=0)


def test_a_jump_relaxes_by_the_modulus_and_columns_are_alone():
    time = np.linspace(0, 10, 50)
    elastic = np.column_stack([np.full(50, 2.0), np.zeros(50)])
    computed = quasi_linear(time, elastic, MODULUS)
    np.testing.assert_allclose(computed[:, 0], 2 * MODULUS.relaxation(time) / 10, rtol=1e-12)
    assert not computed[:, 1].any()


def test_a_curved_answer_converges_with_the_second_order():
    def last(samples):
        time = np.linspace(0, 2, samples + 1)
        return quasi_linear(time, time**3, MODULUS)[-1]

    errors = np.abs(np.array([last(n) for n in (50, 100, 200, 400)]) - last(20_000))
    orders = np.log2(errors[:-1] / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


@pytest.mark.parametrize("time", [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, 1.0], []])
def test_times_that_do_not_increase_are_refused(time):
    with pytest.raises(InvalidQuantity, match="increasing"):
        quasi_linear(np.array(time), np.zeros(3), MODULUS)
