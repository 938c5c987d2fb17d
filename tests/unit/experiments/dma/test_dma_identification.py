"""The experiment: what it reports, from synthetic data and from a file, and how it ends when it is stopped."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import text_of

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.case import load_case
from tactsim.errors import CaseError, ConvergenceError, StorageError
from tactsim.experiments.dma import dma_identification
from tactsim.experiments.dma.dma_identification import DmaIdentification
from tactsim.experiments.dma.figures.dma_identification import dma_identification_figure
from tactsim.experiments.dma.figures.signals import signals_figure
from tactsim.experiments.dma.source import MeasuredDma, SignalsDma, SignalsTest, SyntheticDma, SyntheticSignals
from tactsim.identification.dma_data import synthetic_dma
from tactsim.plotting import figures_for
from tactsim.results import Status
from tactsim.results.document import document_text
from tactsim.results.writing import history_table

QUICK = {"population": 40, "generations": 30}


@pytest.fixture(scope="module")
def result():
    steps = []
    outcome = DmaIdentification(**QUICK).run(steps.append)
    assert tuple(steps) == outcome.steps
    return outcome


def test_constants_errors_and_the_statement_are_reported(result):
    assert result.status is Status.CONVERGED
    quantities = result.quantities
    assert quantities["moduli"].value.shape == quantities["genetic_retardation_times"].value.shape == (8,)
    assert quantities["least_squares_band_width"].value < 0.08
    assert quantities["least_objective"].value <= quantities["genetic_objective"].value
    assert quantities["least_squares_weighted_squares"].value < quantities["genetic_weighted_squares"].value
    assert any("trust the curves" in warning for warning in result.warnings)
    assert any("search longer" in warning for warning in result.warnings)
    assert any("not printed" in assumption for assumption in result.assumptions)
    assert result.scene.fits["least_squares"].true_curves_inside_band is True
    assert set(result.scene.fits["least_squares"].told) >= {"e_0", "e_8", "tau_8"}


def test_history_holds_the_curves_and_the_data_at_their_frequencies(result):
    measured = [step for step in result.steps if "measured_elastic_compliance" in step.values]
    assert [step.values["frequency"] for step in measured] == [1, 6, 11, 16, 21, 26, 31, 36]
    for step in result.steps:
        assert set(step.values) <= set(DmaIdentification.history_units)
        values = step.values
        for name in ("least_squares_elastic_compliance", "genetic_viscous_compliance"):
            assert values[f"{name}_lower"] < values[name] < values[f"{name}_upper"]
    assert "least_squares_elastic_compliance_lower [1/Pa]" in history_table(result)
    assert "null" not in document_text(result, "case")


def test_figure(result):
    drawings = figures_for(result)
    assert list(drawings) == ["dma_identification.png"]
    assert drawings["dma_identification.png"]().startswith(b"\x89PNG")
    text_ = text_of(dma_identification_figure(result))
    assert "synthetic data" in text_
    for words in ("elastic compliance", "95 % band, simultaneous", "genetic algorithm", "combinations of the 17 constants"):
        assert words in text_


def test_the_same_seeds_give_the_same_result(result):
    again = DmaIdentification(**QUICK).run()
    assert again.steps == result.steps


def test_data_from_a_file_with_unknown_noise(tmp_path):
    data = synthetic_dma(SyntheticDma().model, noise=0.02, seed=1)
    path = tmp_path / "dma.csv"
    rows = np.column_stack([data.frequencies, data.modulus.real, data.modulus.imag])
    header = "frequency [Hz], storage modulus [Pa], loss modulus [Pa]"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.17g")
    outcome = DmaIdentification(data=MeasuredDma(path=str(path)), methods=("least_squares",), replicates=100).run()
    assert outcome.status is Status.CONVERGED
    assert 0.008 < outcome.quantities["relative_noise"].value < 0.035
    assert "least_squares_curve_error" not in outcome.quantities
    assert not any("synthetic" in assumption for assumption in outcome.assumptions)
    with pytest.raises(StorageError):
        DmaIdentification(data=MeasuredDma(path=str(tmp_path / "none.csv"))).run()


@pytest.mark.parametrize(
    ("frequencies", "noise", "given", "doubted"),
    [
        ((1.0, 6.0, 11.0), 0.02, None, True),  # six positive compliances follow six numbers, noise and all
        ((1.0, 6.0, 11.0), 0.0, None, True),  # one number is left, but not in every replicate: the band is infinite
        ((1.0, 6.0, 11.0), 0.02, 0.02, False),
        ((1.0, 6.0, 11.0, 16.0, 21.0, 26.0, 31.0, 36.0), 0.02, None, False),
    ],
)
def test_data_too_few_to_judge_their_noise_by_are_said_to_be(tmp_path, frequencies, noise, given, doubted):
    tissue = GeneralizedKelvin(1e-5, [2e-5, 3e-5], [0.02, 0.1])
    modulus = synthetic_dma(tissue, frequencies, noise=noise, seed=0).modulus
    table = tmp_path / "few.csv"
    rows = zip(frequencies, modulus.real.tolist(), modulus.imag.tolist(), strict=True)
    header = "frequency [Hz], storage modulus [Pa], loss modulus [Pa]"
    table.write_text("\n".join([header, *(f"{f!r}, {storage!r}, {loss!r}" for f, storage, loss in rows)]))
    data = MeasuredDma(path=str(table), noise=given)
    reported = DmaIdentification(data=data, methods=("least_squares",), units=2, replicates=60).run()
    assert any("too little to estimate their noise by" in warning for warning in reported.warnings) == doubted


@pytest.mark.parametrize(
    ("error", "status"), [(KeyboardInterrupt(), Status.INTERRUPTED), (ConvergenceError("no luck"), Status.FAILED)]
)
def test_the_fits_made_before_a_stop_are_kept(monkeypatch, error, status):
    def stopped(*args, **kwargs):
        raise error

    monkeypatch.setattr(dma_identification, "fit_genetic", stopped)
    outcome = DmaIdentification(replicates=50, **QUICK).run()
    assert outcome.status is status
    assert "moduli" in outcome.quantities
    assert "genetic_moduli" not in outcome.quantities
    assert str(status).upper() in text_of(dma_identification_figure(outcome))
    nothing = DmaIdentification(methods=("genetic",), **QUICK).run()
    assert nothing.status is status
    assert nothing.steps == ()
    assert figures_for(nothing) == {}


@pytest.mark.parametrize(
    "changes",
    [
        {"methods": ()},
        {"methods": ("genetic", "genetic")},
        {"methods": ("guess",)},
        {"units": 0},
        {"data": {"kind": "synthetic", "frequencies": (1.0, 3.0, 2.0)}},
        {"data": {"kind": "synthetic", "frequencies": (1.0, 3.0)}},
        {"data": {"kind": "synthetic", "noise": -0.1}},
        {"data": {"kind": "guess"}},
        {"confidence": 1.0},
    ],
)
def test_bad_settings_are_refused(changes):
    with pytest.raises(CaseError):
        DmaIdentification(**changes)


def test_the_case_is_valid(request):
    experiment = load_case(request.config.rootpath / "cases/dma_atrial.yaml").experiment
    assert experiment == DmaIdentification()


def test_raw_signals_give_the_same_fit_as_their_moduli(tmp_path):
    tests, area, height, swing = [], 80e-6, 5e-3, 0.05e-3
    for frequency in (1.0, 6.0, 16.0, 36.0):
        angle = 2 * np.pi * frequency * (time := np.arange(0, 5 / frequency, 1 / (50 * frequency)))
        modulus = 1 / table_4_1().complex_compliance(np.array([2 * np.pi * frequency]))[0]
        load = abs(modulus) * swing / height * area * np.sin(angle + np.angle(modulus)) + 0.01 + 0.001 * time
        columns = np.column_stack([time, load, 1e3 * swing * np.sin(angle) + 0.1])
        path = tmp_path / f"{frequency:g}.csv"
        np.savetxt(path, columns, delimiter=",", header="time [s],load [N],displacement [mm]", comments="", fmt="%.16g")
        tests.append(SignalsTest(path=str(path), frequency=frequency))
    measured = SignalsDma(tests=tuple(tests), area=area, height=height).measured()
    expected = table_4_1().complex_compliance(2 * np.pi * measured.frequencies)
    np.testing.assert_allclose(measured.compliance, expected, rtol=1e-9, err_msg="exact sines, offset and drift")
    assert not np.allclose(SignalsDma(tests=tuple(tests), area=2 * area, height=height).measured().compliance, expected, rtol=0.1)


def test_a_case_of_signals(request):
    experiment = load_case(request.config.rootpath / "cases/dma_signals.yaml").experiment
    outcome = experiment.model_copy(update={"replicates": 100}).run()
    assert outcome.status is Status.CONVERGED
    modulus = 1 / table_4_1().complex_compliance(2 * np.pi * np.array(outcome.scene.data_frequencies))
    for name, true in (("storage", modulus.real), ("loss", modulus.imag)):
        error, value = (outcome.quantities[f"{name}_modulus{end}"].numbers for end in ("_error", ""))
        assert np.abs((value - true) / error).max() < 3.5  # of eight numbers with a fixed seed
        assert (error < 0.03 * true).all()
    assert outcome.quantities["loss_tangent"].numbers == pytest.approx(modulus.imag / modulus.real, rel=0.03)
    assert any("signals of Table 4.1" in words for words in outcome.assumptions)
    assert not any("correlated residuals" in words for words in outcome.warnings)
    drawings = figures_for(outcome)
    assert list(drawings) == ["dma_identification.png", "dma_signals.png"]
    words = text_of(signals_figure(outcome))
    assert "Synthetic signals (points) and their fits (lines)" in words
    for label in ("1 Hz: the displacement lags by 73", "36 Hz", "loss tangent"):
        assert label in words


def test_signals_of_a_specimen_that_still_creeps_carry_a_warning():
    data = SyntheticSignals(hold=2.0, precycles=0.0, noise=0.002)
    outcome = DmaIdentification(data=data, methods=("least_squares",), replicates=50).run()
    assert any("correlated residuals at" in words for words in outcome.warnings)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"kind": "signals", "area": 1e-4, "height": 1e-3}, "give either tests"),
        ({"kind": "synthetic_signals", "amplitude": 1.0}, "let go"),
        ({"kind": "synthetic_signals", "frequencies": (3.0, 2.0, 1.0)}, "frequencies"),
    ],
)
def test_bad_signals_are_refused(data, words):
    with pytest.raises(CaseError, match=words):
        DmaIdentification(data=data)


UNITS = [(1, 0.02, True), (2, 0.02, False), (2, 1e-8, True), (8, 1e-8, False)]
SEARCHED = [pytest.param("genetic", *row, marks=[] if row[0] == 2 else pytest.mark.slow) for row in UNITS]


@pytest.mark.parametrize(("method", "units", "noise", "doubted"), [*(("least_squares", *row) for row in UNITS), *SEARCHED])
def test_units_that_leave_more_than_the_noise_are_doubted(method, units, noise, doubted):
    """The logarithms of the eight times of the model scatter by 0.003 and 0.008 around two: two units at the means are off by
    about half the squares of that, less what their constants make up for."""
    data = SyntheticDma(times="retardation_times", noise=noise)
    reported = DmaIdentification(data=data, units=units, methods=(method,), replicates=50, **QUICK).run()
    assert any("not describe the data" in warning for warning in reported.warnings) == doubted
