"""A grasp that ends in voltages, and the same from its stored result."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from drawn import covered_lines
from scenes import unmarked_figures

from tactsim.errors import InputError, StorageError
from tactsim.experiments.grasp.figures.taxel_voltages import voltages_figure
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.matrix_readout import MatrixReadoutRun
from tactsim.experiments.grasp.taxel_voltages import readout_quantities, readout_warnings, single_step
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting import figures_for
from tactsim.results import Quantity, Status
from tactsim.results.writing import write_result
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.films.capacitive_film import CapacitiveFilm
from tactsim.sensors.matrix_readout import MatrixReading, MatrixReadout

READOUT = MatrixReadout(seed=4)


@pytest.fixture(scope="module")
def read_grasp():
    return Grasp.example().model_copy(update={"readout": READOUT}).run()


def value(result, name):
    return np.asarray(result.quantities[name].value)


def test_a_grasp_with_a_readout_has_the_voltages_of_18_sensors_over_time(read_grasp):
    time, voltage = value(read_grasp, "readout_time"), value(read_grasp, "voltage_upper_history")
    assert time[0] == 0
    assert time[-1] == pytest.approx(1.0)
    assert voltage.shape == (len(time), 3, 3)
    assert np.all(voltage[0] == 0)
    assert np.all(np.diff(voltage, axis=0) > -1e-6)
    np.testing.assert_array_equal(voltage[-1], value(read_grasp, "voltage_upper"))
    error = value(read_grasp, "read_force_upper") - value(read_grasp, "taxel_force_upper")
    assert np.abs(error).max() <= float(value(read_grasp, "read_force_largest_error"))
    assert any("calibration by the film's own line" in assumption for assumption in read_grasp.assumptions)
    assert "taxel_voltages.png" in figures_for(read_grasp)


def test_a_film_that_creeps_is_warned_of_where_one_step_is_read():
    reading = READOUT.read(np.array([1.0]), np.full((1, 2, 3, 3), 0.4), 81e-6)
    (warning,) = single_step(READOUT, reading, 81e-6)
    assert "take time.steps: 5" in warning
    elastic = SimpleNamespace(film_of=lambda area: CapacitiveFilm.example())
    assert single_step(elastic, reading, 81e-6) == ()
    for steps in (1, 2):
        result = Grasp.example().model_copy(update={"readout": READOUT, "time": {"steps": steps}}).run()
        assert any("in the one step" in text for text in result.warnings) == (len(result.steps) == 1)
        assert len(result.steps) == steps


def test_a_stored_grasp_of_one_step_is_warned_of_as_that_of_a_run_is(tmp_path):
    for steps in (1, 2):
        grasp = Grasp.example().model_copy(update={"readout": READOUT, "time": {"steps": steps}}).run()
        write_result(grasp, tmp_path / f"{steps}", case_id="0" * 16, provenance={})
        again = MatrixReadoutRun(grasp=str(tmp_path / f"{steps}"), readout=READOUT).run()
        warned = [[text for text in result.warnings if "the film creeps" in text] for result in (grasp, again)]
        assert warned[0] == warned[1]
        assert len(warned[1]) == (steps == 1)


def test_without_a_readout_a_grasp_ends_at_the_forces():
    result = Grasp.example().run()
    assert "voltage_upper" not in result.quantities
    assert "taxel_voltages.png" not in figures_for(result)


def test_a_readout_that_fails_does_not_lose_the_grasp():
    fast = MatrixReadout(chain={"sampling_rate": 200e3, "low_pass": None})
    result = Grasp.example().model_copy(update={"readout": fast}).run()
    assert result.status is Status.CONVERGED
    assert "taxel_force_upper" in result.quantities
    assert "voltage_upper" not in result.quantities
    assert any("no voltages" in words and "lower sampling_rate" in words for words in result.warnings)


def test_an_incomplete_grasp_is_refused(read_grasp, tmp_path):
    write_result(replace(read_grasp, scene=None), tmp_path / "grasp", case_id="0" * 16, provenance={})
    with pytest.raises(StorageError, match="not a complete result of a grasp"):
        MatrixReadoutRun(grasp=str(tmp_path / "grasp")).run()


def test_a_stored_grasp_is_read_alike(read_grasp, tmp_path):
    folder = tmp_path / "grasp"
    write_result(read_grasp, folder, case_id="0" * 16, provenance={})
    again = MatrixReadoutRun(grasp=str(folder), readout=READOUT).run()
    assert again.status is Status.CONVERGED
    for name in ("voltage_lower_history", "read_force_upper"):
        np.testing.assert_allclose(value(again, name), value(read_grasp, name), rtol=1e-9, atol=1e-12)
    other = MatrixReadoutRun(grasp=str(folder), readout=MatrixReadout(seed=4, scatter=None)).run()
    assert np.abs(value(other, "voltage_upper") - value(read_grasp, "voltage_upper")).max() > 1e-4
    assert figures_for(again)["taxel_voltages.png"]()[:4] == b"\x89PNG"
    assert unmarked_figures(again) == []


def test_a_folder_without_a_grasp_is_refused(tmp_path):
    with pytest.raises(StorageError):
        MatrixReadoutRun(grasp=str(tmp_path / "none")).run()
    from tactsim.experiments.film.film_test import FilmTest

    write_result(FilmTest.example().run(), tmp_path / "film", case_id="0" * 16, provenance={})
    with pytest.raises(InputError, match="needed: a grasp"):
        MatrixReadoutRun(grasp=str(tmp_path / "film")).run()


def test_the_names_of_the_taxels_stand_clear_of_curves_that_rise_at_once():
    """The names of a grasp that held lay on the curves."""
    time, force = np.array([0.05, 1.0]), np.full((2, 2, 3, 4), 0.4)
    readout = MatrixReadout(scatter=None)
    result = Grasp.example().model_copy(update={"readout": readout}).run()
    held = readout.read(time, force, 81e-6)
    result = replace(
        result,
        quantities=result.quantities
        | readout_quantities(held)
        | {f"taxel_force_{side}": Quantity(force[-1, 0].tolist(), "N", "") for side in JAWS},
    )
    names = [name for name in covered_lines(voltages_figure(result)) if not name.startswith("_")]
    assert names == []


def test_a_line_that_reads_no_force_at_all_is_warned_of():
    """Taxels of 25 mm² under 40 mN read -0.3 N by the line from 0 to 2 N, without a word."""
    time, force = np.array([0.5, 1.0]), np.array([0.5, 1.0])[:, None, None, None] * np.full((2, 3, 3), 0.04)
    for forces, warned in (((0.0, 2.0), True), ((0.0, 0.05), False)):
        readout = MatrixReadout(calibration_forces=forces, scatter=None)
        warnings = readout_warnings(readout, readout.read(time, force, 25e-6), 25e-6)
        assert any("more than the largest force, 40 mN" in words for words in warnings) == warned
    default = MatrixReadout(scatter=None)
    assert readout_warnings(default, default.read(time, 10 * force, 81e-6), 81e-6) == ()


def test_a_last_sample_long_before_the_end_is_warned_of():
    """A ramp of 0.5 s at 3 Hz is last sampled at a third of a second, at two thirds of its force."""
    time, force = np.array([0.25, 0.5]), np.array([0.2, 0.4])[:, None, None, None] * np.ones((2, 3, 3))
    slow = MatrixReadout(chain=SignalChain(sampling_rate=3.0, low_pass=None))
    reading = slow.read(time, force, 81e-6)
    assert reading.missed == pytest.approx(0.4 / 3)
    (late,) = [text for text in readout_warnings(slow, reading, 81e-6) if "last sample" in text]
    assert "at 333.33 ms" in late
    assert "by 133.33 mN" in late
    held = np.append(time, 0.9), np.concatenate([force, force[-1:]])
    for readout, course in ((MatrixReadout(), (time, force)), (slow, held)):
        reading = readout.read(*course, 81e-6)
        assert reading.missed < 1e-12
        assert not any("last sample" in text for text in readout_warnings(readout, reading, 81e-6))


def test_samples_beyond_the_converter_without_a_force_are_told_apart():
    """Noise about 0 V alone read as if the sensors were saturated, in every grasp with noise."""
    readout = MatrixReadout()
    size = (3, 2, 3, 3)
    applied, saturated = np.zeros(size), np.zeros(size, bool)
    saturated[0, 0, 0] = True
    reading = MatrixReading(np.arange(3.0), applied, *(np.zeros(size) for _ in range(3)), saturated, 0.0)
    (unloaded,) = readout_warnings(readout, reading, 1e-4)
    assert unloaded.startswith("3 of 54 samples of taxels are outside the range")
    assert ", all of them without a force: saturated_*" in unloaded
    applied[0, 0, 0] = 1.0
    (loaded,) = readout_warnings(readout, reading, 1e-4)
    assert "without a force" not in loaded
