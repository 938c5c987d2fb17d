"""The film under any history: exact for constant forces, second order in time, streaming, and its inverse."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.identification.film_line import identify_film
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.films.composite import ModulusLine
from tactsim.sensors.films.composite_library import LIBRARY, named_composite
from tactsim.sensors.films.film import Film
from tactsim.sensors.films.film_equations import creep_strain, film_resistance, varying_coefficient_jump

SETS = sorted(LIBRARY)
TIMES = np.linspace(0.0, 40.0, 81)


def printed_2_3_1(force, time, composite, exponent):
    """Eq. 2.3.1 with errata E2, its numbers typed from the thesis."""
    area = 15e-3 * 15e-3
    rate = (449900 * force + 397700) / (1208200 * force + 2892800)
    strain = force / area * (1 / (60900 * force + 651200) + (1 - np.exp(-rate * time)) / (449900 * force + 397700))
    film = composite.initial_resistance * (1 - strain) * np.exp(-exponent * strain)
    return composite.contact_resistance / np.sqrt(force) + film


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("force", [0.01, 1.0, 5.0, 8.0, 25.0])
def test_a_constant_force_gives_2_3_1(name, force):
    film = Film(composite=name)
    resistance = 1 / film.conductance(TIMES, np.full(len(TIMES), force))
    expected = printed_2_3_1(force, TIMES, film.composite, film.composite.exponent)
    assert np.abs(resistance / expected - 1).max() < 1e-9
    wrong = printed_2_3_1(force * (1 + 1e-6), TIMES, film.composite, film.composite.exponent)
    assert np.abs(resistance / wrong - 1).max() > 1e-9
    np.testing.assert_allclose(film_resistance(film.composite, force, TIMES), expected, rtol=1e-12)


@pytest.mark.parametrize("step", [0.1, 7.0])
def test_a_constant_force_does_not_depend_on_the_sampling(step):
    film = Film()
    times = np.arange(0, 35.0, step)
    np.testing.assert_allclose(
        film.conductance(times, np.full(len(times), 3.0)), 1 / film_resistance(film.composite, 3.0, times), rtol=1e-12
    )


def swinging(time):
    return 2.0 - 1.5 * np.cos(1.3 * time)


def test_time_integration_is_of_second_order():
    film, end = Film(), 12.0
    composite = film.composite

    def rate(t, strain):
        force = swinging(t)
        return (force / composite.reference_area - composite.delayed.at(force) * strain) / composite.viscosity.at(force)

    exact = solve_ivp(rate, (0, end), [0.0], rtol=1e-12, atol=1e-15).y[0, -1]
    exact += swinging(end) / composite.reference_area / composite.instantaneous.at(swinging(end))
    errors = []
    for count in (100, 200, 400, 800):
        times = np.linspace(0, end, count + 1)
        errors.append(abs(film.strain(times, swinging(times))[-1] - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 2) < 0.1)
    assert not np.all(np.abs(orders - 3) < 0.1)


@pytest.mark.parametrize("name", SETS)
def test_the_inverse_gives_the_history_back(name):
    times = np.arange(0, 20, 0.05)
    force = np.stack([swinging(times), 0 * times, np.where(times > 3, 8.0, 0.0) * (times < 12), 0.001 + 0 * times], axis=1)
    film = Film(composite=name, active_area=81e-6)
    conductance = film.conductance(times, force)
    np.testing.assert_allclose(film.force(times, conductance), force, rtol=1e-10, atol=1e-15)
    off = film.force(times, conductance * (1 + 1e-6))
    assert np.abs(off / np.where(force > 0, force, 1) - 1)[force > 0].max() > 1e-7


def test_unloading_leaves_strain_that_recovers():
    film, times = Film(), np.arange(0, 100, 0.1)
    force = np.where(times < 10, 5.0, 0.0)
    strain = film.strain(times, force)
    after = strain[times > 10.1]
    assert np.all(after > 0)
    assert np.all(np.diff(after) < 0)
    rate = 397700 / 2892800
    assert after[500] / after[0] == pytest.approx(np.exp(-rate * 50.0), rel=1e-9)


def test_streaming_equals_the_whole_record():
    film, times = Film(), np.arange(0, 10, 0.02)
    force = np.stack([swinging(times), swinging(2 * times)], axis=1)
    whole = film.conductance(times, force)
    state, parts, back_state, back = None, [], None, []
    for begin, end in ((0, 1), (1, 7), (7, 250), (250, 500)):
        part, state = film.advance(state, times[begin:end], force[begin:end])
        forces, back_state = film.retreat(back_state, times[begin:end], part)
        parts.append(part)
        back.append(forces)
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    np.testing.assert_allclose(np.concatenate(back), force, rtol=1e-10)


def test_no_force_conducts_nothing():
    conductance = Film().conductance([0.0, 1.0, 2.0], [0.0, 0.0, 0.0])
    np.testing.assert_array_equal(conductance, 0.0)


def test_conductance_rises_with_force_and_its_slope_is_the_sensitivity():
    film, forces = Film(), np.linspace(0.01, 30, 200)
    conductance = film.conductance([0.0], forces[None])[0]
    assert np.all(np.diff(conductance) > 0)
    step = 1e-6
    slope = (film.conductance([0.0], forces[None] + step) - film.conductance([0.0], forces[None] - step))[0] / (2 * step)
    np.testing.assert_allclose(film.sensitivity([0.0], forces[None])[0], slope, rtol=1e-6)


def test_creep_shows_in_the_identified_set_alone():
    drifts = {}
    for name in SETS:
        conductance = Film(composite=name).conductance([0.0, 60.0], [1.0, 1.0])
        drifts[name] = conductance[1] / conductance[0] - 1
    assert drifts["lingstat_literal"] < 2e-4
    assert drifts["lingstat_identified"] > 0.3


def test_a_smaller_film_is_strained_by_its_pressure():
    small, large = Film(active_area=112.5e-6), Film()
    times = np.array([0.0, 5.0])
    np.testing.assert_allclose(small.strain(times, [1.0, 1.0]), large.strain(times, [2.0, 2.0]), rtol=1e-12)


def test_a_smaller_film_resists_more_and_its_contacts_do_not():
    """Half the area under half the force has the strain of the whole, twice its unstrained resistance and the same contacts."""
    half, whole = Film(active_area=112.5e-6), Film()
    strain = whole.strain(TIMES, np.full(81, 1.0))
    composite = whole.composite
    alone = composite.initial_resistance * (1 - strain) * np.exp(-composite.exponent * strain)
    resistance = composite.contact_resistance / np.sqrt(0.5) + 2 * alone
    np.testing.assert_allclose(1 / half.conductance(TIMES, np.full(81, 0.5)), resistance, rtol=1e-12)


def test_the_identified_resistances_are_those_of_the_line():
    identified = identify_film(named_composite("lingstat_literal"), THESIS_LINE)
    shipped = named_composite("lingstat_identified")
    assert shipped.initial_resistance == pytest.approx(identified.initial_resistance, rel=1e-4)
    assert shipped.contact_resistance == pytest.approx(identified.contact_resistance, rel=1e-4)
    assert shipped.initial_resistance != pytest.approx(
        identify_film(shipped, THESIS_LINE, forces=(0.5, 8.0)).initial_resistance, rel=0.05
    )


def test_varying_coefficients_in_2_1_14_do_not_give_2_3_1():
    composite = named_composite("lingstat_literal")
    excess = [varying_coefficient_jump(composite, force) / creep_strain(composite, force, 0.0) - 1 for force in (1.0, 8.0)]
    assert excess == pytest.approx([0.045, 0.305], abs=0.001)


@pytest.mark.parametrize(
    ("times", "forces", "message"),
    [
        ([0, 1], [1, -0.1], "force -0.1 N of sample 1"),
        ([0, 1], [1, 101.0], "allowed: 0 to 100 N"),
        ([0, 1], [1, np.nan], "finite"),
        ([0, 0], [1, 1], "must increase"),
        ([1, 0], [1, 1], "sort them"),
        ([0, np.inf], [1, 1], "finite"),
        ([], [], "at least one sample"),
        ([0, 1], [1, 1, 1], "one for each of 2 times"),
    ],
)
def test_bad_histories_are_refused(times, forces, message):
    with pytest.raises(InvalidQuantity, match=message):
        Film().conductance(times, forces)


def test_a_force_that_leaves_no_thickness_is_refused():
    constant = {"slope": 0.0, "intercept": 20e6}
    update = {"instantaneous": ModulusLine(**constant), "delayed": ModulusLine(**constant), "reference_area": 1e-6}
    film = Film(composite=named_composite("lingstat_literal").model_copy(update=update))
    assert film.conductance([0, 1e3], [9.0, 9.0]).min() > 0
    with pytest.raises(InvalidQuantity, match="strains the film by 1"):
        film.conductance([0, 1e3], [10.1, 10.1])


def test_conductances_that_no_force_gives_are_refused():
    with pytest.raises(InvalidQuantity, match="negative"):
        Film().force([0.0], [-1e-6])
    with pytest.raises(InvalidQuantity, match="more than 100 N"):
        Film().force([0.0], [1.0])
    with pytest.raises(InvalidQuantity, match="finite"):
        Film().force([0.0], [np.nan])


def test_an_unknown_composite_is_named():
    with pytest.raises(CaseError, match="lingstat_identified"):
        Film(composite="lingstat_identifed")


def test_numbers_of_another_composite_are_taken():
    given = named_composite("lingstat_literal").model_dump() | {"volume_fraction": 0.25, "source": "a test"}
    assert Film.model_validate({"composite": given}).composite.exponent > 253.7
    with pytest.raises(ValidationError, match="strain"):
        Film.model_validate({"composite": given | {"reference_area": "1 mm^2"}})
