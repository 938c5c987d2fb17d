"""The functions behind the tables of chapter 4."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.atrial import E0, TAU, E
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.errors import InputError, UnknownName
from tactsim.validation.quantities.annulus import annulus_creep
from tactsim.validation.quantities.atrium import (
    FREQUENCIES,
    atrial_oscillation,
    identifiable_constants,
    numbered_unit,
    numbered_units,
    sensitivities,
)
from tactsim.validation.quantities.dma import objective_forms
from tactsim.validation.quantities.harmonic_load import dynamic_coefficient, dynamic_exponent, truncated, units_by_speed


def test_units_have_the_numbers_of_the_table() -> None:
    for times, column in (("retardation_times", np.array(TAU)), ("viscosities", np.array(TAU) / np.array(E))):
        compliances, retardation = numbered_units(times)
        np.testing.assert_allclose(compliances * 1e6 * np.array(E), 1, rtol=1e-14)  # round-off of a quotient
        np.testing.assert_allclose(retardation, column, rtol=1e-14)
    assert numbered_unit("retardation_times", 3)[1] == TAU[2]
    with pytest.raises(InputError, match="no unit 9"):
        numbered_unit("viscosities", 9)


def test_fast_and_slow_units_make_the_whole() -> None:
    whole, fast, slow = (units_by_speed(chosen) for chosen in ("all", "fast", "slow"))
    assert (fast.times.size, slow.times.size) == (2, 6)
    together = fast.creep(3.0) + slow.creep(3.0) - 1e-6 / E0
    assert together == pytest.approx(float(whole.creep(3.0)), rel=1e-13)  # round-off
    with pytest.raises(UnknownName, match="fast"):
        units_by_speed("fsat")


def test_digits_are_cut_toward_zero() -> None:
    np.testing.assert_allclose(truncated(np.array([-2.869, 0.0166, 0.06]), 0.01), [-2.86, 0.01, 0.06], atol=1e-15)


def test_the_two_odd_coefficients_come_out_of_cut_parts() -> None:
    """Eq. 4.7.2: 0.06 is six times 0.01, and -5.46 is -341.61 + 336.15."""
    for name, exact, cut in (("slow", 0.0985, 0.06), ("static_rest", -5.449, -5.46)):
        computed = [1e6 * dynamic_coefficient(name, truncated_parts=t) for t in (False, True)]
        assert computed == pytest.approx([exact, cut], abs=5e-4)  # given to four digits


def test_the_exponents_as_written_are_sums_of_printed_numbers() -> None:
    computed = [dynamic_exponent(name, as_written=True) for name in ("both", "first", "second")]
    assert computed == pytest.approx([7.07, 7.07 - 4.29, 7.07 - 2.77], rel=1e-12)  # round-off


def test_touching_is_when_the_rise_is_the_recess() -> None:
    force = annulus_creep(quantity="force_to_touch")
    assert annulus_creep(quantity="rise", force=force) == pytest.approx(0.7e-3, rel=1e-12)  # round-off
    moment = annulus_creep(quantity="time_to_touch")
    assert annulus_creep(quantity="rise", time=moment) == pytest.approx(0.7e-3, rel=1e-12)


def test_moduli_and_compliances_are_reciprocal() -> None:
    quantities = ("elastic_modulus", "viscous_modulus", "elastic_compliance", "viscous_compliance")
    e, v, d, w = (atrial_oscillation(name, frequency=6.0) for name in quantities)  # type: ignore[arg-type]
    assert (e + 1j * v) * (d - 1j * w) == pytest.approx(1, rel=1e-13)  # round-off


def test_the_sensitivities_are_the_differences_of_the_compliance() -> None:
    def logarithms(constants: np.ndarray) -> np.ndarray:
        moduli, times = 1e6 * constants[1:9], constants[9:]
        total = GeneralizedKelvin(1 / (1e6 * constants[0]), 1 / moduli, times).complex_compliance(2 * np.pi * FREQUENCIES)
        return np.log(np.concatenate([total.real, -total.imag]))

    constants, factor = np.array([E0, *E, *TAU]), np.exp(1e-5)
    changes = [np.where(np.arange(17) == k, factor, 1.0) for k in range(17)]
    expected = np.array([(logarithms(constants * c) - logarithms(constants / c)) / 2e-5 for c in changes]).T
    np.testing.assert_allclose(sensitivities(), expected, atol=1e-8)  # the square of the step, and round-off over the step
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(sensitivities(), expected + 3e-8, atol=1e-8)
    assert [identifiable_constants(error) for error in (0.01, 1e-9)] == [4, 8]


def test_the_forms_of_the_objective_are_held_against_the_worst_of_several_data() -> None:
    one, other = (objective_forms(noise=0.02, seeds=(seed,)) for seed in (1, 3))
    assert 0 < one < other == objective_forms(noise=0.02, seeds=(1, 3))
