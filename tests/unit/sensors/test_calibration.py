"""Calibration line and scatter of the channels: the line of the thesis, both ways, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.sensors.electronics.calibration import THESIS_LINE, LinearCalibration
from tactsim.sensors.electronics.channel_scatter import ChannelScatter
from tactsim.sensors.electronics.signal_chain import SignalChain


def test_the_line_of_the_thesis():
    assert THESIS_LINE.force(np.array([0.0, 1e-3])) == pytest.approx([-0.132, 20.94 - 0.132])
    assert 1 / THESIS_LINE.conductance(np.array([1.0, 25.0])) == pytest.approx([18.5e3, 0.83e3], rel=5e-3)
    force = np.linspace(0, 25, 30).reshape(3, 10)
    np.testing.assert_allclose(THESIS_LINE.force(THESIS_LINE.conductance(force)), force, atol=1e-13)
    through_zero = LinearCalibration(slope=THESIS_LINE.slope)
    assert not np.allclose(through_zero.force(THESIS_LINE.conductance(force)), force, atol=1e-13), "the intercept counts"


def test_force_from_voltage_is_equation_2_2_1():
    chain, line = SignalChain(load_resistor=2.2e3), LinearCalibration(slope=3e-5, intercept=-1e-6)
    voltage = np.array([0.01, 0.5, 2.0, 4.5])
    printed = 1 / ((chain.supply / voltage - 1) * chain.load_resistor * line.slope) - line.intercept / line.slope
    np.testing.assert_allclose(line.force(chain.conductance(voltage)), printed, rtol=1e-12)
    assert line.force(chain.conductance(np.array(0.0))) == pytest.approx(1 / 30)


def test_a_line_below_zero_does_not_conduct_there():
    line = LinearCalibration(slope=1e-3, intercept=-1e-3)
    assert line.conductance(np.array([0.0, 0.5, 2.0])) == pytest.approx([0.0, 0.0, 1e-3])


@pytest.mark.parametrize("bad", [-1e-3, np.nan, np.inf])
def test_bad_forces_and_conductances_are_refused(bad):
    with pytest.raises(InvalidQuantity, match="1 of 2 forces are not usable"):
        THESIS_LINE.conductance(np.array([1.0, bad]))
    if not np.isfinite(bad):
        with pytest.raises(InvalidQuantity, match="1 of 2 conductances are not finite"):
            THESIS_LINE.force(np.array([1.0, bad]))


@pytest.mark.parametrize("slope", [0.0, -1e-5, float("nan")])
def test_a_line_that_does_not_rise_is_refused(slope):
    with pytest.raises(CaseError):
        LinearCalibration(slope=slope)
    assert LinearCalibration.model_validate({"slope": "0.05 mS/N"}).slope == pytest.approx(5e-5)


@pytest.mark.parametrize("line", [THESIS_LINE, LinearCalibration(slope=1e-5, intercept=-3e-5)])
def test_scatter_has_the_stated_force_error_at_full_scale(line):
    scatter = ChannelScatter(full_scale=20.0)
    gains = scatter.gains((200, 100), line)
    read = line.force(gains * line.conductance(np.array(20.0)))
    assert (read - 20.0).std() == pytest.approx(0.025 * 20.0, rel=0.025)  # 20 000 channels: five standard errors
    assert abs((read - 20.0).mean()) < 5 * 0.5 / np.sqrt(20_000)


def test_scatter_repeats_with_its_seed():
    matrices = ChannelScatter(seed=3).gains((2, 3, 3), THESIS_LINE)
    assert matrices.shape == (2, 3, 3)
    np.testing.assert_array_equal(matrices, ChannelScatter(seed=3).gains((2, 3, 3), THESIS_LINE))
    assert (matrices != ChannelScatter(seed=4).gains((2, 3, 3), THESIS_LINE)).all()
    assert (ChannelScatter(repeatability=0.0).gains((2, 3, 3), THESIS_LINE) == 1).all()


def test_impossible_scatter_is_refused():
    with pytest.raises(InvalidQuantity, match="does not conduct at the full scale"):
        ChannelScatter(full_scale=1.0).gains((2,), LinearCalibration(slope=1e-5, intercept=-2e-5))
    with pytest.raises(InvalidQuantity, match="makes a gain negative"):
        ChannelScatter(full_scale=1.0).gains((100,), LinearCalibration(slope=1e-5, intercept=-0.99e-5))
    for changes in ({"repeatability": 0.2}, {"full_scale": 0.0}, {"seed": -1}):
        with pytest.raises(CaseError):
            ChannelScatter(**changes)
