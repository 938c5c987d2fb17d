"""The annulus on viscoelastic tissue: the printed displacement of thesis 4.6.4, and a quadrature of the hereditary integral."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.analytic.force_factor import force_factor
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.histories import ramp
from tactsim.analytic.interconversion import maxwell_of
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus

SOLID = GeneralizedKelvin(2e-4, [1e-4, 3e-4], [0.1, 0.6])
RADIUS, RATIO, END = 3e-3, 0.6, 1.0
PRINTED = {
    4.29: 10.64,
    2.77: 16.58,
    0.0031: 133.35,
    0.0028: 146.15,
    0.0021: 196.39,
    0.0016: 253.67,
    0.00098: 418.36,
    0.00077: 532.91,
}
"""Rate in 1/s -> amplitude in 1/MPa, thesis eq. 4.6.4."""


def printed_displacement(force, ratio, t):
    """Displacement in m by eqs. 4.6.4 and 4.6.5 with their printed digits."""
    bracket = 1708.08 - sum(amplitude * np.exp(-rate * t) for rate, amplitude in PRINTED.items())
    return force * 1e-6 * bracket / (4 * RADIUS * force_factor(ratio, "thesis_4_2_21"))


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.9])
def test_the_printed_displacement(ratio, verification_record):
    """Rates cut in their second or third digit and amplitudes cut at 0.01 leave 0.3 % of the displacement up to 2 s.

    Mutants: the last column of the table as retardation times, and the table as 1 / E.
    """
    t = np.linspace(0.05, 2, 40)

    def check(times, compliance):
        annulus = ViscoelasticAnnulus(RADIUS, ratio, atrial_shear_compliance(times, compliance), "thesis_4_2_21")
        np.testing.assert_allclose(annulus.creep_displacement(1.5, t), printed_displacement(1.5, ratio, t), rtol=0.003)

    check("viscosities", "half_shear")
    annulus = ViscoelasticAnnulus(RADIUS, ratio, atrial_shear_compliance("viscosities", "half_shear"), "thesis_4_2_21")
    found, printed = annulus.creep_displacement(1.5, t), printed_displacement(1.5, ratio, t)
    known = {"reference": "thesis, eq. 4.6.4, with its cut digits", "kind": "published", "mesh": "closed form"}
    verification_record("annulus on the atrium, creep", found, printed, tolerance=0.003, **known)
    assert_kills(check, times=("retardation_times", "half_shear"), compliance=("viscosities", "tensile"))


def hereditary(annulus, steps, creep, factor):
    """Displacement in m at END by the midpoint rule for the hereditary integral over the force under a ramp of 1 mm/s."""
    t = np.linspace(0, END, steps + 1)
    forces = annulus.force(ramp(1e-3, END), t)
    middles = END - (t[1:] + t[:-1]) / 2
    return (creep(middles) * np.diff(forces)).sum() / (8 * RADIUS * factor)


def test_the_hereditary_integral_over_the_force_is_the_displacement(verification_record):
    """The midpoint rule converges with order 2 to the displacement that was given.

    Mutants: the inverse of the relaxation modulus in place of the creep compliance, and the force factor of a solid punch.
    """
    annulus = ViscoelasticAnnulus(RADIUS, RATIO, SOLID)
    steps = np.array([40, 80, 160, 320])

    def check(creep, factor):
        errors = np.array([abs(hereditary(annulus, n, creep, factor) - 1e-3 * END) for n in steps])
        assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2, abs=0.1)
        assert errors[-1] < 1e-5 * 1e-3

    check(SOLID.creep, force_factor(RATIO))
    errors = [abs(hereditary(annulus, n, SOLID.creep, force_factor(RATIO)) - 1e-3 * END) for n in steps]
    order = float(-np.polyfit(np.log(steps), np.log(errors), 1)[0])
    known = {"reference": "midpoint rule for the hereditary integral", "kind": "convergence", "mesh": "40 to 320 steps"}
    verification_record("viscoelastic annulus, displacement from force", order=order, theory=2.0, tolerance=0.1, **known)
    inverse = lambda t: 1 / maxwell_of(SOLID).relaxation(t)  # noqa: E731
    assert_kills(check, inverse=(inverse, force_factor(RATIO)), solid=(SOLID.creep, 1.0))
