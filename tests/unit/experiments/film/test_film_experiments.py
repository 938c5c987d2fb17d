"""Film tests, creep identification and the response of a sensor as experiments of a case file."""

import numpy as np
import pytest

from tactsim.case import load_case
from tactsim.errors import CaseError, InvalidQuantity, StorageError
from tactsim.experiments.film.film_creep import FilmCreep, MeasuredCreep
from tactsim.experiments.film.film_test import FilmTest
from tactsim.experiments.film.force_signal import Chirp, Pieces, Record, Square
from tactsim.experiments.film.sensor_response import SensorResponse
from tactsim.results import Status
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.films.composite_library import named_composite
from tactsim.sensors.films.film_equations import film_resistance
from tactsim.sensors.response_errors import hysteresis, range_errors


def values(result):
    return {name: quantity.value for name, quantity in result.quantities.items()}


def quiet(record):
    """No progress."""


def test_a_film_test_reports_2_3_1_at_its_forces_and_times():
    seen = []
    result = FilmTest.example().run(seen.append)
    assert result.status is Status.CONVERGED
    assert len(seen) == 9
    expected = film_resistance(
        named_composite("lingstat_identified"), np.array([1.0, 2.0, 4.0]), np.array([0.0, 1.0, 10.0])[:, None]
    )
    np.testing.assert_allclose(values(result)["resistance"], expected, rtol=1e-9)
    assert values(result)["reading_resistance"] == pytest.approx(expected[1], rel=1e-9)


def test_a_force_beyond_the_creep_tests_is_reported():
    assert "measured up to 8 N" in FilmTest(forces=(1.0, 5.0, 20.0)).run(quiet).warnings[0]


@pytest.mark.parametrize(
    ("forces", "times"),
    [
        ((1.0, 1.0, 2.0), (1.0,)),
        ((1.0, 2.0, 3.0), (2.0, 1.0)),
        ((0.0, 1.0, 2.0), (1.0,)),
        ((1e-310, 1.0, 2.0), (1.0,)),
        ((1.0, 2.0, 3.0), (1e308,)),
    ],
)
def test_a_film_test_refuses_lists_out_of_order(forces, times):
    with pytest.raises(CaseError):
        FilmTest(forces=forces, times=times)


def test_creep_of_the_thesis_comes_back_within_its_intervals():
    quantities = values(FilmCreep.example().run(quiet))
    for name, slope, intercept in (
        ("instantaneous", 60900, 651200),
        ("delayed", 449900, 397700),
        ("viscosity", 1208200, 2892800),
    ):
        assert abs(quantities[f"{name}_slope"] - slope) < 2 * quantities[f"{name}_slope_half_width"]
        assert abs(quantities[f"{name}_intercept"] - intercept) < 2 * quantities[f"{name}_intercept_half_width"]


def test_moduli_and_viscosity_have_axes_of_their_own():
    result = FilmTest(forces=(1.0, 2.0, 4.0), times=(1.0, 3.0, 10.0)).run()
    labels = [axis.get_ylabel() for axis in result.plot("film_test").axes]
    assert "moduli $E_0$ and $E_1$ in MPa" in labels
    assert "viscosity $\\mu_1$ in MPa s" in labels


def test_creep_that_has_no_creep_in_it_fails(tmp_path):
    rows = [f"{t},{force},{0.01 * force}" for force in (1, 2, 3) for t in range(20)]
    path = tmp_path / "flat.csv"
    path.write_text("\n".join(["time [s], force [N], strain [1]", *rows]), encoding="utf-8")
    result = FilmCreep(data=MeasuredCreep(kind="file", path=str(path), area=1e-4)).run(quiet)
    assert result.status is Status.FAILED
    assert "stopped converging" in result.reason


def test_without_noise_the_model_finds_the_force_within_one_step_of_the_converter():
    for force in (Chirp(kind="chirp", duration=5.0), Square(kind="square", duration=3.0)):
        quantities = values(SensorResponse(force=force, chain=SignalChain(sampling_rate=200.0)).run(quiet))
        assert quantities["inversion_steps"] < 1
    coarse = {"low": 0.0, "high": 5.0, "bits": 10}
    quantities = values(SensorResponse(force=force, chain=SignalChain(sampling_rate=200.0, converter=coarse)).run(quiet))
    assert quantities["inversion_steps"] < 1


def test_noise_takes_the_model_further_than_one_step():
    chain = SignalChain(sampling_rate=200.0, noise={"white": 1e-3})
    assert values(SensorResponse(force=Chirp(kind="chirp", duration=3.0), chain=chain).run(quiet))["inversion_steps"] > 1


def test_the_same_seed_gives_the_same_readings():
    noisy = SignalChain(sampling_rate=200.0, noise={"white": 1e-3, "line": 1e-3})
    runs = [SensorResponse(force=Chirp(kind="chirp", duration=1.0), chain=noisy, seed=seed).run(quiet) for seed in (3, 3, 4)]
    read = [[step.values["read_force"] for step in run.steps] for run in runs]
    assert read[0] == read[1]
    assert read[0] != read[2]


def test_saturated_samples_are_flagged_and_reported():
    chain = SignalChain(sampling_rate=200.0, converter={"low": 0.0, "high": 0.3, "bits": 12})
    result = SensorResponse(force=Square(kind="square", duration=2.0), chain=chain).run(quiet)
    assert 0.4 < values(result)["saturated_fraction"] < 0.6
    assert "outside the range of the converter" in result.warnings[0]
    assert all(np.isfinite(list(step.values.values())).all() for step in result.steps)


def test_a_record_that_is_saturated_throughout_makes_no_claim_on_the_inverse():
    chain = SignalChain(sampling_rate=200.0, converter={"low": 4.0, "high": 5.0})
    result = SensorResponse(force=Square(kind="square", duration=1.0), chain=chain).run(quiet)
    assert "inversion_steps" not in result.quantities
    assert max(values(result)["model_range_largest_error"]) == 0 < max(values(result)["linear_range_largest_error"])


def test_noise_below_zero_is_read_as_a_force_below_the_line():
    chain = SignalChain(sampling_rate=200.0, noise={"white": 0.01}, converter={"low": -5.0, "high": 5.0}, low_pass=None)
    still = Square(kind="square", low=0.0, high=1e-6, duration=5.0)
    read = [step.values["read_force"] for step in SensorResponse(force=still, chain=chain).run(quiet).steps]
    assert np.mean(read) == pytest.approx(-0.132, abs=0.01), "the intercept of the line, not lifted by a cut at 0 V"


def sines(*frequencies):
    waves = [{"kind": "sine", "amplitude": 0.5, "frequency": frequency, "duration": 1.0} for frequency in frequencies]
    jump = {"kind": "jump", "to": 1.0, "duration": 1.0}
    return Pieces.model_validate({"kind": "pieces", "loading": {"control": "force", "pieces": [jump, *waves]}})


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (Square(kind="square", duration=1e6), "take a shorter force"),
        (Square(kind="square", frequency=150.0), "above half the sampling_rate"),
        (Chirp(kind="chirp", end_frequency=150.0), "above half the sampling_rate"),
        (sines(1.0, 150.0), "frequency of 150 Hz is above half the sampling_rate"),
    ],
)
def test_forces_that_cannot_be_sampled_are_refused(force, words):
    with pytest.raises(InvalidQuantity, match=words):
        SensorResponse(force=force, chain=SignalChain(sampling_rate=200.0)).run(quiet)


def test_waves_keep_to_their_bounds():
    time = np.linspace(0, 20, 4001)
    chirp = Chirp(kind="chirp").sampled(time)
    assert chirp[0] == pytest.approx(0.1)
    assert chirp.min() >= 0.1 - 1e-12
    assert chirp.max() == pytest.approx(2.6, abs=1e-3)
    square = Square(kind="square", duration=3.0).sampled(np.array([0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0]))
    np.testing.assert_array_equal(square, [0.1, 0.1, 2.5, 2.5, 0.1, 2.5, 0.1])
    climbing = Square(kind="square", increment=0.1, duration=30.0).sampled(np.array([0.75, 1.75, 9.75, 29.75]))
    np.testing.assert_allclose(climbing, [0.2, 0.3, 1.1, 2.5])
    with pytest.raises(CaseError, match="below high"):
        Chirp(kind="chirp", low=3.0)


def test_a_sensor_that_is_let_go_is_not_pulled_by_round_off():
    up, down = {"kind": "ramp", "to": 4.0, "duration": 0.3}, {"kind": "ramp", "to": 0.0, "duration": 0.7}
    pieces = [up, {"kind": "hold", "duration": 2.0}, down, {"kind": "hold", "duration": 1.0}]
    let_go = SensorResponse(
        force={"kind": "pieces", "loading": {"control": "force", "pieces": pieces}},
        chain=SignalChain(sampling_rate=500.0),
    ).run(quiet)
    assert float(let_go.history["force"].min()) == 0.0
    assert float(let_go.history["force"].max()) == 4.0
    held = [{"kind": "jump", "to": 9.69, "duration": 0.1}, {"kind": "hold", "duration": 4.2}]
    pieces = [*held, {"kind": "ramp", "to": 0.0, "duration": 8.3}, {"kind": "hold", "duration": 1.0}]
    slow = Pieces(kind="pieces", loading={"control": "force", "pieces": pieces})
    assert slow.sampled(np.array([12.6])) == 0.0, "the ramp ends in the next floating-point number"


def test_a_record_is_read_from_a_file(tmp_path):
    path = tmp_path / "force.csv"
    path.write_text("time [s], force [mN]\n1, 0\n2, 500\n3, 0\n", encoding="utf-8")
    record = Record(kind="file", path=str(path))
    assert record.duration == 2.0
    np.testing.assert_allclose(record.sampled(np.array([0.0, 0.5, 1.0, 2.0])), [0, 0.25, 0.5, 0])


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("2, 0\n1, 0", "force.csv: .*sort them"),
        ("1, 0\n2, -5", "force.csv: force .*allowed: 0 to 100"),
        ("-1e308, 0\n1e308, 0", "force.csv: .*up to 1e\\+30"),
        ("1, " + "1" * 140_000, "force.csv:2: field larger"),
    ],
)
def test_bad_records_are_refused_with_their_file(tmp_path, rows, words):
    path = tmp_path / "force.csv"
    path.write_text(f"time [s], force [mN]\n{rows}\n", encoding="utf-8")
    with pytest.raises(InvalidQuantity, match=words):
        _ = Record(kind="file", path=str(path)).duration


def test_files_that_cannot_be_read_are_named(tmp_path):
    path = tmp_path / "force.csv"
    path.write_text("time [s], force [N]\n1, 0\n", encoding="utf-16")
    with pytest.raises(StorageError, match="save it as UTF-8"):
        _ = Record(kind="file", path=str(path)).duration
    with pytest.raises(CaseError, match="without a null character"):
        Record(kind="file", path="a\0b")


def test_errors_by_range_and_hysteresis():
    force = np.array([0.1, 0.6, 1.1, 1.0])
    ranges = range_errors(force, force + np.array([0.1, -0.2, 0.3, 0.1]), (0.0, 1.0, 1.1))
    assert [r.samples for r in ranges] == [2, 2]
    assert ranges[0].largest == pytest.approx(0.2)
    time = np.linspace(0, 1, 2001)
    triangle = 1 - np.abs(2 * time - 1)
    assert hysteresis(triangle, triangle + 0.1 * (time > 0.5)) == pytest.approx(0.1, rel=0.05)
    assert hysteresis(np.ones(5), np.ones(5)) == 0


def test_the_figure_says_to_which_line_the_film_was_identified():
    result = load_case("film_lingstat").run(None)
    figure = result.plot("film_test")
    words = figure.get_supxlabel()
    assert "identified to F = 20.94 C − 0.132" in words
    assert "0.5 to 5 N at 1 s" in words, "the line of readings up to 8 N is another one"
