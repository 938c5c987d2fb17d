"""The examples run, on data sets made up in a few seconds."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
import zarr
from sweeps import run_sweep

from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.opening import Store
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, Status, StepRecord

ROOT = Path(__file__).parents[1]
EXAMPLE = str(ROOT / "examples" / "train_lump_position.py")
SAMPLES = 200


def felt(experiment: Grasp) -> np.ndarray:
    """Forces (jaw, row, column) in N of a stand-in for the solver: each lump adds to the taxels near it."""
    centers = np.array([5e-3, 15e-3, 25e-3]) + 5e-3
    x, y = np.meshgrid(centers, centers)
    force = np.full((2, 3, 3), 1e3 * experiment.loading.least_and_most()[1])
    for one in experiment.inclusions:
        place, radius = np.array(one.shape.center), one.shape.radius
        for jaw, depth in enumerate((20e-3 - place[2], place[2])):
            near = np.sqrt((x - place[0]) ** 2 + (y - place[1]) ** 2 + depth**2)
            force[jaw] *= 1 + (one.material != experiment.block.tissue) * 2 * radius / near
    return force


def pretended_run(experiment: Grasp, progress: None, *, time_limit: float | None) -> Result:
    """A result with what the data set reads."""
    force, noise = felt(experiment), np.random.default_rng(experiment.readout.seed).normal(0, 1e-3, (2, 3, 3))  # type: ignore[union-attr]
    units = {"time": "s", "displacement": "m", "reaction_force": "N"}
    quantities = {"readout_time": Quantity([1.0], "s", "")}
    for jaw, side in enumerate(JAWS):
        quantities[f"taxel_force_{side}"] = Quantity(force[jaw].tolist(), "N", "")
        quantities[f"read_force_{side}_history"] = Quantity([(force + noise)[jaw].tolist()], "N", "")
        quantities[f"voltage_{side}_history"] = Quantity([(force + noise)[jaw].tolist()], "V", "")
        quantities |= {f"{part}_force_{side}": Quantity(0.0, "N", "") for part in ("gap", "outside")}
    for name, unit in (("max_penetration", "m"), ("min_volume_ratio", "1"), ("unstable_volume_fraction", "1")):
        quantities[name] = Quantity(0.0, unit, "")
    step = StepRecord(0, 1, 0.0, {"time": 1.0, "displacement": 1e-3, "reaction_force": 1.0})
    return Result("grasp", Status.CONVERGED, "", quantities, steps=(step,), units=units)


@pytest.fixture(scope="module")
def grasps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of the shipped sweep with the stand-in for the solver."""
    folder = tmp_path_factory.mktemp("grasps")
    text = (ROOT / "cases" / "sweep_lumps.yaml").read_text(encoding="utf-8")
    head, _, tail = text.partition("  samples_per_specimen")
    (folder / "sweep.yaml").write_text(head + "  seed: 1" + tail.partition("  seed: 1")[2], encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Grasp, "run", pretended_run)
        run_sweep(load_sweep(folder / "sweep.yaml", samples=SAMPLES), folder / "lumps.zarr")
    assert (Store.open(folder / "lumps.zarr").read("status") == 1).all()
    return folder / "lumps.zarr"


def errors_in(answer: str) -> dict[str, float]:
    """What the example prints."""
    return {name: float(value) for name, value in (line.split() for line in answer.splitlines())}


def run_here(store: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Exit code of the example as a program, in this process, which has loaded what it needs and takes warnings for errors."""
    monkeypatch.setattr(sys, "argv", [EXAMPLE, str(store)])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(EXAMPLE, run_name="__main__")
    return int(ended.value.code)  # type: ignore[arg-type]


def test_lumps_are_found_better_than_by_guessing(
    grasps: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_here(grasps, monkeypatch) == 0
    errors = errors_in(capsys.readouterr().out)
    assert errors["test_samples"] >= 10
    assert errors["lateral_error_mm"] < 0.6 * errors["trivial_lateral_error_mm"]  # forces that follow the lump show where it is
    assert errors["error_mm"] < 0.7 * errors["trivial_error_mm"]


def test_forces_of_other_lumps_show_nothing(
    grasps: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The twin: with the readings dealt anew among the samples, nothing can be learned."""
    store = Store.open(grasps, writing=True)
    kept = store.read("read_force")
    store.group["read_force"][...] = np.random.default_rng(1).permutation(kept)
    try:
        assert run_here(grasps, monkeypatch) == 0
    finally:
        store.group["read_force"][...] = kept
    errors = errors_in(capsys.readouterr().out)
    assert errors["error_mm"] > 0.9 * errors["trivial_error_mm"]


def test_too_few_samples_are_reported(
    grasps: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_here(tmp_path, monkeypatch) == 5
    assert "holds no zarr.json" in capsys.readouterr().err
    kept = Store.open(grasps).read("split")
    with zarr.config.set({"array.write_empty_chunks": True}):  # a missing file would be a hole
        split = zarr.open_group(grasps, mode="r+")["split"]
        split[...] = np.zeros_like(kept)
        try:
            assert run_here(grasps, monkeypatch) == 2
        finally:
            split[...] = kept
    assert "test: 0 samples with one lump" in capsys.readouterr().err
