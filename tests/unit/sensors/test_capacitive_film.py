"""The capacitive film against its closed form, the law of its dielectric against a solution in stretches, and its refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from tactsim.case.loading import load_case
from tactsim.errors import CaseError, InvalidQuantity
from tactsim.experiments.film.film_test import FilmTest
from tactsim.experiments.film.sensor_response import SensorResponse
from tactsim.materials.homogeneous import nominal_stress
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.plotting import figures_for
from tactsim.sensors.electronics.charge_amplifier import ChargeAmplifier
from tactsim.sensors.films.capacitive_film import CapacitiveFilm
from tactsim.sensors.films.film import Film

FILM = CapacitiveFilm(active_area=1e-4, thickness=0.5e-3, relative_permittivity=3.0, shear_modulus=15e3)
REST = FILM.report(np.ones(1), FILM.read([0.0], [1.0])).constants["rest_capacitance"].value
FORCES = np.array([0.0, 0.1, 0.5, 1.0, 3.0, 20.0])


def closed_form(film: CapacitiveFilm, force: float) -> float:
    """eps A / (t0 - u) with u from the stress of a neo-Hookean bar in space, found by another root finder."""
    dielectric = NeoHookean(c10=film.shear_modulus / 2)

    def excess(stretch: float) -> float:
        return -float(nominal_stress(dielectric, "uniaxial", np.array(stretch))) * film.area - force

    stretch = brentq(excess, 0.05, 1.0, xtol=1e-15, rtol=1e-14) if force else 1.0
    return 8.8541878128e-12 * film.relative_permittivity * film.area / (film.thickness - film.thickness * (1 - stretch))


def test_the_capacitance_is_the_closed_form():
    expected = [closed_form(FILM, force) for force in FORCES]
    np.testing.assert_allclose(FILM.read([0.0], FORCES[None])[0], expected, rtol=1e-12)
    by_hand = 5.31251e-12  # 8.854 pF/m x 3 x 1e-4 / 0.5e-3 m
    assert pytest.approx(by_hand, rel=1e-5, abs=0) == REST
    mutants = {"thickness": 0.51e-3, "relative_permittivity": 3.03, "shear_modulus": 15.2e3, "active_area": 1.01e-4}
    for name, value in mutants.items():
        wrong = FILM.model_copy(update={name: value}).read([0.0], FORCES[None])[0]
        assert np.abs(wrong / expected - 1).max() > 1e-3, name


def test_a_linear_dielectric_is_seen_to_be_wrong():
    """Mutant: u = p t0 / (3 mu), the small strain limit, holds at 0.1 % of the modulus and not at its size."""
    small, large = 1e-3 * FILM.shear_modulus * FILM.area, FILM.shear_modulus * FILM.area
    for force, within in ((small, True), (large, False)):
        linear = REST / (1 - force / (3 * FILM.shear_modulus * FILM.area))
        assert (linear == pytest.approx(float(FILM.read([0.0], [force])[0]), rel=1e-5, abs=0)) is within


def test_the_default_modulus_gives_back_the_measured_stress():
    film = CapacitiveFilm.example()
    assert nominal_stress(NeoHookean(c10=film.shear_modulus / 2), "uniaxial", np.array(1.5)) == pytest.approx(16e3, rel=1e-12)
    assert film.strain([0.0], [film.largest_force])[0] == pytest.approx(1 / 3, rel=1e-12)


def test_a_capacitance_that_no_force_gives_is_refused():
    for wrong in (0.9 * REST, 1e3 * REST):
        with pytest.raises(InvalidQuantity, match="without force to"):
            FILM.force([0.0], [wrong])


def test_the_charge_amplifier_is_proportional_and_inverted():
    amplifier = ChargeAmplifier(excitation=2.0, feedback=10e-12)
    np.testing.assert_allclose(amplifier.voltage(np.array([5e-12, 10e-12])), [1.0, 2.0], rtol=1e-15)
    np.testing.assert_allclose(amplifier.capacitance(amplifier.voltage(np.array([3e-12]))), [3e-12], rtol=1e-15)
    with pytest.raises(InvalidQuantity, match="not finite"):
        amplifier.capacitance(np.array([np.inf]))


CASE = """\
schema: tactsim/case/1
title: Capacitive film
experiment:
  kind: film_test
  film: {kind: capacitive_film, active_area: 100 mm^2, thickness: 0.5 mm}
  amplifier: {excitation: 1 V, feedback: 20 pF}
  forces: [0.2 N, 0.5 N, 1 N]
  times: [1 s]
"""


def test_a_case_file_tests_it_with_figure(tmp_path: Path):
    path = tmp_path / "case.yaml"
    path.write_text(CASE, encoding="utf-8")
    result = load_case(path).experiment.run(lambda step: None)
    film = CapacitiveFilm(active_area=1e-4)
    expected = [closed_form(film, force) for force in (0.2, 0.5, 1.0)]
    np.testing.assert_allclose(result.quantities["reading_capacitance"].value, expected, rtol=1e-12)
    np.testing.assert_allclose(result.quantities["reading_voltage"].value, np.array(expected) / 20e-12, rtol=1e-12)
    assert result.units["capacitance"] == "F"
    assert "resistance" not in result.units
    assert result.quantities["drift"].value == [0.0, 0.0, 0.0]
    drawings = figures_for(result)
    assert list(drawings) == ["film_test.png"]
    assert drawings["film_test.png"]().startswith(b"\x89PNG")


def test_what_reads_a_conductance_refuses_it_by_line_and_key(tmp_path: Path):
    path = tmp_path / "case.yaml"
    text = (
        "schema: tactsim/case/1\ntitle: divider\nexperiment:\n  kind: sensor_response\n"
        "  force: {kind: square, duration: 2 s}\n  film: {kind: capacitive_film}\n"
    )
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CaseError, match=r"yaml:6: experiment.film: .*capacitive_film has no conductance, which"):
        load_case(path)
    with pytest.raises(CaseError, match="has no conductance"):
        SensorResponse(force={"kind": "square", "duration": 2.0}, film=CapacitiveFilm())
    path.write_text(CASE.replace("{kind: capacitive_film, active_area: 100 mm^2, thickness: 0.5 mm}", "{}"), encoding="utf-8")
    with pytest.raises(CaseError, match="amplifier: film has no capacitance"):
        load_case(path)


def test_a_film_without_a_kind_is_piezoresistive():
    assert type(FilmTest.model_validate({"film": {"active_area": 1e-4}}).film) is Film
