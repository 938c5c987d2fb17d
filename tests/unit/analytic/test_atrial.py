"""Readings of the atrial tissue of Table 4.1."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.atrial import COMPLIANCES, E0, TIMES, E, atrial_shear_compliance, table_4_1
from tactsim.errors import UnknownName


def test_the_table_as_printed_is_the_model_of_its_formula():
    """Thesis, eq. 4.3.8, at its eight frequencies, 1 Hz to 36 Hz."""
    tau = [2.455236432, 2.405097351, 0.021752025, 2.440387389, 2.416770843, 2.392975402, 0.021876111, 2.438807782]
    for frequency in range(1, 37, 5):
        omega = 2 * np.pi * frequency
        elastic = 1 / E0 + sum(1 / (e * (omega**2 * t**2 + 1)) for e, t in zip(E, tau, strict=True))
        viscous = sum(omega * t / (e * (omega**2 * t**2 + 1)) for e, t in zip(E, tau, strict=True))
        assert table_4_1().complex_compliance(omega) * 1e6 == pytest.approx(elastic - 1j * viscous, rel=1e-14)


def test_six_printed_times_are_nearly_equal():
    slow = table_4_1().times[2:]
    assert slow.max() / slow.min() - 1 == pytest.approx(0.026, abs=5e-4)


def test_the_readings_of_the_compliance_differ_by_a_half():
    t = np.logspace(-3, 4, 8)
    for times in TIMES:
        tensile = atrial_shear_compliance(times).creep(t)
        np.testing.assert_allclose(tensile, 1.5 * atrial_shear_compliance(times, "half_shear").creep(t), rtol=1e-14)
        np.testing.assert_allclose(tensile, 3 * table_4_1(times).creep(t), rtol=1e-14)
    assert tuple(COMPLIANCES) == ("tensile", "half_shear")


def test_other_readings_are_unknown():
    with pytest.raises(UnknownName, match=r"unknown reading of the times 'viscosity' \(did you mean 'viscosities'\?\)"):
        table_4_1("viscosity")
    with pytest.raises(UnknownName, match=r"unknown reading of the compliance 'shear' .*; known: half_shear, tensile"):
        atrial_shear_compliance(compliance="shear")
