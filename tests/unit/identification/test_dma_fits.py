"""Objective, spectrum, both fits, bands and determination: derivatives, bounds, seeds and refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.errors import InvalidQuantity, UnknownName
from tactsim.identification.dma_bands import genetic_band, least_squares_band
from tactsim.identification.dma_data import DmaData, parts_of, synthetic_dma
from tactsim.identification.dma_determined import determination
from tactsim.identification.dma_genetic import GeneticSettings, fit_genetic, log_bounds
from tactsim.identification.dma_least_squares import fit_least_squares
from tactsim.identification.dma_objective import (
    FORMS,
    KelvinConstants,
    compliance_parts,
    objective,
    objective_slopes,
    part_sensitivities,
)
from tactsim.identification.dma_spectrum import estimated_noise

DATA = synthetic_dma(table_4_1(), noise=0.02, seed=1)
FREQUENCIES = np.geomspace(1, 36, 30)
QUICK = GeneticSettings(population=40, generations=40, seed=1)


def constants():
    generator = np.random.default_rng(0)
    return KelvinConstants(5e6, generator.uniform(1e3, 1e5, 8), np.geomspace(1e-3, 10, 8))


def test_compliance_is_that_of_the_model_and_the_vector_turns_back():
    given = constants()
    expected = parts_of(given.model().complex_compliance(2 * np.pi * FREQUENCIES))
    np.testing.assert_allclose(compliance_parts(given.logarithms, FREQUENCIES), expected, rtol=1e-12)  # round-off
    again = KelvinConstants.from_logarithms(given.logarithms)
    np.testing.assert_allclose(again.retardation_times, given.retardation_times, rtol=1e-13)
    assert given.names[0] == "e_0"
    assert given.names[-1] == "tau_8"


def test_sensitivities_are_derivatives():
    p, step = constants().logarithms, 1e-6
    computed = part_sensitivities(p, FREQUENCIES)
    for k in range(p.size):
        change = step * (np.arange(p.size) == k)
        slope = (compliance_parts(p + change, FREQUENCIES) - compliance_parts(p - change, FREQUENCIES)) / (2 * step)
        np.testing.assert_allclose(computed[..., k], slope, atol=1e-8 * np.abs(computed).max())  # central differences


def test_objective_over_a_population_and_in_both_forms():
    population = constants().logarithms + np.random.default_rng(1).normal(size=(5, 17))
    errors = compliance_parts(population[3], DATA.frequencies) - DATA.parts
    assert objective(population, DATA).shape == (5,)
    assert objective(population, DATA)[3] == pytest.approx((errors**2).sum(), rel=1e-12)
    printed = sum(np.linalg.norm(part) for part in errors)
    assert objective(population, DATA, "as_printed")[3] == pytest.approx(printed, rel=1e-12)
    with pytest.raises(UnknownName):
        objective(population, DATA, "cubed")


@pytest.mark.parametrize("form", FORMS)
def test_slopes_of_the_objective_are_its_central_differences(form: str) -> None:
    logarithms, step = constants().logarithms, 1e-5
    each = step * np.eye(logarithms.size)
    differences = (objective(logarithms + each, DATA, form) - objective(logarithms - each, DATA, form)) / (2 * step)
    np.testing.assert_allclose(objective_slopes(logarithms, DATA, form), differences, rtol=0, atol=1e-7 * abs(differences).max())


def test_genetic_search_is_repeatable_within_its_bounds_and_falls():
    fit = fit_genetic(DATA, settings=QUICK)
    lower, upper = log_bounds(DATA, 8)
    assert ((fit.constants.logarithms >= lower - 1e-12) & (fit.constants.logarithms <= upper + 1e-12)).all()
    assert len(fit.history) == QUICK.generations
    assert (np.diff(fit.history) <= 0).all()
    assert fit.history[-1] == pytest.approx(fit.objective, rel=1e-12)
    assert fit_genetic(DATA, settings=QUICK).objective == fit.objective
    assert fit_genetic(DATA, settings=GeneticSettings(40, 40, 2)).objective != fit.objective
    printed = fit_genetic(DATA, form="as_printed", settings=QUICK)
    assert printed.history[-1] == pytest.approx(objective(printed.constants.logarithms, DATA, "as_printed"), rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"units": 0}, InvalidQuantity),
        ({"settings": GeneticSettings(population=2)}, InvalidQuantity),
        ({"settings": GeneticSettings(generations=1)}, InvalidQuantity),
        ({"form": "cubed"}, UnknownName),
    ],
)
def test_bad_settings_of_the_search_are_refused(arguments, error):
    with pytest.raises(error):
        fit_genetic(DATA, **arguments)


def test_bad_settings_of_least_squares_are_refused():
    with pytest.raises(InvalidQuantity, match="units is 0"):
        fit_least_squares(DATA, 0)
    with pytest.raises(UnknownName):
        fit_least_squares(DATA, weighting="none")


@pytest.mark.parametrize("units", [1, 2, 3, 8, 12])
def test_any_number_of_units(units):
    fit = fit_least_squares(DATA, units)
    assert fit.constants.moduli.shape == fit.constants.retardation_times.shape == (units,)
    assert (np.diff(fit.constants.retardation_times) >= 0).all()
    assert np.isfinite(fit.constants.logarithms).all()


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("seed", [2, 3, 4, 7])
def test_as_many_units_as_made_the_data_leave_no_more_than_the_noise(seed: int, known: bool) -> None:
    """The spectrum of noisy data has faint units far out beside the two of the tissue; which of them are kept decides."""
    true = GeneralizedKelvin(1e-5, [2e-5, 3e-5], [0.02, 0.1])
    made = synthetic_dma(true, DATA.frequencies, noise=0.02, seed=seed)
    fit = fit_least_squares(made if known else replace(made, relative_noise=None), 2)
    spread = 0.02 * made.parts
    expected, found = (
        float((((parts - made.parts) / spread) ** 2).sum())
        for parts in (parts_of(true.complex_compliance(2 * np.pi * made.frequencies)), fit.parts(made.frequencies))
    )
    assert found < expected  # a least of the same form; 100 to 300 was left of 6 to 29


def test_noise_is_estimated_from_the_residuals():
    estimates = []
    for seed in range(60):
        data = synthetic_dma(table_4_1(), noise=0.02, seed=seed)
        estimates.append(estimated_noise(DmaData(data.frequencies, data.compliance))[0, 0])
    assert np.sqrt(np.mean(np.square(estimates))) == pytest.approx(
        0.02, rel=0.12
    )  # 60 x 11 degrees of freedom: four standard errors


@pytest.mark.parametrize("banded", [least_squares_band, genetic_band])
def test_bands(banded):
    fit = fit_least_squares(DATA) if banded is least_squares_band else fit_genetic(DATA, settings=QUICK)
    band = banded(fit, FREQUENCIES, replicates=100, seed=2)
    pointwise = banded(fit, FREQUENCIES, replicates=100, seed=2, simultaneous=False)
    assert (band.lower < band.centre).all()
    assert (band.centre < band.upper).all()
    assert np.median(pointwise.relative_width) < np.median(band.relative_width)
    np.testing.assert_array_equal(band.upper, banded(fit, FREQUENCIES, replicates=100, seed=2).upper)
    assert band.contains(band.centre)
    assert not band.contains(band.centre * 2)
    with pytest.raises(InvalidQuantity, match="confidence"):
        banded(fit, FREQUENCIES, confidence=1.0, replicates=100)
    with pytest.raises(InvalidQuantity, match="replicates"):
        banded(fit, FREQUENCIES, replicates=10)


def test_what_the_data_do_not_determine_is_reported():
    determined = determination(fit_least_squares(DATA))
    assert determined.relative_errors.shape == (17,)
    assert (determined.relative_errors <= np.log(10) * (1 + 1e-12)).all()
    assert 3 <= determined.determined_combinations <= 6
    assert "17 constants; they determine none of them alone: trust the curves" in determined.statement()
    steady = replace(determined, relative_errors=np.r_[1e-3, determined.relative_errors[1:]])
    assert "they determine e_0 alone, and do not determine e_1, e_2," in steady.statement()


def test_data_that_determine_every_constant_are_not_warned_of():
    """Two units a decade apart within the frequencies, at a noise of 1e-4."""
    model = KelvinConstants(6.5e3, np.array([16e3, 8e3]), np.array([0.02, 0.3])).model()
    data = synthetic_dma(model, frequencies=np.geomspace(0.2, 30, 12), noise=1e-4, seed=1)
    determined = determination(fit_least_squares(data, units=2))
    assert determined.determined.all()
    assert determined.statement() == "24 numbers with a relative noise of 0.0001 determine each of the 5 constants"


def test_standard_errors_follow_from_the_sensitivities():
    fit = fit_least_squares(DATA)
    determined = determination(fit)
    slopes = part_sensitivities(fit.constants.logarithms, DATA.frequencies) / (0.02 * DATA.parts)[..., None]
    S = slopes.reshape(16, 17)
    expected = np.sqrt(np.diag(np.linalg.inv(S.T @ S + np.eye(17) / np.log(10) ** 2)))
    np.testing.assert_allclose(determined.relative_errors, expected, rtol=1e-8)  # condition of 3e5 of the sum
