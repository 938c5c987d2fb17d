"""Masses to fractions: the thesis's numbers, uncertainties against many draws, a composite given by masses, what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import text_of
from mutants import assert_kills

from tactsim.case import load_case
from tactsim.errors import CaseError
from tactsim.experiments.film.figures.thermogravimetry import ThermogravimetryFigures
from tactsim.experiments.film.thermogravimetry import ThermogravimetricAnalysis
from tactsim.plotting import figures_for
from tactsim.sensors.films.composite_library import named_composite
from tactsim.sensors.films.film import Film
from tactsim.sensors.films.thermogravimetry import Thermogravimetry
from tactsim.shipped import CASES
from tactsim.validation.quantities.film import filler_fraction_deviation

MILLIGRAM = 1e-6
LINGSTAT = {"sample_mass": 21.158 * MILLIGRAM, "filler_mass": 4.2083 * MILLIGRAM}


def test_the_fractions_of_the_thesis():
    analysis = Thermogravimetry(**LINGSTAT)
    assert analysis.mass_fraction == pytest.approx(0.1989, abs=5e-5)  # printed 19.89 %
    assert analysis.matrix_mass == pytest.approx(
        16.9496 * MILLIGRAM, abs=1.5e-4 * MILLIGRAM
    )  # printed masses add up to one digit
    assert analysis.volume_fraction == pytest.approx(0.28747, abs=1e-5)  # errata; the thesis prints 0.2873 from cut volumes
    assert Thermogravimetry(**LINGSTAT, filler_density=1800.0).volume_fraction == pytest.approx(0.112, abs=5e-4)  # errata E27


def test_uncertainties_are_those_of_many_draws():
    numbers = {
        **LINGSTAT,
        "mass_resolution": 0.3 * MILLIGRAM,
        "filler_density_deviation": 15.0,
        "matrix_density_deviation": 12.0,
    }
    generator, count = np.random.default_rng(1), 100_000
    read = generator.uniform(-0.5, 0.5, (2, count)) * numbers["mass_resolution"]
    sample, filler = LINGSTAT["sample_mass"] + read[0], LINGSTAT["filler_mass"] + read[1]
    densities = np.array([[560.0], [910.0]]) + np.array([[15.0], [12.0]]) * generator.standard_normal((2, count))
    volumes = filler / densities[0], (sample - filler) / densities[1]
    drawn = volumes[0] / (volumes[0] + volumes[1])

    def check(analysis):
        assert analysis.volume_fraction_deviation == pytest.approx(drawn.std(), rel=0.01)  # draws 0.2 %, second order
        assert analysis.mass_fraction_deviation == pytest.approx((filler / sample).std(), rel=0.01)

    check(Thermogravimetry(**numbers))
    assert_kills(
        check,
        resolution=(Thermogravimetry(**numbers | {"mass_resolution": 0.35 * MILLIGRAM}),),
        density=(Thermogravimetry(**numbers | {"filler_density_deviation": 0.0}),),
        matrix=(Thermogravimetry(**numbers | {"matrix_density_deviation": 0.0}),),
    )
    assert filler_fraction_deviation(**numbers) == Thermogravimetry(**numbers).volume_fraction_deviation


def test_a_composite_takes_masses_in_place_of_the_fraction():
    numbers = named_composite("lingstat_identified").model_dump()
    by_masses = Film(composite=numbers | {"volume_fraction": LINGSTAT})
    by_number = Film(composite=numbers | {"volume_fraction": Thermogravimetry(**LINGSTAT).volume_fraction})
    force = [[1.0, 3.0]] * 2
    np.testing.assert_array_equal(by_masses.conductance([0.0, 10.0], force), by_number.conductance([0.0, 10.0], force))
    assert by_masses.composite.exponent == pytest.approx(253.44, abs=0.005)  # errata, for 0.28747
    assert Film.model_validate(by_masses.model_dump()) == by_masses


def test_a_case_tells_the_fraction_of_its_film():
    result = load_case(CASES / "film_thermogravimetry.yaml").experiment.run()
    assert result.quantities["volume_fraction"].value == pytest.approx(0.28747, abs=1e-5)
    assert result.quantities["resistance_exponent"].value == pytest.approx(253.44, abs=0.005)
    assert "volume_fraction" not in load_case(CASES / "film_lingstat.yaml").experiment.run().quantities


def test_the_case_with_both_densities():
    result = load_case(CASES / "thermogravimetry.yaml").experiment.run()
    assert result.quantities["volume_fraction"].value == pytest.approx([0.28747, 0.1115], abs=5e-5)
    assert result.quantities["exponent"].value == pytest.approx([253.44, 772.7], abs=0.05)
    # first order: the deviation of the exponent is that of the fraction times a slope
    for number, (low, high) in enumerate(zip(*_exponents(result), strict=True)):
        assert result.quantities["exponent_deviation"].value[number] == pytest.approx(abs(high - low) / 2, rel=2e-3)
    assert any("E27" in warning for warning in result.warnings)
    words = text_of(ThermogravimetryFigures().figure(result))
    assert "bulk: 0.2875" in words
    assert list(figures_for(result)) == ["thermogravimetry.png"]


def _exponents(result):
    """Exponents at the fraction less and plus its deviation."""
    composite = named_composite("lingstat_literal")
    fractions, deviations = (np.array(result.quantities[f"volume_fraction{end}"].value) for end in ("", "_deviation"))
    return [
        [composite.model_copy(update={"volume_fraction": float(v)}).exponent for v in fractions + sign * deviations]
        for sign in (-1, 1)
    ]


def test_one_reading_has_no_conflict():
    densities = [{"name": "bulk", "density": 560.0}]
    result = ThermogravimetricAnalysis(**LINGSTAT, filler_densities=densities).run()
    assert result.warnings == ()


def test_readings_of_exact_numbers_conflict_without_an_uncertainty():
    densities = [{"name": "bulk", "density": 560.0}, {"name": "solid", "density": 1800.0}]
    exact = {"mass_resolution": 0.0, "matrix_density_deviation": 0.0, "filler_densities": densities}
    (warning,) = ThermogravimetricAnalysis(**LINGSTAT, **exact).run().warnings
    assert "give 0.1115 to 0.2875: which density" in warning


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"filler_mass": 22 * MILLIGRAM}, "nothing burnt"),
        ({"filler_mass": 12 * MILLIGRAM}, "bulk density"),
        ({"sample_mass": 0.0}, "greater than 0"),
        ({"mass_resolution": -1e-9}, "at least 0"),
    ],
)
def test_impossible_masses_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        Thermogravimetry(**LINGSTAT | changes)


def test_a_case_of_impossible_masses_is_refused():
    with pytest.raises(CaseError, match="nothing burnt"):
        ThermogravimetricAnalysis(**LINGSTAT | {"filler_mass": 22 * MILLIGRAM})
    twice = [{"name": "a", "density": 560.0}, {"name": "a", "density": 1800.0}]
    with pytest.raises(CaseError, match="same name"):
        ThermogravimetricAnalysis(**LINGSTAT, filler_densities=twice)
