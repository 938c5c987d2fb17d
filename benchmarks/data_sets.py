"""Speed of data sets: grasps per hour, ten thousand fast samples, opening a store; prints JSON.

python benchmarks/data_sets.py [--held]

With --held (over half an hour) the error of the mesh instead: 20 samples that no sweep draws, against a fine one in two steps.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from multiprocessing import TimeoutError, get_context
from pathlib import Path

import numpy as np
import xarray

from tactsim.dataset.sampling.drawing import drawn_specimen
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.errors import ConvergenceError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.solver_settings import GraspSolverSettings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.results.result import Status

CASES = Path(__file__).parents[1] / "cases"
GRASPS, FAST = 60, 10_000
STANDARD = (
    "experiment.contact.friction=0.6",
    "experiment.loading.pieces.0.to=1 mm",
    "sweep.within_specimen=[]",
    "sweep.samples_per_specimen=1",
)
"""Friction and closing of the figure that is asked for, each lump once; the sweep itself varies them."""
OPENING = "import time; import xarray; t = time.perf_counter(); xarray.open_zarr({!r}); print(time.perf_counter() - t)"
"""The first opening in a new process."""
HELD, HELD_SEED = 20, 81
FINE = {"size": 4e-3, "edge_size": 1.6e-3, "growth": 0.6}
FINE_SHARE = 0.2
"""Cells at the lump over its radius: eight across. Some 75 000 to 120 000 unknowns in all."""
FINE_STEPS, LIMIT = 2, 1200.0
"""Time in s after which a fine grasp counts as failed: it needs many load steps where a lump is near a jaw."""


def measure() -> dict[str, float]:
    """Wall times in s of sweeps with a process per core, and what follows from them."""
    with tempfile.TemporaryDirectory() as folder:
        lumps, fast = Path(folder) / "lumps.zarr", Path(folder) / "fast.zarr"
        overrides = [part for value in STANDARD for part in ("--set", value)]
        grasps = _swept(CASES / "sweep_lumps.yaml", lumps, GRASPS, *overrides)
        quick = _swept(CASES / "sweep_closed_form.yaml", fast, FAST)
        done = samples_done(lumps)
        opening = float(subprocess.run([sys.executable, "-c", OPENING.format(str(fast))], check=True, capture_output=True).stdout)
    return {
        "grasps": float(GRASPS),
        "grasps_done": float(done),
        "grasp_seconds": grasps,
        "grasps_per_hour": 3600 * done / grasps,
        "fast_samples": float(FAST),
        "fast_seconds": quick,
        "open_seconds": opening,
    }


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured."""
    done = f"{taken['grasps_done']:.0f} of {taken['grasps']:.0f} done"
    return [
        (
            f"samples of `sweep_lumps.yaml` at 1 mm and friction 0.6, {done}",
            "4 000 per hour",
            f"{taken['grasps_per_hour']:.0f} per hour",
        ),
        (f"{taken['fast_samples']:.0f} samples of `sweep_closed_form.yaml`", "120 s", f"{taken['fast_seconds']:.0f} s"),
        ("opening that store with xarray", "1 s", f"{taken['open_seconds']:.2f} s"),
    ]


def samples_done(store: Path) -> int:
    """How many samples of a data set have a result."""
    return int((xarray.open_zarr(store)["status"] == 1).sum())


def _swept(case: Path, store: Path, samples: int, *options: str) -> float:
    begin = time.perf_counter()
    command = [sys.executable, "-m", "tactsim.cli", "sweep", str(case), "--out", str(store), "--samples", str(samples), "--quiet"]
    code = subprocess.run([*command, *options]).returncode
    if code not in (0, ConvergenceError.exit_code):  # samples that failed are counted in the store
        raise RuntimeError(f"{case.name}: exit code {code}")
    return time.perf_counter() - begin


def held_errors(samples: range = range(HELD)) -> dict[str, float | None]:
    """Differences of the taxels from those of the fine mesh, over the largest taxel, by held sample; None if it failed."""
    errors: dict[str, float | None] = {}
    for number in samples:
        forces = [_taxels_in_time(number, fine) for fine in (False, True)]
        error = float(np.abs(forces[0] - forces[1]).max() / forces[1].max())
        errors[f"held_{number}"] = error if np.isfinite(error) else None
        sys.stderr.write(f"{number} {error:.4f}\n")
    known = [error for error in errors.values() if error is not None]
    return errors | {"held_median": float(np.median(known)), "held_largest": max(known), "held_known": float(len(known))}


def _taxels_in_time(number: int, fine: bool) -> np.ndarray:
    """Forces in N on the taxels of both jaws, NaN if the grasp did not converge within the limit."""
    with get_context("spawn").Pool(1) as pool:
        try:
            return pool.apply_async(_taxels, (number, fine)).get(LIMIT)
        except TimeoutError:
            return np.array(np.nan)


def _taxels(number: int, fine: bool) -> np.ndarray:
    """Forces in N on the taxels of both jaws in a held sample; drawn here, as grasps do not travel between processes."""
    sweep = load_sweep(CASES / "sweep_lumps.yaml", (f"sweep.seed={HELD_SEED}", f"sweep.samples={3 * HELD}", *STANDARD))
    case = drawn_specimen(sweep, number)[0].case
    assert case is not None
    grasp = case.experiment
    assert isinstance(grasp, Grasp)
    if fine:
        mesh = FINE | {"inclusion_size": FINE_SHARE * grasp.inclusions[0].shape.radius}
        time = grasp.time.model_copy(update={"steps": FINE_STEPS})
        settings = {"mesh": grasp.mesh.model_copy(update=mesh), "time": time, "solver": GraspSolverSettings()}
        grasp = grasp.model_copy(update=settings)
    result = grasp.run()
    if result.status is not Status.CONVERGED:
        return np.array(np.nan)
    return np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])


if __name__ == "__main__":
    figures = held_errors() if "--held" in sys.argv[1:] else measure()
    sys.stdout.write(json.dumps(figures, indent=2) + "\n")
