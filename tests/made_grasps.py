"""Grasps made up by the fast forward model, as a store and as results of plain tissue, for tests of the ranking of estimators."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from scenes import grasp_scene
from sweeps import load_once

from tactsim.dataset.ranking.reference import PlainGrasp
from tactsim.dataset.ranking.samples import SPHERE, JudgedSamples, Truth
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.store.arrays import DONE
from tactsim.dataset.store.blocks import checksum
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import stored_variables
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.localization.lump_response import LumpResponse
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.writing import write_result

SIZE = np.array([40e-3, 40e-3, 20e-3])
LAYOUT = TaxelLayout(rows=3, columns=3, pitch=10e-3, size=9e-3)
RADII = np.array([2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3])
CLOSINGS = np.array([0.4e-3, 0.8e-3, 1.2e-3])
NOISE = 0.3e-3
PLAIN = np.full((2, 3, 3), 0.25)
"""Forces in N of plain tissue, the same on all taxels."""
BALL_AT = (28e-3, 14e-3, 12e-3)
BALL = np.array(
    [
        [[0.0034, 0.0318, 0.369], [0.0028, 0.021, 0.1399], [0.004, 0.0033, 0.0029]],
        [[0.0039, 0.0714, 0.234], [0.0029, 0.0621, 0.1505], [0.0027, 0.0048, 0.0073]],
    ]
)
"""Coarse finite elements: what a hard ball of radius 5 mm at ``BALL_AT`` adds to plain ICF on the same mesh, both jaws closed by
1 mm, in N."""
TEXT = """\
schema: tactsim/sweep/1
title: Made-up grasps
experiment:
  kind: grasp
  block: {size: [40 mm, 40 mm, 20 mm], tissue: icf_stable}
  inclusions:
    - shape: {kind: sphere, center: [{uniform: [8 mm, 32 mm]}, 20 mm, 10 mm], radius: 3 mm}
      material: {kind: neo_hookean, c10: 100 kPa}
  matrix: {rows: 3, columns: 3, pitch: 10 mm, size: 9 mm}
  loading:
    control: displacement
    pieces:
      - {kind: ramp, to: 1 mm, duration: 1 s}
  time: {steps: 1}
sweep: {samples: 40, seed: 3, splits: {train: 0.75, validation: 0.0}}
"""
FEW = TEXT.replace("samples: 40", "samples: 8")
"""The same with fewer samples, for what one of them shows."""
READOUT = "  time: {steps: 1}\n  readout: {chain: {sampling_rate: 200 Hz, noise: {white: 1 mV}}, seed: 4}\n"


def cells_of_block(count: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Midpoints (n, 3) in m and volumes (n,) in m^3 of equal cells that fill the block."""
    lines = [(np.arange(n) + 0.5) * side / n for n, side in zip(count, SIZE, strict=True)]
    places = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    return places, np.full(len(places), np.prod(SIZE) / len(places))


def taxel_density(places: np.ndarray) -> np.ndarray:
    """A bell over every taxel that fades with the distance from its jaw, (2, 3, 3, n) in N/m^3."""
    x, y = (LAYOUT.borders(along).mean(axis=1) + 20e-3 for along in "xy")
    away = (places[:, 0] - x[None, :, None]) ** 2 + (places[:, 1] - y[:, None, None]) ** 2
    depth = np.stack([SIZE[2] - places[:, 2], places[:, 2]])[:, None, None]
    return 1e5 * np.exp(-away[None] / 8e-3**2 - depth / 6e-3)


def bell_response(
    radii: np.ndarray,
    density: Callable[[np.ndarray], np.ndarray] = taxel_density,
    *,
    count: tuple[int, int, int] = (40, 40, 20),
    spacing: float = 2e-3,
) -> LumpResponse:
    """The response of a density that is known in closed form."""
    places, volumes = cells_of_block(count)
    return LumpResponse.of_density(places, volumes, density(places), size=SIZE, radii=radii, spacing=spacing)


@cache
def response() -> LumpResponse:
    """The response for the radii of the made-up lumps."""
    return bell_response(RADII)


def plain_forces(closings: np.ndarray) -> np.ndarray:
    """Forces (n, 2, 3, 3) in N of tissue that stiffens a little."""
    pattern = 0.25 + 0.05 * np.array([[0, 1, 0], [1, 2, 1], [0, 1, 0]])
    rising = np.asarray(closings)[:, None, None, None] / 1e-3
    return np.broadcast_to(pattern, (2, 3, 3)) * (rising + 0.2 * rising**2)


def plain_grasp() -> PlainGrasp:
    """The plain tissue at several closings."""
    closings = np.append(0.0, CLOSINGS)
    forces = plain_forces(closings)
    return PlainGrasp(closings, forces, Readings(forces[-1], LAYOUT, SIZE, noise=0.0), grasp_scene(SIZE, LAYOUT))


def truths(count: int, seed: int = 1) -> tuple[Truth, ...]:
    """Lumps at random; every eighth sample has none."""
    generator = np.random.default_rng(seed)
    grasps = []
    for number in range(count):
        center = tuple(map(float, generator.uniform([8e-3, 8e-3, 6e-3], [32e-3, 32e-3, 14e-3])))
        closing, radius = float(generator.uniform(0.5e-3, 1.2e-3)), float(generator.uniform(3e-3, 5e-3))
        there = (center, radius, float(SIZE[2] - center[2]), 10.0) if number % 8 else (None,) * 4
        grasps.append(Truth(number, closing, *there))
    return tuple(grasps)


def made_forces(grasps: tuple[Truth, ...], table: LumpResponse, contrast: float = 2.0) -> np.ndarray:
    """What the taxels feel (n, 2, 3, 3) in N, without noise."""
    forces = plain_forces(np.array([truth.closing for truth in grasps]))
    for k, truth in enumerate(grasps):
        if truth.center is not None:
            forces[k] += contrast * table.signal(np.array([truth.center]), np.array([truth.radius]))[0]
    return forces


def made_samples(count: int, table: LumpResponse, *, noise: float = NOISE, seed: int = 1) -> JudgedSamples:
    """Samples to be judged, without a store."""
    grasps = truths(count, seed)
    stated = np.full(count, noise)
    return JudgedSamples(grasps, made_forces(grasps, table), plain_grasp(), "taxel_force", stated, np.zeros(count))


def plain_result(folder: Path, closings: np.ndarray = CLOSINGS, layout: TaxelLayout = LAYOUT, size: np.ndarray = SIZE) -> str:
    """The folder of a result of plain tissue."""
    forces = plain_forces(closings)
    many = len(closings) > 1
    quantities = {"displacement": Quantity(float(closings[-1]), "m", "")}
    if many:
        quantities["displacement_history"] = Quantity(closings.tolist(), "m", "")
    for jaw, side in enumerate(JAWS):
        own = np.resize(forces[:, jaw], (len(closings), layout.rows, layout.columns))
        quantities[f"taxel_force_{side}"] = Quantity(own[-1].tolist(), "N", "")
        if many:
            quantities[f"taxel_force_{side}_history"] = Quantity(own.tolist(), "N", "")
    scene = grasp_scene(size, layout)
    steps = tuple(StepRecord(k + 1, 3, 0.0, {"displacement": float(c)}) for k, c in enumerate(closings))
    result = Result("grasp", Status.CONVERGED, "made up", quantities, steps=steps, units={"displacement": "m"}, scene=scene)
    write_result(result, folder, case_id="0" * 16, provenance={})
    return str(folder)


def sum_up(place: Path) -> None:
    """Writes the checksum of every sample of a store as it stands."""
    store = Store.open(place, writing=True)
    variables = list(stored_variables(store))
    values = {variable.name: store.read(variable.name) for variable in variables}
    rows = [{name: content[row] for name, content in values.items()} for row in range(store.samples)]
    store.array("checksum")[...] = np.stack([checksum(row, variables) for row in rows])


def made_store(folder: Path, table: LumpResponse, text: str = TEXT, *, done: bool = True, training: int = 30) -> Path:
    """A store whose samples hold the made-up grasps; the first of them are for training."""
    path = folder / "sweep.yaml"
    path.write_text(text, encoding="utf-8")
    place = folder / "made.zarr"
    with opened_run(load_once(path), place, resume=False, accept_changes=False):
        pass
    store = Store.open(place, writing=True)
    grasps = truths(count := store.samples)
    if not done:
        return place
    forces = made_forces(grasps, table)
    there = np.array([truth.present for truth in grasps])
    values = {
        "closing": [truth.closing for truth in grasps],
        "inclusion_count": there.astype(int),
        "inclusion_kind": SPHERE * there[:, None],
        "inclusion_center": [[truth.center or [np.nan] * 3] for truth in grasps],
        "inclusion_radius": [[truth.radius or np.nan] for truth in grasps],
        "inclusion_contrast": [[truth.contrast or np.nan] for truth in grasps],
        "time_s": np.ones((count, 1)),
        "taxel_force": forces[:, None],
        "split": np.where(np.arange(count) < training, 0, 2),
        "specimen": np.arange(count) // store.attributes["samples_per_specimen"],
        "status": np.full(count, DONE),
    }
    if "read_force" in store.described:
        values["read_force"] = 0.8 * forces[:, None]
    for name in store.described:
        array = store.array(name)
        array[...] = np.asarray(values[name], dtype=array.dtype) if name in values else array[...]
    sum_up(place)
    return place
