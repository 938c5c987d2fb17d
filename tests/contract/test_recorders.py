"""Every registered recorder: units, sizes as declared, readings of a run where the example is quick."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tactsim.dataset.sampling.settings import SweepSettings
from tactsim.experiments.recording import numbers, recorder_for, variables
from tactsim.interfaces import Experiment, Recorder
from tactsim.registry import kinds
from tactsim.units import is_unit

RECORDERS = kinds(Recorder)
LONG = {"indentation", "indentation_3d", "timed_indentation"}
"""Runs of many seconds; tests/unit/dataset holds what is stored of them."""


@pytest.mark.parametrize("kind", sorted(RECORDERS))
def test_variables_have_units_and_one_name_each(kind: str) -> None:
    recorder, experiment = recorder_for(kind, SweepSettings(samples=1), 2), kinds(Experiment)[kind].example()
    declared = variables(recorder, experiment)
    assert {one.role for one in declared} <= {"label", "reading"}
    assert len({one.name for one in declared}) == len(declared)
    for one in declared:
        assert one.unit == "1" or is_unit(one.unit), one.name
        assert one.description
        assert len(one.dimensions) == len(one.sizes)
        assert one.empty(3).shape == (3, *one.sizes)
    assert recorder.describe()


@pytest.mark.parametrize("kind", sorted(RECORDERS))
def test_labels_have_the_sizes_and_units_that_are_declared(kind: str) -> None:
    recorder, experiment = recorder_for(kind, SweepSettings(samples=1), 2), kinds(Experiment)[kind].example()
    declared = {one.name: one.sizes for one in recorder.labels_of(experiment)}
    assert {name: np.shape(value) for name, value in recorder.labels(experiment).items()} == declared


@pytest.mark.parametrize("kind", sorted(set(RECORDERS) - LONG))
def test_readings_of_a_run_have_the_sizes_that_are_declared(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    experiment = kinds(Experiment)[kind].example()
    settings = SweepSettings(samples=1, times=3 if RECORDERS[kind].histories else 1)
    recorder = recorder_for(kind, settings, 2)
    result = experiment.run(lambda step: None)
    sample = recorder.readings(experiment, result, np.random.default_rng(1)) | numbers(recorder, result)
    declared = {one.name: one for one in variables(recorder, experiment) if one.role == "reading"}
    assert set(sample) == set(declared)
    for name, values in sample.items():
        assert np.shape(values) == declared[name].sizes, name
        assert declared[name].optional or np.isfinite(np.asarray(values, dtype=float)).all(), name
