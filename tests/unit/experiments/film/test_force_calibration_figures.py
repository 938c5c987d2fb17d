"""The figure of a calibration: line, band and readings, the limits of linearity, and what was left out."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import text_of

from tactsim.experiments.film.calibration import ForceCalibration
from tactsim.experiments.film.figures.calibration import ForceCalibrationFigures
from tactsim.experiments.film.force_calibration_source import SyntheticCalibration
from tactsim.plotting import figures_for
from tactsim.results import Result, Status
from tactsim.sensors.electronics.channel_scatter import ChannelScatter
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain

FORCES = tuple(range(1, 26))
"""Without 0 N, where noise below 0 V saturates a converter that begins there."""


def calibrated(sensors=1, **chain):
    settings = {"noise": Noise(white=10e-3, line=20e-3), **chain}
    data = SyntheticCalibration(hold=0.2, forces=FORCES, sensors=sensors, scatter=ChannelScatter())
    return ForceCalibration(data=data, chain=SignalChain(**settings)).run()


@pytest.fixture(scope="module")
def result():
    return calibrated()


def test_it_is_found_by_the_kind_and_drawn(result):
    drawings = figures_for(result)
    assert list(drawings) == ["calibration.png"]
    assert drawings["calibration.png"]().startswith(b"\x89PNG")
    assert figures_for(Result(kind="calibration", status=Status.FAILED, reason="no reading")) == {}


def test_it_says_line_band_and_limits(result):
    figure = ForceCalibrationFigures().figure(result)
    written = text_of(figure)
    offset = result.quantities["intercept"].value / result.quantities["slope"].value
    assert f"F = {1e-3 / result.quantities['slope'].value:.2f} C − {offset:.3f} (N, mS)" in written
    assert f"−{-100 * result.quantities['linearity_negative'].value:.3g} %" in written
    for part in ("95 % band", "conductance in mS", "force in N", "% of 25 N"):
        assert part in written
    assert "left out" not in written
    drawn = figure.axes[1].lines[0].get_ydata()
    np.testing.assert_allclose(drawn, [4 * step.values["force_error"] for step in result.steps], rtol=1e-12)  # 100 % / 25 N


def test_saturated_readings_are_shown_as_left_out():
    assert "saturated, left out" in text_of(ForceCalibrationFigures().figure(calibrated(converter=Converter(high=2.0))))


def test_many_sensors_have_a_line_each():
    figure = ForceCalibrationFigures().figure(calibrated(sensors=18))
    assert "lines of 18 sensors, of 20." in text_of(figure)
    assert "N/mS" in text_of(figure)
    assert "F =" not in text_of(figure)  # the lines do not pass through zero
    assert len(figure.axes[0].lines) == 36
    assert len(figure.axes[0].get_legend().get_texts()) == 3
