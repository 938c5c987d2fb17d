"""The transfer function of a layer: its formula in extended precision, its limits, and its range."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.layer_kernel import Layer
from tactsim.errors import InvalidQuantity, UnknownName

RATIOS = (-0.99, 0.0, 0.3, 0.49, 0.5)
LAYERS = [Layer(1.0, ratio, base) for ratio in RATIOS for base in ("bonded", "slipping")]


def printed_transfer(layer, x):
    """The formula as printed, in extended precision: 1e-15 at x = 0.01, where 4 digits cancel."""
    x, k = np.asarray(x, dtype=np.longdouble), np.longdouble(3 - 4 * layer.poisson_ratio)
    if layer.base == "slipping":
        return (np.cosh(2 * x) - 1) / (np.sinh(2 * x) + 2 * x)
    return (2 * k * np.sinh(2 * x) - 4 * x) / (2 * k * np.cosh(2 * x) + 1 + k**2 + 4 * x**2)


@pytest.mark.parametrize("layer", LAYERS, ids=str)
def test_transfer_and_deficit_are_the_printed_formula(layer):
    x = np.geomspace(0.01, 15, 400)
    expected = printed_transfer(layer, x)
    np.testing.assert_allclose(
        layer.transfer(x), expected.astype(float), rtol=2e-13
    )  # the formula itself has lost 4 of 19 digits
    np.testing.assert_allclose(layer.deficit(x), (1 - expected).astype(float), rtol=2e-13, atol=2e-18)


@pytest.mark.parametrize(("base", "nu"), [("slipping", 0.5), ("bonded", 0.3)])
def test_a_missing_term_is_seen(base, nu):
    """Without the 2 x or 4 x^2 of the denominator."""
    x, k = np.geomspace(0.01, 15, 400), 3 - 4 * nu
    wrong = {
        "slipping": (np.cosh(2 * x) - 1) / np.sinh(2 * x),
        "bonded": (2 * k * np.sinh(2 * x) - 4 * x) / (2 * k * np.cosh(2 * x) + 1 + k**2),
    }
    assert np.abs(Layer(1.0, nu, base).transfer(x) - wrong[base]).max() > 0.01


def solved_transfer(layer, x):
    """M of a layer of thickness x and G = 1 under the pressure cos(r), from its stress function f(z) cos(r).

    f = (A + B z) exp(z) + (C + D z) exp(-z); pressure f is 1 on top, shear f' 0; below, the height and the shear or slip.
    """
    nu = layer.poisson_ratio

    def derivatives(z):
        grown, decayed = np.exp(z - x), np.exp(-z)
        rows = [(grown, (z + n) * grown, (-1) ** n * decayed, (-1) ** n * (z - n) * decayed) for n in range(4)]
        return np.array(rows)

    def height(f):
        return ((1 - nu) * f[3] - (2 - nu) * f[1]) / 2

    top, base = derivatives(x), derivatives(0.0)
    slip = (1 - nu) * base[2] + nu * base[0]
    rows = np.array([top[0], top[1], height(base), slip if layer.base == "bonded" else base[1]])
    constants = np.linalg.solve(rows, [1.0, 0, 0, 0])
    return -(height(top) @ constants) / (1 - nu)


@pytest.mark.parametrize("layer", LAYERS, ids=str)
def test_transfer_solves_the_plane_layer(layer):
    x = np.array([0.1, 0.5, 1.0, 3.0, 8.0])
    expected = [float(solved_transfer(layer, wave)) for wave in x]
    np.testing.assert_allclose(layer.transfer(x), expected, rtol=1e-9)  # condition of the four equations at x = 0.1
    other = Layer(1.0, layer.poisson_ratio, "slipping" if layer.base == "bonded" else "bonded")
    assert not np.isclose(other.transfer(x), expected, rtol=1e-9).any(), "the other base is distinguished"


@pytest.mark.parametrize("layer", LAYERS, ids=str)
def test_ends_are_finite_and_exact(layer):
    np.testing.assert_array_equal(layer.transfer([0.0, 1e4, 1e300, np.inf]), [0, 1, 1, 1])
    np.testing.assert_allclose(layer.deficit([0.0, 1e4, 1e300, np.inf]), [1, 0, 0, 0], rtol=1e-15, atol=1e-300)


@pytest.mark.parametrize("layer", LAYERS, ids=str)
def test_long_waves_squeeze_the_layer_uniformly(layer):
    """u G / (p h (1 - nu)) = M / x: confined between its walls (bonded), or free to slide, in plane strain (slipping)."""
    x, nu = 1e-7, layer.poisson_ratio
    expected = 0.5 if layer.base == "slipping" else (1 - 2 * nu) / (2 * (1 - nu) ** 2)
    assert float(layer.transfer(x)) / x == pytest.approx(expected, rel=1e-6, abs=1e-12)


def test_long_waves_on_an_incompressible_bonded_layer_flow():
    x = 1e-5
    assert float(Layer(1.0).transfer(x)) == pytest.approx(2 / 3 * x**3, rel=1e-9)


def test_a_slipping_layer_does_not_feel_poissons_ratio():
    x = np.linspace(0, 30, 100)
    np.testing.assert_array_equal(Layer(1.0, 0.5, "slipping").transfer(x), Layer(1.0, -0.5, "slipping").transfer(x))
    assert np.abs(Layer(1.0, 0.5).transfer(x) - Layer(1.0, 0.3).transfer(x)).max() > 0.1


def test_the_deficit_decays_like_the_square_of_exp_minus_x():
    x = np.array([20.0, 40.0, 200.0])
    scaled = Layer(1.0, 0.3).deficit(x) * np.exp(2 * x)
    k = 3 - 4 * 0.3
    np.testing.assert_allclose(scaled, (1 + k**2 + 4 * x + 4 * x**2) / k, rtol=1e-12)


@pytest.mark.parametrize("thickness", [0.0, -1.0, np.nan])
def test_thickness_is_positive(thickness):
    with pytest.raises(InvalidQuantity, match=r"thickness .* allowed: \(0, inf\] m"):
        Layer(thickness)


@pytest.mark.parametrize("ratio", [-1.0, 0.5001, np.nan])
def test_poissons_ratio_has_its_range(ratio):
    with pytest.raises(InvalidQuantity, match=r"Poisson's ratio .* allowed: \(-1, 0.5\]"):
        Layer(1.0, ratio)


def test_other_bases_and_waves_are_refused():
    with pytest.raises(UnknownName, match=r"base of a layer 'bondd' .did you mean 'bonded'"):
        Layer(1.0, base="bondd")
    for function in (Layer(1.0).transfer, Layer(1.0).deficit):
        with pytest.raises(InvalidQuantity, match="wave number"):
            function([1.0, -0.1])
