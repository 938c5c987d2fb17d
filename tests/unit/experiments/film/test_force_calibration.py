"""The experiment: synthetic and measured readings, what it reports and warns of, and its figure."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tactsim.case import load_case
from tactsim.errors import CaseError, InvalidQuantity, StorageError
from tactsim.experiments.film.calibration import ForceCalibration
from tactsim.experiments.film.force_calibration_source import MeasuredCalibration, SyntheticCalibration
from tactsim.results import Status
from tactsim.results.document import document_text
from tactsim.results.writing import history_table
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.electronics.channel_scatter import ChannelScatter
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain

NOISY = SignalChain(noise=Noise(white=10e-3, line=20e-3))
QUICK = SyntheticCalibration(hold=0.2)


def run(**settings):
    steps = []
    result = ForceCalibration(**{"data": QUICK, **settings}).run(steps.append)
    assert tuple(steps) == result.steps
    return result


@pytest.fixture
def written(tmp_path):
    def write(force, voltage, header="force [N],voltage [mV]"):
        path = tmp_path / "readings.csv"
        np.savetxt(path, np.column_stack([force, voltage]), delimiter=",", header=header, comments="", fmt="%.17g")
        return MeasuredCalibration(path=str(path))

    return write


def test_the_line_comes_back_without_noise():
    result = run()
    assert result.status is Status.CONVERGED
    quantities = result.quantities
    assert abs(quantities["slope_error"].value) < 1e-4  # steps of the converter
    assert abs(quantities["intercept_error"].value) < 1e-7
    assert quantities["noise"].value < NOISY.converter.step
    assert result.warnings == ()
    assert not run(data=QUICK.model_copy(update={"seed": 2})).warnings
    assert any("not printed" in words for words in result.assumptions)
    assert len(result.steps) == quantities["readings"].value == 52


def test_noise_widens_the_intervals_and_repeats_with_its_seed():
    result = run(chain=NOISY)
    low, high = result.quantities["slope_interval"].value
    assert low < result.quantities["slope"].value < high
    assert result.steps == run(chain=NOISY).steps
    assert result.steps != run(chain=NOISY, data=QUICK.model_copy(update={"seed": 2})).steps
    assert result.quantities["linearity_negative"].value < 0 < result.quantities["linearity_positive"].value
    assert high - low > 100 * np.diff(run().quantities["slope_interval"].value)
    assert "line_upper [S]" in history_table(result)
    assert "null" not in document_text(result, "case")


def test_a_file_gives_the_same_line(written):
    force = np.linspace(1, 25, 25)
    voltage = SignalChain().voltage(THESIS_LINE.conductance(force))
    result = run(data=written(force, 1e3 * voltage))
    assert result.quantities["slope"].value == pytest.approx(THESIS_LINE.slope, rel=1e-10)
    assert "slope_error" not in result.quantities
    assert not any("synthetic" in words for words in result.assumptions)


def test_every_sensor_of_two_matrices_has_its_line():
    data = QUICK.model_copy(update={"sensors": 18, "scatter": ChannelScatter()})
    result = run(data=data, chain=NOISY)
    quantities = result.quantities
    assert quantities["slope"].value.shape == (18,)
    assert quantities["slope_interval"].value.shape == (2, 18)
    assert quantities["slope"].value.std() / THESIS_LINE.slope == pytest.approx(
        0.025, rel=0.5
    )  # 18 channels: three standard errors
    assert np.abs(quantities["slope_error"].value).max() < 0.02
    assert [step.values["sensor"] for step in result.steps[51:53]] == [1, 2]
    assert "null" not in document_text(result, "case")
    one = run(chain=NOISY, data=data.model_copy(update={"sensors": 1}))
    assert np.ndim(one.quantities["slope"].value) == 0


def test_a_file_of_two_sensors(written):
    force = np.linspace(1, 25, 25)
    voltage = SignalChain().voltage(THESIS_LINE.conductance(force)[:, None] * [1.0, 1.2])
    header = "force [N],voltage 1 [V],voltage 2 [V]"
    both = written(force, voltage, header).model_copy(update={"sensors": 2})
    np.testing.assert_allclose(run(data=both).quantities["slope"].value, THESIS_LINE.slope * np.array([1.0, 1.2]), rtol=1e-10)
    with pytest.raises(InvalidQuantity, match="no column voltage 3; allowed: force"):
        run(data=both.model_copy(update={"sensors": 3}))


def test_saturated_readings_are_left_out_and_reported():
    result = run(chain=SignalChain(converter=Converter(high=2.0)))
    assert result.quantities["excluded"].value > 4
    assert any("saturated and were left out" in words for words in result.warnings)
    assert abs(result.quantities["slope_error"].value) < 1e-3


def test_a_saturated_file_is_noticed(written):
    voltage = np.minimum(SignalChain().voltage(THESIS_LINE.conductance(np.arange(1, 26.0))), 2.0)
    result = run(data=written(np.arange(1, 26.0), 1e3 * voltage), chain=SignalChain(converter=Converter(high=2.0)))
    assert result.quantities["excluded"].value == np.count_nonzero(voltage == 2.0)


def test_a_curved_sensor_is_warned_of(written):
    force = np.linspace(0, 25, 26)
    bowed = force + 4 * 0.05 * force * (1 - force / 25)
    result = run(data=written(force, 1e3 * SignalChain().voltage(THESIS_LINE.conductance(bowed))))
    assert any("follow a curve" in words for words in result.warnings)
    assert not any("follow a curve" in words for words in run(chain=NOISY).warnings)


@pytest.mark.parametrize("order", [1, 2, 5])
def test_a_low_pass_that_has_not_settled_is_warned_of_until_its_advice_is_taken(order):
    slow = SignalChain(low_pass=LowPass(cutoff=1.0, order=order))
    result = run(chain=slow)
    (warning,) = (text for text in result.warnings if "low pass" in text)
    assert warning.startswith("the low pass of 1 Hz is up to ")
    assert "at the end of a hold of 200 ms, where a step of the converter is " in warning
    assert abs(result["slope_error"].value) > 0.05
    hold, cutoff = (float(re.search(words, warning)[1]) for words in (r"data\.hold to ([\d.]+) s", r"cutoff to ([\d.]+) Hz"))
    for data, low_pass in ((SyntheticCalibration(hold=hold), slow.low_pass), (QUICK, LowPass(cutoff=cutoff, order=order))):
        settled = run(data=data, chain=SignalChain(low_pass=low_pass))
        assert not any("low pass" in text for text in settled.warnings)
        assert abs(settled["slope_error"].value) < 1e-3, "what is left of a jump is below a step of 16 bits"
    assert not any("low pass" in text for text in run(chain=SignalChain(low_pass=None)).warnings)


def test_holds_that_fill_the_memory_are_refused():
    with pytest.raises(InvalidQuantity, match="lower hold, repeats or sampling_rate"):
        run(data=SyntheticCalibration(hold=100.0), chain=SignalChain(sampling_rate=1e6, low_pass=None))


def test_bad_files_are_refused(written, tmp_path):
    with pytest.raises(StorageError):
        run(data=MeasuredCalibration(path=str(tmp_path / "none.csv")))
    with pytest.raises(InvalidQuantity, match="unknown column"):
        run(data=written([1.0], [2.0], header="force [N],current [A]"))
    path = tmp_path / "force.csv"
    path.write_text("force [N]\n1\n2\n3\n")
    with pytest.raises(InvalidQuantity, match="no column voltage"):
        run(data=MeasuredCalibration(path=str(path)))
    for force, words in ((np.full(5, 3.0), "all forces are equal"), (np.arange(-1.0, 4.0), "a force is -1 N")):
        with pytest.raises(InvalidQuantity, match=rf"readings\.csv: {words}"):
            run(data=written(force, 1e3 * np.arange(1.0, 6.0) / 5))


@pytest.mark.parametrize(
    "changes",
    [
        {"confidence": 1.0},
        {"full_scale": 0.0},
        {"data": {"kind": "guess"}},
        {"data": {"kind": "synthetic", "forces": ()}},
        {"data": {"kind": "synthetic", "forces": (-1.0, 2.0)}},
        {"data": {"kind": "synthetic", "hold": 0.0}},
        {"chain": {"supply": 0.0}},
    ],
)
def test_bad_settings_are_refused(changes):
    with pytest.raises(CaseError):
        ForceCalibration(**changes)


def test_the_case_finds_the_declared_line(request, monkeypatch):
    monkeypatch.chdir(request.config.rootpath)
    experiment = load_case("cases/calibrate_force_sensor.yaml").experiment
    result = experiment.run()
    assert result.quantities["slope"].value == pytest.approx(THESIS_LINE.slope, rel=0.05)
