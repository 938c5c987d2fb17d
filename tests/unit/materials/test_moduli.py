"""Small-strain moduli: what is refused, with quantity and value, and what the constants give."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from tactsim.errors import CaseError
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.moduli import LARGEST_BULK_TO_SHEAR_RATIO, check_moduli, youngs_modulus
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.materials.polynomial import Polynomial


@pytest.mark.parametrize(("c10", "c01", "value"), [(-1.0, 0.5, "-1 Pa"), (1.0, -1.0, "0 Pa")])
def test_a_stiffness_that_is_not_positive_is_refused(c10, c01, value):
    with pytest.raises(CaseError, match=rf"small-strain shear modulus = {value}; it must be > 0 Pa"):
        MooneyRivlin2(c10=c10, c01=c01)


def test_the_one_constant_is_named():
    with pytest.raises(CaseError, match=r"c10: '-1 kPa' is out of range; must be greater than 0 Pa"):
        NeoHookean(c10="-1 kPa")


def test_a_negative_constant_is_allowed_while_the_stiffness_is_positive():
    assert MooneyRivlin2(c10=-1.0, c01=1.5).shear_modulus == 1.0


def test_the_shear_modulus_of_higher_terms_alone_is_zero_and_refused():
    with pytest.raises(CaseError, match=r"shear modulus = 0 Pa"):
        Polynomial(coefficients={"c20": 1e3})


def test_a_bulk_modulus_out_of_reach_of_round_off_is_refused():
    largest = LARGEST_BULK_TO_SHEAR_RATIO
    assert NeoHookean(c10=0.5, bulk_modulus=largest).bulk_modulus == largest
    with pytest.raises(CaseError, match=r"bulk modulus = 1\.1e\+07 Pa is 1\.1e\+07 times the shear modulus; .*1e\+07.*null"):
        NeoHookean(c10=0.5, bulk_modulus=1.1 * largest)


@pytest.mark.parametrize("bulk", [0.0, -1.0, float("nan"), float("inf")])
def test_a_bulk_modulus_is_positive_and_finite(bulk):
    with pytest.raises(CaseError, match="bulk_modulus"):
        NeoHookean(c10=1.0, bulk_modulus=bulk)


@pytest.mark.parametrize("shear", [0.0, -2.0, float("nan")])
def test_the_check_itself(shear):
    with pytest.raises(ValueError, match="shear modulus"):
        check_moduli(shear, None)


def test_youngs_modulus():
    assert youngs_modulus(2.0, None) == 6.0
    assert youngs_modulus(2.0, 4.0) == pytest.approx(72 / 14, rel=1e-15)
    assert youngs_modulus(1.0, 1e12) == pytest.approx(3.0, rel=1e-11)
    assert NeoHookean(c10=1.0, bulk_modulus=4.0).youngs_modulus == pytest.approx(72 / 14, rel=1e-15)


@pytest.mark.parametrize("poisson_ratio", [-0.5, 0.0, 0.3, 0.49])
def test_linear_elastic_moduli(poisson_ratio):
    material = LinearElastic(youngs_modulus=1e4, poisson_ratio=poisson_ratio)
    assert material.shear_modulus == pytest.approx(1e4 / (2 * (1 + poisson_ratio)), rel=1e-15)
    assert material.bulk_modulus == pytest.approx(1e4 / (3 * (1 - 2 * poisson_ratio)), rel=1e-15)
    assert youngs_modulus(material.shear_modulus, material.bulk_modulus) == pytest.approx(1e4, rel=1e-13)


def test_linear_elastic_bar_in_tension():
    """A stress of E times the strain, and the lateral strain of Poisson's ratio."""
    E, nu, strain = 1e4, 0.3, 1e-3
    material = LinearElastic(youngs_modulus=E, poisson_ratio=nu)
    F = np.diag([1 + strain, 1 - nu * strain, 1 - nu * strain])[:, :, None]
    stress = material.first_piola_kirchhoff(F, material.bulk_modulus * material.volume_change(F))
    np.testing.assert_allclose(stress[:, :, 0], np.diag([E * strain, 0, 0]), atol=1e-12 * E)


def test_linear_elastic_limits():
    assert LinearElastic(youngs_modulus=1.0, poisson_ratio=0.5).bulk_modulus is None
    for wrong, quantity in (
        ({"poisson_ratio": 0.51}, "poisson_ratio"),
        ({"poisson_ratio": -1}, "poisson_ratio"),
        ({"youngs_modulus": 0}, "youngs_modulus"),
    ):
        with pytest.raises(ValidationError, match=quantity):
            LinearElastic.model_validate({"youngs_modulus": 1.0, "poisson_ratio": 0.3} | wrong)
    with pytest.raises(CaseError, match="times the shear modulus"):
        LinearElastic(youngs_modulus=1.0, poisson_ratio=0.5 - 1e-9)


def test_the_modulus_is_the_slope_of_the_shear_stress():
    material = Polynomial.example()
    assert isinstance(material, Hyperelastic)
    F = np.eye(3)
    F[0, 1] = 1e-6
    stress = material.first_piola_kirchhoff(F[:, :, None], np.zeros(1))
    assert stress[0, 1, 0] / 1e-6 == pytest.approx(material.shear_modulus, rel=1e-9)  # the next term is the strain squared
