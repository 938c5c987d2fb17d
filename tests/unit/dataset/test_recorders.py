"""What is stored of each kind of experiment, and the sweeps that are shipped."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sweeps import Inline

from tactsim.contact.coulomb import Coulomb
from tactsim.contact.stick import Stick
from tactsim.dataset.running.computing import computed
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.drawing import drawn_specimen
from tactsim.dataset.sampling.layout import layout_of, split_of
from tactsim.dataset.sampling.settings import SweepSettings
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.arrays import FAILED
from tactsim.dataset.store.blocks import decoded
from tactsim.errors import CaseError
from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.experiments.annulus.recorder import ClosedFormRecorder
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.recorder import GraspRecorder
from tactsim.experiments.indentation.history import UNITS
from tactsim.experiments.recording import recorder_for
from tactsim.interfaces import Experiment, Recorder
from tactsim.registry import kinds
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, Status, StepRecord
from tactsim.shipped import CASES

SWEEPS = sorted(CASES.glob("sweep_*.yaml"))
ASKED = {f"sweep_{name}" for name in ("lumps", "arteries", "annulus", "rates", "closed_form")}


@pytest.mark.parametrize("path", SWEEPS, ids=lambda path: path.stem)
def test_shipped_sweeps_can_be_drawn(path: Path) -> None:
    sweep = load_sweep(path)
    layout = layout_of(sweep)
    known = {variable.name: variable for variable in layout.variables}
    assert sweep.samples >= (500 if path.stem in ASKED else 1)
    for specimen in range(4):
        for drawn in drawn_specimen(sweep, specimen):
            assert drawn.case is not None, drawn.refusal
            labels = layout.recorder.labels(drawn.case.experiment)
            assert all(np.shape(value) == known[name].sizes for name, value in labels.items())
            assert 0 <= split_of(sweep, specimen, [labels], known) < len(sweep.settings.splits.names)
    assert all(variable.unit and variable.description for variable in layout.variables)


def test_a_sweep_of_each_shipped_kind_is_there() -> None:
    assert {path.stem for path in SWEEPS} >= ASKED


@pytest.mark.parametrize("kind", ["grasp", "indentation", "indentation_3d", "timed_indentation"])
def test_a_law_without_a_coefficient_of_friction_is_not_labelled_as_frictionless(kind: str) -> None:
    experiment, recorder = kinds(Experiment)[kind].example(), recorder_for(kind, SweepSettings(samples=1), 2)
    labels = [
        recorder.labels(experiment.model_copy(update={"contact": law}))["friction"] for law in (Coulomb(friction=0.3), Stick())
    ]
    np.testing.assert_array_equal(labels, [0.3, np.nan])


def test_touches_of_the_switch_probe_are_stored() -> None:
    sweep = load_sweep(CASES / "sweep_rates.yaml")
    block = decoded(computed(sweep.text, range(3)))
    assert (block["status"] == 1).all()
    closed = block["closed_switches"].astype(int)
    assert (np.isfinite(block["switching_time"]).sum(axis=1) == closed).all()
    full = closed == 5
    np.testing.assert_allclose(block["mean_rate"][full], block["rate"][full], rtol=0.05)  # what the algorithm reads


def grasp_result(steps: int) -> tuple[Grasp, Result]:
    """A grasp that closed in some steps, the force of each taxel its number times the time."""
    experiment, taxels = Grasp.example(), np.arange(9.0).reshape(3, 3)
    times = np.arange(1, steps + 1) / steps
    units = {"time": "s", "displacement": "m", "reaction_force": "N"}
    records = [
        StepRecord(k, 3, 1e-12, {"time": t, "displacement": 1e-3 * t, "reaction_force": 5 * t}) for k, t in enumerate(times)
    ]
    quantities = {}
    for factor, side in ((1.0, "upper"), (2.0, "lower")):
        quantities[f"taxel_force_{side}"] = Quantity((factor * taxels).tolist(), "N", "")
        if steps > 1:
            history = [(factor * t * taxels).tolist() for t in times]
            quantities[f"taxel_force_{side}_history"] = Quantity(history, "N", "")
        quantities[f"gap_force_{side}"] = Quantity(0.25 if side == "upper" else 0.125, "N", "")
        quantities[f"outside_force_{side}"] = Quantity(0.5 if side == "upper" else 0.375, "N", "")
    return experiment, Result("grasp", Status.CONVERGED, "", quantities, steps=tuple(records), units=units)


def test_stored_times_closer_than_the_steps_are_refused() -> None:
    """Forces of a grasp in one step were stored at ten times, up to 62 % above those of ten steps."""
    overrides = ("sweep.samples=3", "experiment.time.steps=2")
    assert layout_of(load_sweep(CASES / "sweep_lumps.yaml", (*overrides, "sweep.times=2"))).variables
    with pytest.raises(CaseError, match=r"sweep\.times: 3: stored times are 333.33 ms apart, .*every 500 ms.*steps: 3"):
        layout_of(load_sweep(CASES / "sweep_lumps.yaml", (*overrides, "sweep.times=3")))


def pressed(kind: str, steps: int = 8, **recorded: object) -> tuple[Recorder, Experiment, Result]:
    """A recorder of an indentation, and a run whose displacement grows evenly, its force as the square of it."""
    experiment, along = kinds(Experiment)[kind].example(), np.arange(1, steps + 1) / steps
    units = {name: unit for name, unit in UNITS.items() if name in ("displacement", "reaction_force", "tissue_rise", "time")}
    values = [{"time": 2 * s, "displacement": 1e-3 * s, "reaction_force": s * s, "tissue_rise": 5e-4 * s} for s in along.tolist()]
    records = tuple(StepRecord(k, 3, 1e-12, {name: one[name] for name in units}) for k, one in enumerate(values))
    recorder = recorder_for(kind, SweepSettings.model_validate({"samples": 1, "times": 4, **recorded}))
    return recorder, experiment, Result(kind, Status.CONVERGED, "", {}, steps=records, units=units)


@pytest.mark.parametrize("kind", ["indentation", "indentation_3d", "timed_indentation"])
def test_the_curves_of_an_indentation_are_stored(kind: str) -> None:
    recorder, experiment, result = pressed(kind)
    readings = recorder.readings(experiment, result, np.random.default_rng(1))
    share = np.array([0.25, 0.5, 0.75, 1.0])
    np.testing.assert_allclose(readings["displacement_history"], 1e-3 * share, rtol=1e-12)
    np.testing.assert_allclose(readings["reaction_force_history"], share**2, rtol=1e-12)
    np.testing.assert_allclose(readings["tissue_rise_history"], 5e-4 * share, rtol=1e-12)
    declared = {variable.name: variable for variable in recorder.readings_of(experiment)}
    assert {name: np.shape(value) for name, value in readings.items()} == {name: one.sizes for name, one in declared.items()}
    timed = kind == "timed_indentation"
    assert declared["reaction_force_history"].dimensions == (("time",) if timed else ("load_step",))
    assert declared["displacement_history"].prescribed
    if timed:
        np.testing.assert_allclose(readings["time_s"], 2 * share, rtol=1e-12)


def test_the_force_of_a_timed_indentation_is_read_over_time() -> None:
    recorder, experiment, result = pressed("timed_indentation", steps=400, reading={"chain": {"sampling_rate": 200}})
    readings = recorder.readings(experiment, result, np.random.default_rng(1))
    assert {name for name in readings if name.startswith("read_force")} == {"read_force", "read_force_clean"}
    assert (np.diff(readings["read_force_clean"]) > 0).all()
    assert {one.name: one.sizes for one in recorder.readings_of(experiment)} == {name: v.shape for name, v in readings.items()}


def test_an_indentation_of_which_the_end_is_stored_has_no_curves() -> None:
    recorder, experiment, result = pressed("indentation", times=1)
    assert recorder.readings(experiment, result, np.random.default_rng(1)) == {}
    assert recorder.readings_of(experiment) == []


def test_the_curve_of_a_body_without_a_hole_holds_no_rise() -> None:
    recorder, experiment, result = pressed("indentation")
    units = {name: unit for name, unit in result.units.items() if name != "tissue_rise"}
    steps = tuple(replace(step, values={name: step.values[name] for name in units}) for step in result.steps)
    readings = recorder.readings(experiment, replace(result, steps=steps, units=units), np.random.default_rng(1))
    assert np.isnan(readings["tissue_rise_history"]).all()
    optional = {one.name for one in recorder.readings_of(experiment) if one.optional}
    assert optional == {"tissue_rise_history"}


TIMED = """\
schema: tactsim/sweep/1
experiment:
  kind: timed_indentation
  specimen: {material: atrial, thickness: {uniform: [9 mm, 11 mm]}, radius: 15 mm}
  time: {per_decade: PER_DECADE}
  loading: {control: displacement, pieces: [{kind: ramp, to: 0.1 mm, duration: 1 s}, {kind: hold, duration: 1 s}]}
sweep: {samples: 3, times: 100}
"""


def test_stored_times_of_indentations_closer_than_their_steps_are_refused_with_what_helps(tmp_path: Path) -> None:
    overrides = ("sweep.samples=3", "experiment.displacement=4 mm", "experiment.body.outer_radius=3 mm")
    with pytest.raises(CaseError, match=r"sweep\.times: 50: stored times are 80 µm apart, .*every 150 µm.*largest: 80 µm"):
        layout_of(load_sweep(CASES / "sweep_annulus.yaml", (*overrides, "sweep.times=50")))
    finer = load_sweep(CASES / "sweep_annulus.yaml", (*overrides, "sweep.times=50", "experiment.steps.largest=80 um"))
    assert layout_of(finer).named("reaction_force_history").sizes == (50,)
    (tmp_path / "sweep.yaml").write_text(TIMED.replace("PER_DECADE", "5"), encoding="utf-8")
    with pytest.raises(CaseError, match=r"stored times are 20 ms apart, .*every 50 ms.*time.per_decade: 114"):
        layout_of(load_sweep(tmp_path / "sweep.yaml"))
    (tmp_path / "sweep.yaml").write_text(TIMED.replace("PER_DECADE", "114"), encoding="utf-8")
    assert layout_of(load_sweep(tmp_path / "sweep.yaml")).named("time_s").sizes == (100,)


def test_stored_times_under_a_jump_alone_are_held_against_no_steps(tmp_path: Path) -> None:
    """It ended in a division by zero."""
    jump = "{kind: jump, to: 0.1 mm, duration: 2 s}"
    pieces = "{kind: ramp, to: 0.1 mm, duration: 1 s}, {kind: hold, duration: 1 s}"
    text = TIMED.replace("PER_DECADE", "5").replace(pieces, jump)
    assert jump in text
    (tmp_path / "sweep.yaml").write_text(text, encoding="utf-8")
    assert layout_of(load_sweep(tmp_path / "sweep.yaml")).named("time_s").sizes == (100,)


def test_the_closed_form_is_stored_as_it_is_between_its_points() -> None:
    few, many = (ClosedForm.example().model_copy(update={"points": points}) for points in (4, 2000))
    recorder = ClosedFormRecorder(settings=SweepSettings(samples=1, times=24))
    one, other = (recorder.readings(form, form.run(), np.random.default_rng(1)) for form in (few, many))
    since = np.maximum(0.0, one["time_s"] - 2.0)
    np.testing.assert_allclose(one["force"], 0.2 + 0.2 * np.sin(2 * np.pi * since), rtol=0, atol=1e-12)
    np.testing.assert_allclose(one["displacement"], other["displacement"], rtol=1e-12)


@pytest.mark.parametrize("steps", [1, 4, 7])
def test_taxels_are_stored_at_even_times_whatever_the_steps(steps: int) -> None:
    experiment, result = grasp_result(steps)
    recorder = GraspRecorder(settings=SweepSettings(samples=1, times=5))
    readings = recorder.readings(experiment, result, np.random.default_rng(1))
    np.testing.assert_allclose(readings["time_s"], [0.2, 0.4, 0.6, 0.8, 1.0], rtol=1e-12)
    expected = readings["time_s"][:, None, None, None] * np.arange(9.0).reshape(3, 3) * np.array([1.0, 2.0])[:, None, None]
    np.testing.assert_allclose(readings["taxel_force"], expected, rtol=1e-12)  # linear histories are met to round-off
    np.testing.assert_allclose(readings["taxel_pressure"], expected / experiment.matrix.area, rtol=1e-12)
    np.testing.assert_allclose(readings["displacement"], 1e-3 * readings["time_s"], rtol=1e-12)
    assert readings["gap_force"].tolist() == [0.25, 0.125]
    assert readings["outside_force"].tolist() == [0.5, 0.375]
    sizes = {variable.name: variable.sizes for variable in recorder.readings_of(experiment)}
    assert {name: np.shape(value) for name, value in readings.items()} == sizes


def test_what_is_stored_is_that_at_the_end_and_not_before() -> None:
    experiment, result = grasp_result(4)
    last = GraspRecorder(settings=SweepSettings(samples=1)).readings(experiment, result, np.random.default_rng(1))["taxel_force"]
    assert last[0, 0, 2, 2] == pytest.approx(8.0, rel=1e-12)


def test_a_lump_of_the_tissues_own_material_is_none() -> None:
    sweep = load_sweep(CASES / "sweep_lumps.yaml")
    layout = layout_of(sweep)
    counts, options = [], []
    for specimen in range(40):
        drawn = drawn_specimen(sweep, specimen)[0]
        labels = layout.recorder.labels(drawn.case.experiment)  # type: ignore[union-attr]
        counts.append(int(labels["inclusion_count"]))
        options.append(drawn.values["experiment", "inclusions", 0, "material"])
        if counts[-1] == 0:
            assert labels["inclusion_kind"][0] == 0
            assert np.isnan(labels["inclusion_radius"][0])
        else:
            center, radius = labels["inclusion_center"][0], labels["inclusion_radius"][0]
            assert labels["inclusion_depth"][0] == pytest.approx(20e-3 - center[2] - radius, abs=1e-9)
    assert [count == 0 for count in counts] == [option == 1 for option in options]
    assert 1 <= counts.count(0) <= 12


@pytest.mark.slow
def test_a_grasp_is_stored_with_clean_and_noisy_readings() -> None:
    smaller = ("experiment.matrix.rows=2", "experiment.mesh={kind: structured, cells: [10, 10, 6]}")
    block = decoded(computed(load_sweep(CASES / "sweep_lumps.yaml", smaller).text, [0]))
    assert block["status"].tolist() == [1], block["reason"]
    assert block["taxel_force"].shape == (1, 1, 2, 2, 3)
    total = block["taxel_force"][0, 0].sum(axis=(1, 2)) + block["gap_force"][0] + block["outside_force"][0]
    np.testing.assert_allclose(total[0], block["reaction_force"][0, 0], rtol=1e-8)
    assert np.corrcoef(block["taxel_force"].ravel(), block["read_force"].ravel())[0, 1] > 0.95
    assert json.dumps(block["reason"].tolist()) == '["end of the history"]'


def test_a_sample_that_takes_longer_than_it_may_is_marked_failed() -> None:
    sweep = load_sweep(CASES / "sweep_lumps.yaml", ("sweep.samples=3", "sweep.time_limit=1 us"))
    block = decoded(computed(sweep.text, [0]))
    assert block["status"].tolist() == [FAILED]
    assert block["reason"].tolist() == ["failed: took longer than the 1e-06 s that it was given"]
    assert np.isfinite(block["inclusion_radius"][0, 0])


@pytest.mark.parametrize("defect", [LookupError, AttributeError, TypeError, AssertionError])
def test_a_defect_of_a_kind_is_the_reason_of_its_sample_with_the_line_at_which_it_arose(
    defect: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def begin(self: ClosedForm) -> None:
        raise defect("no such spring")

    monkeypatch.setattr(ClosedForm, "begin", begin)
    block = decoded(computed(load_sweep(CASES / "sweep_closed_form.yaml", ("sweep.samples=1",)).text, [0]))
    assert block["status"].tolist() == [FAILED]
    line = begin.__code__.co_firstlineno + 1
    assert block["reason"].tolist() == [f"{defect.__name__}: no such spring; from line {line} of {__name__}"]


def test_samples_for_which_the_time_did_not_suffice_are_computed_again_with_more_of_it(tmp_path: Path) -> None:
    again = {}
    for limit in ("1 us", "2 us", "1 us"):
        sweep = load_sweep(CASES / "sweep_lumps.yaml", ("sweep.samples=3", f"sweep.time_limit={limit}"))
        with opened_run(sweep, tmp_path / "s.zarr", resume=bool(again)) as going:
            going.compute(Inline(sweep), lambda tally: None)
        again[limit] = going.tally.retried
    assert again == {"1 us": 0, "2 us": 3}


def test_the_pressure_in_an_artery_is_a_label() -> None:
    sweep = load_sweep(CASES / "sweep_arteries.yaml", ("experiment.inclusions.weights=[1,0,0,0,0]", "sweep.samples=3"))
    drawn = drawn_specimen(sweep, 0)[0]
    labels = layout_of(sweep).recorder.labels(drawn.case.experiment)
    pressure = drawn.case.experiment.inclusions[0].lumen.pieces[0].to
    np.testing.assert_allclose(labels["inclusion_lumen_pressure"], [pressure, np.nan])
    assert 8e3 < pressure < 16e3
