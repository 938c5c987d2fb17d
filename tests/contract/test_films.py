"""Every registered sensor film, from its example: rising signal, inverse, no force, unit, memory, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import InvalidQuantity
from tactsim.interfaces import SensorFilm
from tactsim.registry import kinds
from tactsim.results.quantity import Quantity
from tactsim.units import parse_quantity

KINDS = kinds(SensorFilm)
TIMES = np.linspace(0.0, 3.0, 31)
every_kind = pytest.mark.parametrize("kind", sorted(KINDS))


def history(film: SensorFilm) -> np.ndarray:
    """Forces (31, 2) in N: up and down twice, within what was measured."""
    wave = np.sin(np.pi * TIMES / 1.5) ** 2
    return 0.8 * film.largest_force * np.stack([wave, 0.1 + 0.5 * wave], axis=1)


@every_kind
def test_the_signal_rises_with_the_force(kind):
    film = KINDS[kind].example()
    forces = np.linspace(0.0, film.largest_force, 200)
    for delay in (1e-3, 10.0):
        signal = film.read([0.0, delay], np.tile(forces, (2, 1)))
        assert (np.diff(signal, axis=1) > 0).all()
        assert (signal >= 0).all()
        strain = film.strain([0.0, delay], np.tile(forces, (2, 1)))
        assert (np.diff(strain, axis=1) > 0).all()
        assert ((strain >= 0) & (strain < 1)).all()


@every_kind
def test_the_inverse_gives_the_force_back(kind):
    film = KINDS[kind].example()
    forces = history(film)
    signal = film.read(TIMES, forces)
    np.testing.assert_allclose(film.force(TIMES, signal), forces, rtol=1e-9, atol=1e-9 * film.largest_force)
    wrong = film.force(TIMES, signal * (1 + 1e-6))
    assert np.abs(wrong - forces).max() > 1e-8 * film.largest_force


@every_kind
def test_the_sensitivity_is_the_slope_of_the_signal(kind):
    film, base = KINDS[kind].example(), 0.4 * KINDS[kind].example().largest_force
    step = 1e-5 * base
    jumps = film.read([0.0], np.array([[base - step, base + step]]))
    slope = float(np.diff(jumps[0])[0]) / (2 * step)
    assert float(film.sensitivity([0.0], [base])[0]) == pytest.approx(slope, rel=1e-6, abs=0)  # a central difference
    assert float(film.sensitivity([0.0], [1.1 * base])[0]) != pytest.approx(slope, rel=1e-3, abs=0)


@every_kind
def test_a_history_in_parts_is_the_history_in_one(kind):
    film = KINDS[kind].example()
    forces = history(film)
    whole = film.read(TIMES, forces)
    first, state = film.advance(None, TIMES[:12], forces[:12])
    second, _ = film.advance(state, TIMES[12:], forces[12:])
    np.testing.assert_allclose(np.concatenate([first, second]), whole, rtol=1e-13)
    begun, state = film.retreat(None, TIMES[:12], whole[:12])
    rest, _ = film.retreat(state, TIMES[12:], whole[12:])
    np.testing.assert_allclose(np.concatenate([begun, rest]), film.force(TIMES, whole), rtol=1e-9, atol=1e-12)


@every_kind
def test_no_force_is_the_least_signal_and_comes_back(kind):
    film = KINDS[kind].example()
    rest = film.read([0.0, 1.0], [0.0, 0.0])
    assert rest[0] == rest[1]
    np.testing.assert_array_equal(film.force([0.0, 1.0], rest), 0.0)
    np.testing.assert_array_equal(film.strain([0.0], [0.0]), 0.0)


@every_kind
def test_its_signal_has_a_unit_and_it_reports_what_it_is(kind):
    film = KINDS[kind].example()
    assert film.unit == {"conductance": "S", "capacitance": "F"}[film.signal]
    quantities = film.report(np.array([1.0]), film.read([0.0], [1.0])).constants
    assert quantities
    for name, quantity in quantities.items():
        assert isinstance(quantity, Quantity), name
        assert quantity.description
        assert quantity.unit == "1" or parse_quantity(f"1 {quantity.unit}", quantity.unit) == 1.0
        assert np.isfinite(quantity.value)
    assert film.assumptions()
    assert film.warnings(film.largest_force) == ()
    assert len(film.warnings(1.1 * film.largest_force)) == 1


@every_kind
def test_a_larger_area_is_pressed_less(kind):
    film = KINDS[kind].example()
    wide = film.model_copy(update={"active_area": 1e-3})
    assert wide.strain([0.0], [1.0])[0] < film.strain([0.0], [1.0])[0]
    assert wide.largest_force > film.largest_force


@every_kind
@pytest.mark.parametrize(
    ("times", "forces"), [([0.0, 0.0], [1.0, 1.0]), ([0.0, 1.0], [1.0, -1.0]), ([0.0, 1.0], [1.0, np.nan]), ([0.0, 1.0], [1.0])]
)
def test_what_no_film_can_take_is_refused(kind, times, forces):
    film = KINDS[kind].example()
    with pytest.raises(InvalidQuantity):
        film.read(times, forces)
    with pytest.raises(InvalidQuantity):
        film.force(times, forces)


@every_kind
def test_a_case_file_gives_it_back(kind):
    film = KINDS[kind].example()
    assert type(film).model_validate(film.model_dump()) == film
    assert type(film).model_validate_json(film.model_dump_json()) == film
