"""The split of the ring kernel, the weights of the logarithm and the waves of a layer against adaptive quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval
from scipy.integrate import quad
from scipy.special import ellipk, j0

from tactsim.analytic.annular_kernel import LogarithmicRing, split_kernel, wave_quadrature
from tactsim.analytic.layer_kernel import Layer


def test_the_split_adds_up_to_the_kernel():
    delta = np.concatenate([-np.geomspace(0.3, 30, 50), np.geomspace(0.3, 30, 50)])
    singular, smooth = split_kernel(delta)
    kernel = 2 * ellipk(np.cosh(delta / 2) ** -2) / (1 + np.exp(delta))
    np.testing.assert_allclose(singular * np.log(np.abs(delta)) + smooth, kernel, rtol=1e-12, atol=1e-14)


def test_the_parts_are_smooth_through_zero():
    """A kink, or a separation taken too coarsely, shows in the high Chebyshev coefficients."""
    nodes = np.cos((np.arange(80) + 0.5) * np.pi / 80)
    for part in split_kernel(2 * nodes):
        coefficients = np.cos(np.outer(np.arange(80), np.arccos(nodes))) @ part / 40
        assert np.abs(coefficients[60:]).max() < 1e-13 * np.abs(part).max()  # round-off
    np.testing.assert_allclose(np.ravel(split_kernel(np.zeros(1))), [-1, 3 * np.log(2)], rtol=1e-14)


@pytest.mark.parametrize("separation", [1e-300, 1e-17, 1e-12, 1e-8, 1e-6])
def test_the_slope_at_zero_is_kept(separation):
    """The factor 2 / (1 + exp(delta)) is not even; its slope at 0 is -1/2."""
    plus, minus = split_kernel(np.array([separation])), split_kernel(np.array([-separation]))
    for right, left in zip(plus, minus, strict=True):
        assert right[0] - left[0] == pytest.approx(-separation * left[0], rel=1e-3, abs=1e-15 * abs(left[0]))


@pytest.mark.parametrize("x", [-1.0, -0.9, 0.2, 1.0, -1.3, 1.000001, 5.0])
def test_logarithm_weights_against_quadrature(x):
    ring = LogarithmicRing(0.3, 24)
    coefficients = [0.3, -1.0, 0.5, 0.2, 0.0, 0.7]

    def integrand(angle):
        return chebval(np.cos(angle), coefficients) * np.log(abs(x - np.cos(angle)))

    middle = float(np.arccos(np.clip(x, -1, 1)))
    expected = sum(
        quad(integrand, *ends, limit=400, epsabs=1e-12)[0] for ends in ((0, middle), (middle, np.pi)) if ends[1] > ends[0]
    )
    weights = ring.logarithm_weights(np.exp([ring.half_length * (x - 1)]))
    assert float(weights[0] @ chebval(ring.nodes, coefficients)) == pytest.approx(
        expected, abs=1e-9
    )  # error of quad at the logarithm


def test_the_waves_resolve_the_layer_and_their_own_product():
    layer = Layer(1.0)
    x, weights = wave_quadrature(80.0)
    computed = float(weights @ (layer.deficit(x) * j0(79.0 * x) * j0(80.0 * x)))
    expected = quad(lambda x: float(layer.deficit(x)) * j0(79 * x) * j0(80 * x), 0, 24, limit=5000, epsabs=1e-13)[0]
    assert computed == pytest.approx(expected, abs=1e-12)
    coarse, coarse_weights = wave_quadrature(8.0)
    assert float(coarse_weights @ (layer.deficit(coarse) * j0(79.0 * coarse) * j0(80.0 * coarse))) != pytest.approx(
        expected, abs=1e-8
    )
