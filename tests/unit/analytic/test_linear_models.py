"""Generalized Kelvin and Maxwell models: curves, limits, and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.errors import InvalidQuantity

SOLID = GeneralizedKelvin(1.0, [2.0, 3.0], [10.0, 0.1])
FLUID = GeneralizedKelvin(1.0, [2.0, 3.0], [10.0, 0.1], fluidity=0.5)
PRONY = GeneralizedMaxwell(1.0, [2.0, 3.0], [10.0, 0.1])


def test_the_creep_compliance_is_that_of_its_formula_and_zero_before_the_step():
    t = np.array([[-1.0, 0.0, 0.2], [1.0, 30.0, 1e3]])
    expected = np.array([[creep(x) if x >= 0 else 0.0 for x in row] for row in t])
    np.testing.assert_allclose(FLUID.creep(t), expected, rtol=1e-15)
    assert float(SOLID.creep(math.inf)) == SOLID.equilibrium_compliance == 6.0
    assert FLUID.equilibrium_compliance == math.inf == float(FLUID.creep(math.inf))


def creep(t: float) -> float:
    return 1 + 2 * (1 - math.exp(-t / 10)) + 3 * (1 - math.exp(-t / 0.1)) + 0.5 * t


def test_the_relaxation_modulus_is_that_of_its_formula_and_zero_before_the_step():
    t = np.array([-1.0, 0.0, 0.2, 30.0])
    expected = [0.0, *(1 + 2 * math.exp(-x / 10) + 3 * math.exp(-x / 0.1) for x in t[1:])]
    np.testing.assert_allclose(PRONY.relaxation(t), expected, rtol=1e-15)
    assert PRONY.instantaneous_modulus == 6.0
    assert float(PRONY.relaxation(math.inf)) == 1.0


def test_the_complex_curves_have_the_parts_of_the_thesis():
    """Thesis, eq. 4.3.8, with D* = D_e - i D_v."""
    omega = np.logspace(-3, 3, 7)
    elastic = 1 + 2 / (1 + (10 * omega) ** 2) + 3 / (1 + (0.1 * omega) ** 2)
    viscous = 20 * omega / (1 + (10 * omega) ** 2) + 0.3 * omega / (1 + (0.1 * omega) ** 2)
    np.testing.assert_allclose(SOLID.complex_compliance(omega), elastic - 1j * viscous, rtol=1e-14)
    np.testing.assert_allclose(FLUID.complex_compliance(omega), elastic - 1j * (viscous + 0.5 / omega), rtol=1e-14)
    assert SOLID.complex_compliance(0.0) == 6.0
    assert PRONY.complex_modulus(0.0) == 1.0
    np.testing.assert_allclose(PRONY.complex_modulus(1e12), 6.0, rtol=1e-10)
    assert (PRONY.complex_modulus(omega).imag > 0).all()


def test_a_spring_alone_is_a_model():
    assert GeneralizedKelvin(2.0, [], []).creep([0.0, 5.0]).tolist() == [2.0, 2.0]
    assert GeneralizedMaxwell(2.0, [], []).relaxation([0.0, 5.0]).tolist() == [2.0, 2.0]


def test_spectra_are_sorted_merged_and_read_only():
    model = GeneralizedKelvin(1, [1.0, 2.0, 4.0], [3.0, 1.0, 3.0])
    assert model.times.tolist() == [1.0, 3.0]
    assert model.compliances.tolist() == [2.0, 5.0]
    for array in (model.times, model.compliances, PRONY.times, PRONY.moduli):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_the_given_arrays_stay_as_they_are():
    times = np.array([3.0, 1.0])
    GeneralizedMaxwell(1.0, [1.0, 1.0], times)
    times[0] = 2.0
    assert times.tolist() == [2.0, 1.0]


def test_scaling_scales_all_curves():
    t = np.logspace(-2, 3, 6)
    np.testing.assert_allclose(FLUID.scaled(3.0).creep(t), 3 * FLUID.creep(t), rtol=1e-15)
    np.testing.assert_allclose(PRONY.scaled(3.0).relaxation(t), 3 * PRONY.relaxation(t), rtol=1e-15)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: GeneralizedKelvin(0.0, [], []), "glassy_compliance is 0.0; allowed: finite and > 0"),
        (lambda: GeneralizedKelvin("1 Pa", [], []), "glassy_compliance is '1 Pa'; allowed: real numbers"),
        (lambda: GeneralizedKelvin(1.0, [1.0, -2.0], [1.0, 2.0]), r"compliances\[1\] is -2; allowed: finite and > 0"),
        (lambda: GeneralizedKelvin(1.0, [1.0], [math.inf]), r"times\[0\] is inf; allowed: finite and > 0"),
        (lambda: GeneralizedKelvin(1.0, [math.nan], [1.0]), r"compliances\[0\] is nan"),
        (lambda: GeneralizedKelvin(1.0, [1.0, 2.0], [1.0]), r"compliances and times have the shapes \(2,\) and \(1,\)"),
        (lambda: GeneralizedKelvin(1.0, [], [], fluidity=-1.0), "fluidity is -1.0; allowed: finite and >= 0"),
        (lambda: GeneralizedMaxwell(-1.0, [1.0], [1.0]), "equilibrium_modulus is -1.0; allowed: finite and >= 0"),
        (lambda: GeneralizedMaxwell(0.0, [], []), "equilibrium_modulus is 0.0; allowed: finite and > 0"),
        (lambda: GeneralizedMaxwell(1.0, [0.0], [1.0]), r"moduli\[0\] is 0; allowed"),
        (lambda: SOLID.scaled(0.0), "factor is 0.0"),
        (lambda: PRONY.scaled(math.nan), "factor is nan"),
        (lambda: SOLID.creep(math.nan), "t is nan; allowed: times in s"),
        (lambda: PRONY.relaxation([0.0, math.nan]), "t is .*allowed: times in s"),
        (lambda: SOLID.complex_compliance(-1.0), "omega is -1.0 rad/s; allowed: finite and >= 0"),
        (lambda: FLUID.complex_compliance(0.0), "omega is 0.0 rad/s; allowed: finite and > 0"),
        (lambda: PRONY.complex_modulus(math.inf), "omega is inf rad/s"),
    ],
)
def test_numbers_out_of_range_are_named(build, message):
    with pytest.raises(InvalidQuantity, match=message):
        build()
