"""Small made-up results, data sets and streams for the tests of the live page."""

from __future__ import annotations

import atexit
import itertools
import json
import shutil
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
from scenes import grasp_scene
from sweeps import run_sweep

from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.arrays import PENDING
from tactsim.dataset.store.opening import Store
from tactsim.errors import ConvergenceError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.recorder import GraspRecorder
from tactsim.experiments.grasp.scene import SimulatedGrasp, grasp_fields
from tactsim.experiments.localization.scene import EstimatedShape, LocalizedGrasp
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.results import Quantity, Result, Status, StepRecord, write_result

SIZE = (40e-3, 40e-3, 20e-3)
CLOSING = 1e-3
TITLE = "A made-up <b>grasp</b>"
SWEEP = """\
schema: tactsim/sweep/1
title: Made-up lumps
experiment:
  kind: grasp
  block: {size: [40 mm, 40 mm, 20 mm], tissue: icf_stable}
  inclusions:
    - shape: {kind: sphere, center: [20 mm, 20 mm, {uniform: [8 mm, 12 mm]}], radius: 4 mm}
      material: lump
  matrix: {rows: 3, columns: 3, pitch: 10 mm, size: 9 mm}
  loading: {control: displacement, pieces: [{kind: ramp, to: 1 mm, duration: 1 s}]}
  mesh: {kind: layers, size: 6 mm}
sweep: {samples: 6, times: 1, splits: {train: 0.5, validation: 0.25}}
"""


def taxel_forces(steps: int = 4, count: int = 3, *, lump: float = 0.5, place: tuple[float, float] = (3e-3, -2e-3)) -> np.ndarray:
    """Forces (step, jaw, row, column) in N that rise to a bump over a lump nearer to the upper jaw."""
    layout = TaxelLayout(rows=count, columns=count, pitch=30e-3 / count, size=27e-3 / count)
    x, y = (layout.borders(along).mean(axis=1) for along in "xy")
    bump = np.exp(-((x[None] - place[0]) ** 2 + (y[:, None] - place[1]) ** 2) / 8e-3**2)
    last = 0.1 + lump * np.stack([bump, 0.6 * bump])
    return np.linspace(1 / steps, 1, steps)[:, None, None, None] * last


def resized(result: Result, factors: tuple[float, float, float]) -> Result:
    """The same forces on a block, with its taxels and jaws, that is so much longer along each side."""
    scene = result.scene_as(SimulatedGrasp)
    wide, deep, high = factors
    layout = TaxelLayout(rows=scene.matrix.rows, columns=scene.matrix.columns, pitch=wide * scene.matrix.pitch, size=wide * 9e-3)
    ball = Sphere(center=(23e-3 * wide, 18e-3 * deep, 12e-3 * high), radius=4e-3 * min(factors))
    size = [side * factor for side, factor in zip(SIZE, factors, strict=True)]
    jaws = {"width": 50e-3 * wide, "depth": 50e-3 * deep, "fillet": 1e-3 * min(factors)}
    return replace(result, scene=grasp_scene(size, layout, [ball], closing=CLOSING * high, **jaws))


def made_up_grasp(forces: np.ndarray | None = None, *, lump: bool = True, title: str = TITLE, **jaws: float) -> Result:
    """The result of a grasp with these forces (step, jaw, row, column) in N, closed by 1 mm in 1 s, with fields of ``jaws``."""
    given = taxel_forces() if forces is None else forces
    steps, count = len(given), given.shape[-1]
    layout = TaxelLayout(rows=count, columns=count, pitch=30e-3 / count, size=27e-3 / count)
    course = np.linspace(1 / steps, 1, steps)
    quantities = {"displacement": Quantity(CLOSING, "m", ""), "time": Quantity(1.0, "s", "")}
    for jaw, side in enumerate(JAWS):
        quantities[f"taxel_force_{side}"] = Quantity(given[-1, jaw].tolist(), "N", "")
        if steps > 1:
            quantities[f"taxel_force_{side}_history"] = Quantity(given[:, jaw].tolist(), "N", "")
    if steps > 1:
        quantities["time_history"] = Quantity(course.tolist(), "s", "")
        quantities["displacement_history"] = Quantity((CLOSING * course).tolist(), "m", "")
    ball = Sphere(center=(23e-3, 18e-3, 12e-3), radius=4e-3)
    return Result(
        kind="grasp",
        status=Status.CONVERGED,
        reason="done",
        quantities=quantities,
        steps=(StepRecord(1, 1, 0.0, {"displacement": CLOSING}),),
        units={"displacement": "m"},
        title=title,
        scene=grasp_scene(SIZE, layout, [ball] if lump else [], closing=CLOSING, **jaws),
    )


def grasp_folder(place: Path, forces: np.ndarray | None = None, **options: object) -> Path:
    """The folder of such a result."""
    return write_result(made_up_grasp(forces, **options), place, case_id="abc", provenance={})  # type: ignore[arg-type]


def localized_folder(place: Path) -> Path:
    """The folder of a localization that found a ball and a tube, how far off is known of the first."""
    grasp = made_up_grasp(taxel_forces(1))
    ball = EstimatedShape(kind="sphere", center=(0.023, 0.017, 0.012), radius=4e-3)
    tube = EstimatedShape(kind="tube", center=(0.02, 0.02, 0.01), radius=3e-3, line=((0, 0.02, 0.01), (0.04, 0.02, 0.01)))
    deviations = {"center_deviation": [1e-3, 2e-3, 3e-3], "radius_deviation": 4e-4, "contrast_deviation": 0.1}
    quantities = grasp.quantities | {name: Quantity(value, "m", "") for name, value in deviations.items()}
    known = grasp_fields(grasp.scene_as(SimulatedGrasp))
    scene = LocalizedGrasp.model_validate({**known, "estimates": (ball, tube), "estimator": "hypotheses", "noise": 0.0})
    localization = replace(grasp, kind="localization", reason="a ball and a tube", quantities=quantities, scene=scene)
    return write_result(localization, place, case_id="abc", provenance={})


def made_up_store(folder: Path, *, done: int = 4) -> Path:
    """A data set of six grasps that nobody computed: the first are done, the next failed, the last is pending."""
    return Path(shutil.copytree(_written_store(done), folder / "lumps.zarr"))


@cache
def _written_store(done: int) -> Path:
    """Such a data set, written once in a process; tests have copies."""
    kept = tempfile.TemporaryDirectory(prefix="tactsim-pages-")
    atexit.register(kept.cleanup)
    folder = Path(kept.name)
    file, place, numbers = folder / "sweep.yaml", folder / "lumps.zarr", itertools.count()
    file.write_text(SWEEP, encoding="utf-8")

    def begin(experiment: Grasp) -> Course:
        number = next(numbers)
        if number >= done:
            raise ConvergenceError("residual <i>1</i>")
        grasp = made_up_grasp((1 + 0.1 * number) * taxel_forces(1))
        values = {"time": 1.0, "displacement": CLOSING, "reaction_force": 1.0}
        beside = {f"{part}_force_{side}": Quantity(0.0, "N", "") for part in ("gap", "outside") for side in JAWS}
        numbers_of = {name: Quantity(0.0, unit, "") for name, (unit, _) in GraspRecorder.quantities.items()}
        units = {"time": "s", "displacement": "m", "reaction_force": "N"}
        quantities = grasp.quantities | beside | numbers_of
        return Course.computed(
            Findings("", (StepRecord(1, 1, 0.0, values),), quantities=quantities, units=units, scene=grasp.scene)
        )

    with patch.object(Grasp, "begin", begin):
        run_sweep(load_sweep(file), place)
    group = Store.open(place, writing=True).group
    group["status"][5], group["reason"][5] = PENDING, ""
    return place


def description(count: int = 3, **more: object) -> dict:
    """The first line of a stream."""
    matrix = {"rows": count, "columns": count, "pitch": 30e-3 / count, "size": 27e-3 / count}
    return {"schema": "tactsim/frames/1", "matrix": matrix, "block_size": list(SIZE), **more}


def frame_line(time: float = 0.0, count: int = 3, **more: object) -> dict:
    """A frame of a stream."""
    forces = taxel_forces(1, count)[0].tolist()
    return {"time": time, "taxel_force_upper": forces[0], "taxel_force_lower": forces[1], **more}


def line(content: object) -> bytes:
    """A line of a stream."""
    return json.dumps(content).encode() + b"\n"
