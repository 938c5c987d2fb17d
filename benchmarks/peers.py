"""tactsim against other programs on one mesh in one run: a block with a ball, squeezed between glued plates in four steps.

python benchmarks/peers.py [--cells 15,15,7 21,21,10] [--felupe-python PATH] [--folder PATH] [--repetitions 1]

tactsim solves its mixed P2/P1 form, FElupe the displacement form with MKL Pardiso; they take turns. Both solve the mixed form to
compare reactions and pressures. CalculiX joins where ``ccx`` is installed. Each program runs in a process of its own.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median

import numpy as np

PROGRAMS = Path(__file__).parent / "peer_programs"
sys.path.insert(0, str(PROGRAMS))

from block_problem import read, readings, write  # noqa: E402  they stand in the folder that the line above makes known

Array = np.ndarray
Cells = tuple[int, int, int]

FELUPE = ("felupe==11.3.0", "tensortrax==0.29.0", "pypardiso==0.4.7")
SIZES: tuple[Cells, ...] = ((15, 15, 7), (21, 21, 10))
WARM_UP: Cells = (6, 6, 4)
TARGETS = {43_245: 3.3, 116_487: 4.0}
"""How many times faster than FElupe tactsim must be, by the number of displacement unknowns."""
AGREEMENT = 1e-3
"""Largest relative difference of the force and of the nine pressures, both programs in mixed form."""
QUANTITIES = ("setup_seconds", "seconds", "processor_seconds", "iterations", "factorisations", "solutions", "peak_megabytes")
CALCULIX_LIMIT = 1200.0
"""Seconds after which CalculiX, whose Debian build factors with SPOOLES, is stopped."""
OTHERS = {"getfem": "GetFEM", "dolfinx": "FEniCSx"}
"""Modules of the system's Python, and their programs."""


def measure(
    sizes: Sequence[Cells] = SIZES,
    *,
    felupe_python: Path | None = None,
    folder: Path | None = None,
    repetitions: int = 1,
    agreement: Cells = SIZES[0],
    calculix_limit: float = CALCULIX_LIMIT,
) -> dict[str, float | str]:
    """Times, memory, counts and ratios by ``<unknowns>_<program>_<quantity>``, and differences of results."""
    with _place(folder) as place:
        python = felupe_python or _felupe_python(place)
        write(place / "warm_up.npz", WARM_UP)
        found: dict[str, float | str] = {"load_average_before": os.getloadavg()[0]}
        for cells in sizes:
            problem, speeds, felupe = _speed(place, cells, python, repetitions)
            found |= speeds | _calculix(place, problem, felupe, calculix_limit)
        found |= _agreement(place, agreement, python)
        found |= {program: _presence(module) for module, program in OTHERS.items()}
        found["load_average_after"] = os.getloadavg()[0]
    return found


@contextmanager
def _place(folder: Path | None) -> Iterator[Path]:
    """The folder asked for, made if need be, or one that goes afterwards."""
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        yield folder.resolve()
        return
    with tempfile.TemporaryDirectory() as place:
        yield Path(place)


def _felupe_python(place: Path) -> Path:
    """An interpreter that has FElupe: this one, or one of an environment made in ``place``."""
    if all(importlib.util.find_spec(name) for name in ("felupe", "tensortrax", "pypardiso")):
        return Path(sys.executable)
    python = place / "felupe" / ("Scripts" if os.name == "nt" else "bin") / "python"
    if not python.exists():
        sys.stderr.write(f"installing {', '.join(FELUPE)} into {python.parents[1]}\n")
        subprocess.run([sys.executable, "-m", "venv", python.parents[1]], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *FELUPE], check=True)
    return python


def _run(place: Path, name: str, command: Sequence[str | Path]) -> dict[str, Array]:
    """What a program wrote to its result file, the last of its arguments."""
    result = place / f"{name}.npz"
    done = subprocess.run([*command, result], cwd=PROGRAMS, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{name} failed: {done.stderr[-3000:]}")
    return read(result)


def _tactsim(place: Path, problem: Path) -> dict[str, Array]:
    return _run(place, "tactsim", [sys.executable, "tactsim_block.py", place / "warm_up.npz", problem])


def _felupe(place: Path, problem: Path, python: Path, form: str) -> dict[str, Array]:
    return _run(place, f"felupe_{form}", [python, "felupe_block.py", form, place / "warm_up.npz", problem])


def _speed(place: Path, cells: Cells, python: Path, repetitions: int) -> tuple[Path, dict[str, float | str], dict[str, Array]]:
    """tactsim and FElupe by turns on one mesh: the problem, medians and the median of the ratios, FElupe's last run."""
    problem = place / f"block_{'_'.join(map(str, cells))}.npz"
    number = write(problem, cells)["nodes"].size
    pairs = [(_tactsim(place, problem), _felupe(place, problem, python, "displacement")) for _ in range(repetitions)]
    found: dict[str, float | str] = {}
    for program, runs in zip(("tactsim", "felupe"), zip(*pairs, strict=True), strict=True):
        found |= _summary(f"{number}_{program}", runs)
    found[f"{number}_ratio"] = median(_seconds(felupe) / _seconds(tactsim) for tactsim, felupe in pairs)
    found[f"{number}_ratio_with_setup"] = median(_seconds(b, "setup") / _seconds(a, "setup") for a, b in pairs)
    if number in TARGETS:
        found[f"{number}_ratio_asked"] = TARGETS[number]
    return problem, found, pairs[-1][1]


def _seconds(run: dict[str, Array], *more: str) -> float:
    """All steps, and the ``more`` parts asked for."""
    return float(run["step_seconds"].sum() + sum(run[f"{part}_seconds"] for part in more))


def _summary(name: str, runs: Sequence[dict[str, Array]]) -> dict[str, float | str]:
    """Medians of the quantities of some runs of one program."""
    values = [{**run, "seconds": run["step_seconds"].sum(), "iterations": run["iterations"].sum()} for run in runs]
    found: dict[str, float | str] = {f"{name}_{q}": median(float(run[q]) for run in values) for q in QUANTITIES}
    return found | {f"{name}_version": str(runs[-1]["version"]), f"{name}_unknowns": float(runs[-1]["unknowns"])}


def _calculix(place: Path, path: Path, felupe: dict[str, Array], limit: float) -> dict[str, float | str]:
    """CalculiX' seconds, and its difference from FElupe, which solves the same displacement form; or why there are none."""
    problem = read(path)
    name = f"{problem['nodes'].size}_calculix"
    if shutil.which("ccx") is None:
        return {name: "not present"}
    run = _run(place, "calculix", [sys.executable, "calculix_block.py", str(limit), path])
    if "stopped_seconds" in run:
        return {name: f"stopped after {limit:g} s"}
    return _summary(name, [run]) | {f"{name}_difference_from_felupe": _difference(problem, run, felupe)}


def _difference(problem: dict[str, Array], one: dict[str, Array], other: dict[str, Array]) -> float:
    """Largest relative difference of the force on the top and of the mean pressures on its squares."""
    return float(np.abs(readings(problem, one["forces"]) / readings(problem, other["forces"]) - 1).max())


def _agreement(place: Path, cells: Cells, python: Path) -> dict[str, float | str]:
    """tactsim and FElupe, both in mixed form."""
    path = place / "agreement.npz"
    problem = write(path, cells)
    ours, theirs = _tactsim(place, path), _felupe(place, path, python, "mixed")
    values = readings(problem, ours["forces"])
    return {
        "agreement_unknowns": float(problem["nodes"].size),
        "agreement_force_newtons": values[0],
        "agreement_largest_difference": _difference(problem, ours, theirs),
        "agreement_force_difference": float(abs(theirs["forces"][:, 2].sum() / ours["forces"][:, 2].sum() - 1)),
        "agreement_asked": AGREEMENT,
        "agreement_felupe_mixed_seconds": _seconds(theirs),
    }


def _presence(module: str) -> str:
    """Whether the system's own Python has a module."""
    python = shutil.which("python3", path="/usr/bin")
    if python is None:
        return "not present"
    done = subprocess.run([python, "-c", f"import {module}"], capture_output=True, check=False)
    return "present, not measured" if done.returncode == 0 else "not present"


def table(figures: dict[str, float | str]) -> str:
    """Markdown table of programs and sizes, then the ratios and differences."""
    columns = ("seconds", "processor_seconds", "setup_seconds", "iterations", "factorisations", "peak_megabytes")
    lines = ["| unknowns | program | " + " | ".join(name.replace("_", " ") for name in columns) + " |", "|---" * 8 + "|"]
    numbers = [key.removesuffix("_ratio") for key in figures if key.endswith("_ratio")]
    for number in numbers:
        for program in ("tactsim", "felupe", "calculix"):
            name = f"{number}_{program}"
            cells = [f"{figures[f'{name}_{column}']:.4g}" for column in columns] if name not in figures else [str(figures[name])]
            lines.append(f"| {number} | {program} | {' | '.join(cells)} |")
    for number in numbers:
        asked = figures.get(f"{number}_ratio_asked", "-")
        lines.append(f"\n{number}: FElupe / tactsim = {figures[f'{number}_ratio']:.2f} (asked: {asked})")
    difference = figures["agreement_largest_difference"]
    lines.append(
        f"\nmixed forms differ by {difference:.1e} at {figures['agreement_unknowns']:.0f} unknowns (allowed: {AGREEMENT:g})"
    )
    lines += [f"\n{program}: {figures[program]}" for program in OTHERS.values()]
    lines.append(f"\nload average {figures['load_average_before']:.1f} to {figures['load_average_after']:.1f}")
    return "\n".join([*lines, f"\n{time.strftime('%Y-%m-%d')}, {os.cpu_count()} cores"])


def _cells(text: str) -> Cells:
    first, second, third = map(int, text.split(","))
    return first, second, third


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=_cells, nargs="+", default=SIZES, help="cells along each side of every block")
    parser.add_argument("--felupe-python", type=Path, help="an interpreter with felupe, tensortrax and pypardiso")
    parser.add_argument("--folder", type=Path, help="where meshes, results and an environment for FElupe are kept")
    parser.add_argument("--repetitions", type=int, default=1, help="turns of tactsim and FElupe")
    parser.add_argument("--agreement", type=_cells, default=SIZES[0], help="cells of the block solved by both in mixed form")
    parser.add_argument("--calculix-limit", type=float, default=CALCULIX_LIMIT, help="seconds after which CalculiX is stopped")
    options = vars(parser.parse_args())
    figures = measure(options.pop("cells"), **options)
    sys.stdout.write(f"{json.dumps(figures, indent=2)}\n\n{table(figures)}\n")


if __name__ == "__main__":
    main()
