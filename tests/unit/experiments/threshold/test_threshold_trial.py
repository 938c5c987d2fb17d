"""Repeated thresholds: sources of the forces, errors over speed, noise and cut-off, rates, determinism, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from drawn import colliding_words, text_of
from nested_runs import every_end, pretend_to_end
from scenes import SOLVER

from tactsim.case import load_case
from tactsim.contact.annulus import Annulus
from tactsim.errors import CaseError, ConvergenceError, InputError, InvalidQuantity
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.scene import IndentationScene
from tactsim.experiments.threshold.contact_curve import ContactCurve, SensorShape
from tactsim.experiments.threshold.figures.threshold_trial import threshold_error_figure, threshold_signal_figure
from tactsim.experiments.threshold.sampling import ApproachSampling
from tactsim.experiments.threshold.source import ClosedFormSource, CurveSource, IndentationSource, RunSource
from tactsim.experiments.threshold.threshold_trial import ThresholdTrial
from tactsim.interfaces.run import Course, Findings, returned_by
from tactsim.materials.library import named_material
from tactsim.plotting import figures_for
from tactsim.results import Quantity, Result, Status, StepRecord, write_result
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.films.film import Film
from tactsim.sensors.threshold.threshold_sensor import ForceSensor, ThresholdSensor
from tactsim.sensors.threshold.threshold_trigger import TriggerLevel

ROOT = Path(__file__).parents[4]
CURVE = CurveSource(path=str(ROOT / "cases/data/annulus_icf_signals.csv"))
LAYER = ClosedFormSource(material=named_material("icf_stable").material, thickness=3e-3)


def trial(**changes):
    return ThresholdTrial(**({"source": CURVE, "speeds": (2e-3,), "noises": (1e-4,), "cutoffs": (10.0,), "trials": 10} | changes))


def run(**changes):
    return trial(**changes).run()


def grid(result, name):
    return np.array(result.quantities[name].value, dtype=float)


@pytest.fixture(scope="module")
def result():
    return run(speeds=(1e-3, 1e-2), noises=(1e-4, 1e-3), cutoffs=(5.0, 50.0), trials=20)


@pytest.fixture(scope="module")
def usual():
    return run()


def test_errors_over_speed_noise_and_cutoff(result):
    assert result.status is Status.CONVERGED
    error = grid(result, "force_error")
    assert error.shape == (2, 2, 2)
    assert (error[:, 1] > error[:, 0]).all(), "a higher noise needs a higher level, and triggers later"
    assert (grid(result, "filter_error")[1] < grid(result, "filter_error")[0]).all(), "faster lags more"
    assert (grid(result, "trigger_level")[:, :, 1] > grid(result, "trigger_level")[:, :, 0]).all(), (
        "a wide band passes more noise"
    )
    assert grid(result, "false_rate").max() == grid(result, "missed_rate").max() == 0
    force, area = result.quantities["threshold_force"].value[0], result.quantities["annular_area"].value
    np.testing.assert_allclose(grid(result, "relative_error"), error / force)
    np.testing.assert_allclose(grid(result, "pressure_error"), error / area)


def test_the_recording_and_its_capture(result):
    capture = result.scene.capture
    times = np.array([step.values["time"] for step in result.steps])
    at = int(np.searchsorted(times, capture.trigger_time))
    assert times[at] == capture.trigger_time
    assert result.steps[at].values["large_reading"] == capture.captured_force
    assert result.steps[at].values["small_reading"] > capture.trigger_level
    assert capture.trigger_time > capture.touch_time > capture.armed_time
    assert set(result.steps[0].values) == set(result.units) <= set(ThresholdTrial.history_units)


def test_figures(result):
    drawings = figures_for(result)
    assert list(drawings) == ["threshold_errors.png", "threshold_signals.png"]
    assert all(draw().startswith(b"\x89PNG") for draw in drawings.values())
    words = text_of(threshold_error_figure(result))
    for label in ("lag of the filter", "cut-off of the low pass in Hz", "mean ± standard deviation", "speed in mm/s"):
        assert label in words
    signals = threshold_signal_figure(result)
    assert "captured threshold" in text_of(signals)
    assert colliding_words(signals) == []
    assert "level of the trigger" in [text.get_text() for text in signals.axes[1].get_legend().get_texts()]
    assert not signals.axes[1].texts, "words beside the line stood on the legend"


def test_the_same_seed_gives_the_same_result(usual):
    again, other = run(), run(seed=2)
    assert usual.steps == again.steps
    assert usual.quantities == again.quantities
    assert usual.quantities["force_error"] != other.quantities["force_error"]


def test_rates_of_false_missed_and_saturated_trials_are_reported_and_drawn():
    false = run(sensor=ThresholdSensor(trigger=TriggerLevel(multiple=1.5)), noises=(1e-3,))
    assert grid(false, "false_rate")[0, 0, 0] == 1
    assert false.quantities["force_error"].value == [[[None]]]
    missed = run(sensor=ThresholdSensor(trigger=TriggerLevel(force=5.0)))
    assert grid(missed, "missed_rate")[0, 0, 0] == 1
    assert missed.scene.capture.trigger_time is None
    narrow = SignalChain(converter=Converter(low=0.0, high=0.2), low_pass=SignalChain().low_pass)
    saturated = run(sensor=ThresholdSensor(chain=narrow))
    assert grid(saturated, "saturated_rate")[0, 0, 0] == 1
    for result, words in ((false, "before the touch"), (missed, "never trigger"), (saturated, "widen its range")):
        assert any(words in warning for warning in result.warnings)
        assert set(result.plot()) == {"threshold_errors", "threshold_signals"}
    assert all(draw().startswith(b"\x89PNG") for draw in figures_for(false).values()), "of no error at all"


def test_a_threshold_below_the_resolution_is_reported(usual):
    soft = LAYER.model_copy(update={"recess": 0.2e-3})
    assert any("E27" in warning for warning in run(source=soft).warnings)
    assert not any("E27" in warning for warning in usual.warnings)


def test_a_closed_form_beyond_small_displacements_is_doubted(usual):
    """Of the curve of a simulation it is not said, however deep it goes."""
    shallow = LAYER.model_copy(update={"recess": 0.05e-3})
    doubted = [
        any("linear theory" in warning for warning in one.warnings) for one in (run(source=LAYER), run(source=shallow), usual)
    ]
    assert doubted == [True, False, False]


def test_a_viscoelastic_tissue_has_a_threshold_for_each_speed():
    atrial = ClosedFormSource(material=named_material("atrial").material, recess=0.1e-3)
    force = run(source=atrial, speeds=(1e-4, 1e-2)).quantities["threshold_force"].value
    assert force[1] > 1.05 * force[0]


def test_films_can_conduct_in_place_of_the_line(usual):
    below_zero = Converter(low=-0.1, high=4.9)
    chain = SignalChain(converter=below_zero, low_pass=SignalChain().low_pass)
    sensor = ThresholdSensor(large=ForceSensor(film=Film()), small=ForceSensor(film=Film()), chain=chain)
    outcome = run(sensor=sensor)
    assert outcome.status is Status.CONVERGED
    assert grid(outcome, "false_rate").max() == 0
    parts = [grid(outcome, f"{name}_error")[0, 0, 0] for name in ("level", "film", "filter", "sampling", "noise")]
    assert sum(parts) == pytest.approx(grid(outcome, "force_error")[0, 0, 0], rel=1e-9)
    assert parts[1] != 0
    assert grid(usual, "film_error")[0, 0, 0] == 0
    assert "film against its line" in text_of(threshold_error_figure(outcome))


def test_the_large_sensor_with_and_without_the_small_one_on_it():
    both, plate = (run(sensor=ThresholdSensor(large_bears=name)) for name in ("plate_and_small", "plate"))
    assert grid(both, "force_error") > grid(plate, "force_error")
    assert any("Fig. 3.2" in words for words in both.assumptions)


def stored(path, *, past, status=Status.CONVERGED, kind="indentation"):
    """A result of an indentation with a threshold at 1 mm and 1 N."""
    depth = np.linspace(0.1e-3, 1.4e-3, 14) if past else np.linspace(0.1e-3, 1e-3, 10)
    steps = [
        StepRecord(
            n,
            1,
            0.0,
            {
                "displacement": d,
                "reaction_force": 1e3 * d,
                "tissue_rise": min(0.8 * d, 0.8e-3),
                "sensor_force": 100 * max(d - 1e-3, 0.0),
            },
        )
        for n, d in enumerate(depth.tolist(), 1)
    ]
    reached = {"threshold_displacement": Quantity(1e-3, "m", "there")}
    body = Annulus(inner_radius=1.5e-3, outer_radius=3e-3)
    scene = IndentationScene(body=body, starting_height=0.0, recess=0.8e-3, solver=SOLVER)
    result = Result(kind=kind, status=status, reason="done", quantities=reached, steps=tuple(steps), scene=scene)
    return write_result(result, path, case_id="0" * 16, provenance={})


def test_a_run_on_disk_with_and_without_what_follows_the_touch(tmp_path):
    past, ended = (returned_by(RunSource(path=str(stored(tmp_path / str(past), past=past))).tissue()) for past in (True, False))
    assert past.threshold_displacement == ended.threshold_displacement == 1e-3
    at = np.array([0.5, 1.0, 1.1])
    plate, small = past.approach(1e-3).at(at)
    np.testing.assert_allclose(plate, 1e3 * 1e-3 * at)
    np.testing.assert_allclose(small, [0.0, 0.0, 0.01], atol=1e-12)
    plate, small = ended.approach(1e-3).at(at)
    np.testing.assert_allclose(plate, 1e3 * 1e-3 * at)
    # b / (a kappa) of the tangent stiffness of 1000 N/m, times the excess rise
    assert small[2] == pytest.approx(0.5 / 0.9814 * 1e3 * 0.8 * 0.1e-3, rel=0.01)
    assert ended.shape.area == pytest.approx(np.pi * (9 - 2.25) * 1e-6)
    for name, changes in (("failed", {"status": Status.FAILED}), ("kind", {"kind": "grasp"})):
        with pytest.raises(InputError, match="not usable"):
            returned_by(RunSource(path=str(stored(tmp_path / name, past=True, **changes))).tissue())


@every_end
def test_what_ends_the_indentation_that_is_run_first_ends_the_trial(monkeypatch, error, status, reason):
    pretend_to_end(monkeypatch, Indentation, error)
    seen = []
    ended = trial(source=IndentationSource(experiment=Indentation.example())).run(seen.append)
    own = "the indentation " if isinstance(error, ConvergenceError) else ""
    assert ended.status is status
    assert ended.reason.startswith(own + reason)
    assert [step.step for step in seen] == [1]
    assert ended.steps == ()
    assert figures_for(ended) == {}


def test_an_indentation_that_ends_before_its_threshold_ends_the_trial(monkeypatch):
    findings = Findings("too short", status=Status.FAILED)
    monkeypatch.setattr(Indentation, "begin", lambda self: Course.computed(findings))
    failed = run(source=IndentationSource(experiment=Indentation.example()))
    assert (failed.status, failed.reason) == (Status.FAILED, "the indentation too short")


def test_an_interrupted_run_keeps_the_combinations_before(monkeypatch):
    ideal, calls = ApproachSampling.ideal_error, []

    def stopped(self, *args, **kwargs):
        calls.append(args)
        if len(calls) > 6:
            raise KeyboardInterrupt
        return ideal(self, *args, **kwargs)

    monkeypatch.setattr(ApproachSampling, "ideal_error", stopped)
    result = run(speeds=(2e-3, 5e-3), cutoffs=(10.0, 20.0))
    assert result.status is Status.INTERRUPTED
    assert np.isfinite(grid(result, "force_error")).sum() == 3
    assert result.quantities["force_error"].value[1][0][1] is None
    assert all(draw().startswith(b"\x89PNG") for draw in figures_for(result).values())


HEADER = "displacement [mm], plate force [N], tissue rise [mm], small sensor force [mN]\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("displacement [mm], plate force [N]\n0, 0\n1, 1\n", "no column tissue rise"),
        (HEADER + "0, 0, 0, 0\n1, 1, 0.4, 0\n2, 2, 0.8, 0\n", "go on past the touch"),
        (HEADER + "0, 0, 0, 1\n1, 1, 0.4, 2\n2, 2, 0.8, 3\n", "begin before"),
        (HEADER + "0, 0, 0, 0\n1, -1, 0.4, 0\n2, 2, 0.8, 0\n3, 3, 0.8, 1\n", "plate force in row 2 is -1 N, negative"),
        (HEADER + "0, 0, 0, 0\n2, 1, 0.4, 0\n1, 2, 0.8, 0\n3, 3, 0.8, 1\n", "displacement in row 3 is 1 mm after 2 mm"),
        (HEADER + "0, 0, 0, 0\n1, 1, 0.8, 0\n3, 3, 0.8, 1\n", "at least 3"),
        (HEADER + "0, 0, 0, 0\n1, 1, 0.4, 0\n2, 2, 0.7, 0\n3, 3, 0.8, 1\n", "risen by 700 µm .*the recess is 800 µm"),
        (HEADER + "0, 0, 0, nan\n", "finite number"),
    ],
)
def test_bad_curves_are_refused(tmp_path, text, words):
    path = tmp_path / "curve.csv"
    path.write_text(text)
    with pytest.raises(InvalidQuantity, match=f"curve.csv.*{words}"):
        run(source=CurveSource(path=str(path)))


def test_a_curve_is_read_with_its_units(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text(HEADER + "1, 1, 0.4, 0\n1.5, 1.5, 0.6, 0\n2, 2, 0.8, 0\n3, 3, 0.8, 10\n")
    curve = returned_by(CurveSource(path=str(path)).tissue())
    assert isinstance(curve, ContactCurve)
    assert curve.shape == SensorShape(1.5e-3, 3e-3, 0.8e-3)
    assert (curve.threshold_displacement, curve.displacement[0], curve.small[-1]) == (2e-3, 0.0, 0.01)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"speeds": (0.0,)}, "greater than 0"),
        ({"speeds": ()}, "at least 1"),
        ({"noises": ()}, "at least 1"),
        ({"cutoffs": ()}, "at least 1"),
        ({"noises": (-1e-3,)}, "at least 0"),
        ({"cutoffs": (600.0,)}, "half the sampling_rate"),
        ({"cutoffs": (0.05,)}, "at least 1e-05 of the sampling_rate of 16 kHz"),
        ({"cutoffs": (20.0, 10.0)}, "cutoffs must increase"),
        ({"speeds": (1e-3, 1e-3)}, "speeds must increase"),
        ({"trials": 0}, "at least 1"),
        ({"sensor": ThresholdSensor(chain=SignalChain(low_pass=None))}, "no low pass"),
        ({"source": {"kind": "curve", "path": "x", "inner_radius": 3e-3}}, "below the outer_radius"),
        ({"source": {"kind": "closed_form", "material": "icf_stable", "thickness": 0.5e-3}}, "smaller than the thickness"),
        ({"source": {"kind": "closed_form", "material": {"set": "icf_stable", "bulk_modulus": 1e6}}}, "incompressible"),
    ],
)
def test_impossible_trials_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        trial(**changes)


def test_a_layer_too_thin_for_its_hole_and_recess_is_refused():
    """The tissue rises by 0.228 of the displacement: 0.9 mm would take 3.9 mm of a layer of 3 mm."""
    with pytest.raises(InvalidQuantity, match="base of the tissue, 3 mm thick, before it is touched; allowed: less than 684"):
        run(source=LAYER.model_copy(update={"inner_radius": 0.3e-3, "recess": 0.9e-3}))


def test_a_speed_that_takes_too_many_samples_is_refused():
    with pytest.raises(InvalidQuantity, match="press faster"):
        run(speeds=(1e-6,))


def test_noise_free_trials_still_have_a_level():
    quiet = run(noises=(0.0,))
    assert grid(quiet, "trigger_level")[0, 0, 0] == pytest.approx(5 / 2**16 / 0.2387, rel=0.05), "a step of the converter in N"
    assert grid(quiet, "noise_error")[0, 0, 0] == 0
    line = run(noises=(0.0,), sensor=ThresholdSensor(chain=SignalChain(noise=Noise(line=1e-3), low_pass=SignalChain().low_pass)))
    assert grid(line, "trigger_level")[0, 0, 0] > 2 * grid(quiet, "trigger_level")[0, 0, 0]


def test_phases_of_sampling_count_alike_for_any_number_of_trials():
    """Noise that reaches no step of the converter makes no error, whether the trials fill their blocks of ten or not."""
    level = ThresholdSensor(trigger=TriggerLevel(force=1e-3))
    few = run(noises=(1e-12,), sensor=level, trials=12)
    assert grid(few, "force_error_deviation")[0, 0, 0] > 1e-6, "the two phases differ"
    assert abs(grid(few, "noise_error")[0, 0, 0]) < 1e-12, "round-off of means of some 0.3 N"


def test_the_case_is_valid():
    experiment = load_case(ROOT / "cases/threshold_trial.yaml").experiment
    assert isinstance(experiment, ThresholdTrial)
    assert experiment.source.path == "data/annulus_icf_signals.csv"
