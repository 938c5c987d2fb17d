"""tactsim against other programs on one mesh in one run: a block with a ball, squeezed between glued plates in four steps.

python benchmarks/peers.py [--cells 15,15,7 21,21,10] [--felupe-python PATH] [--folder PATH] [--repetitions 1]

tactsim solves its mixed P2/P1 form, FElupe the displacement form with MKL Pardiso; they take turns. Both solve the mixed form to
compare reactions and pressures. CalculiX, GetFEM and FEniCSx join in displacement form where they are installed:
``apt-get install --no-install-recommends calculix-ccx python3-getfem python3-dolfinx``.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median

import numpy as np
import peer_runs
from peer_runs import Run

from block_problem import readings, write  # isort: skip  it stands in a folder that peer_runs makes known

Array = np.ndarray
Figures = dict[str, float | str]
Cells = tuple[int, int, int]

SIZES: tuple[Cells, ...] = ((15, 15, 7), (21, 21, 10))
WARM_UP: Cells = (6, 6, 4)
TARGETS = {43_245: 7.0, 116_487: 12.0}
"""How many times faster than FElupe tactsim is to be, by the number of displacement unknowns."""
NAMES = {"calculix": "CalculiX", "getfem": "GetFEM", "fenicsx": "FEniCSx"}
"""Programs that may be absent, as their authors write them."""
AGREEMENT = 1e-3
"""Largest relative difference of the force and of the nine pressures, both programs in mixed form."""
QUANTITIES = ("setup_seconds", "seconds", "processor_seconds", "iterations", "factorisations", "solutions", "peak_megabytes")
LIMIT = 1200.0
"""Seconds after which CalculiX, whose Debian build factors with SPOOLES, GetFEM or FEniCSx is stopped."""


def measure(
    sizes: Sequence[Cells] = SIZES,
    *,
    felupe_python: Path | None = None,
    folder: Path | None = None,
    repetitions: int = 1,
    agreement: Cells = SIZES[0],
    limit: float = LIMIT,
) -> Figures:
    """Times, memory, counts and ratios by ``<unknowns>_<program>_<quantity>``, and differences of results."""
    with _place(folder) as place:
        python = felupe_python or peer_runs.felupe_python(place)
        write(place / "warm_up.npz", WARM_UP)
        figures: Figures = {"load_average_before": os.getloadavg()[0]}
        for cells in sizes:
            path = place / f"block_{'_'.join(map(str, cells))}.npz"
            problem = write(path, cells)
            speeds, felupe = _speed(place, path, python, repetitions)
            figures |= speeds | _others(place, path, problem, felupe, limit)
        figures |= _agreement(place, agreement, python)
        figures["load_average_after"] = os.getloadavg()[0]
    return figures


@contextmanager
def _place(folder: Path | None) -> Iterator[Path]:
    """The folder asked for, made if need be, or one that goes afterwards."""
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        yield folder.resolve()
        return
    with tempfile.TemporaryDirectory() as place:
        yield Path(place)


def _speed(place: Path, path: Path, python: Path, repetitions: int) -> tuple[Figures, Run]:
    """tactsim and FElupe by turns on one mesh: medians and the median of the ratios, and FElupe's last run."""
    pairs = [(peer_runs.tactsim(place, path), peer_runs.felupe(place, path, python, "displacement")) for _ in range(repetitions)]
    number = int(pairs[0][1]["unknowns"])
    figures: Figures = {}
    for program, runs in zip(("tactsim", "felupe"), zip(*pairs, strict=True), strict=True):
        figures |= _summary(f"{number}_{program}", runs)
    figures[f"{number}_ratio"] = median(_seconds(felupe) / _seconds(tactsim) for tactsim, felupe in pairs)
    figures[f"{number}_ratio_with_setup"] = median(_seconds(b, "setup") / _seconds(a, "setup") for a, b in pairs)
    return figures, pairs[-1][1]


def _seconds(run: Run, *more: str) -> float:
    """All steps, and the ``more`` parts asked for."""
    return float(run["step_seconds"].sum() + sum(run[f"{part}_seconds"] for part in more))


def _summary(name: str, runs: Sequence[Run]) -> Figures:
    """Medians of the quantities of some runs of one program."""
    values = [{**run, "seconds": run["step_seconds"].sum(), "iterations": run["iterations"].sum()} for run in runs]
    figures: Figures = {f"{name}_{q}": median(float(run[q]) for run in values) for q in QUANTITIES}
    return figures | {f"{name}_version": str(runs[-1]["version"]), f"{name}_unknowns": float(runs[-1]["unknowns"])}


def _others(place: Path, path: Path, problem: Run, felupe: Run, limit: float) -> Figures:
    """Figures of the programs that may be absent, with the difference from FElupe's displacement form, or why there are none."""
    figures: Figures = {}
    for program in peer_runs.OPTIONAL:
        name, other = f"{problem['nodes'].size}_{program}", peer_runs.optional(place, program, path, limit)
        if isinstance(other, str):
            figures[name] = other
            continue
        figures |= _summary(name, [other])
        figures[f"{name}_force_newtons"] = float(readings(problem, other["forces"])[0])
        figures[f"{name}_difference_from_felupe"] = _difference(problem, other, felupe)
    return figures


def _difference(problem: Run, one: Run, other: Run) -> float:
    """Largest relative difference of the force on the top and of the mean pressures on its squares."""
    return float(np.abs(readings(problem, one["forces"]) / readings(problem, other["forces"]) - 1).max())


def _agreement(place: Path, cells: Cells, python: Path) -> Figures:
    """tactsim and FElupe, both in mixed form."""
    path = place / "agreement.npz"
    problem = write(path, cells)
    ours, theirs = peer_runs.tactsim(place, path), peer_runs.felupe(place, path, python, "mixed")
    values = readings(problem, ours["forces"])
    return {
        "agreement_unknowns": float(problem["nodes"].size),
        "agreement_force_newtons": values[0],
        "agreement_largest_difference": _difference(problem, ours, theirs),
        "agreement_force_difference": float(abs(theirs["forces"][:, 2].sum() / ours["forces"][:, 2].sum() - 1)),
        "agreement_felupe_mixed_seconds": _seconds(theirs),
    }


def table(figures: Figures) -> str:
    """Markdown table of programs and sizes, then the ratios and differences."""
    columns = ("seconds", "processor_seconds", "setup_seconds", "iterations", "factorisations", "peak_megabytes")
    lines = ["| unknowns | program | " + " | ".join(name.replace("_", " ") for name in columns) + " |", "|---" * 8 + "|"]
    numbers = [key.removesuffix("_ratio") for key in figures if key.endswith("_ratio")]
    names = [(number, program) for number in numbers for program in ("tactsim", "felupe", *peer_runs.OPTIONAL)]
    for number, program in names:
        name = f"{number}_{program}"
        cells = [f"{figures[f'{name}_{column}']:.4g}" for column in columns] if name not in figures else [str(figures[name])]
        lines.append(f"| {number} | {program} | {' | '.join(cells)} |")
    for number in numbers:
        asked = TARGETS.get(int(number), "-")
        lines.append(f"\n{number}: FElupe / tactsim = {figures[f'{number}_ratio']:.2f} (asked: {asked})")
    for number, program in names:
        difference = figures.get(f"{number}_{program}_difference_from_felupe")
        if difference is not None:
            lines.append(f"\n{number}: {program} and FElupe, displacement forms, differ by {difference:.1e}")
    difference = figures["agreement_largest_difference"]
    lines.append(
        f"\nmixed forms differ by {difference:.1e} at {figures['agreement_unknowns']:.0f} unknowns (allowed: {AGREEMENT:g})"
    )
    lines.append(f"\nload average {figures['load_average_before']:.1f} to {figures['load_average_after']:.1f}")
    return "\n".join([*lines, f"\n{time.strftime('%Y-%m-%d')}, {os.cpu_count()} cores"])


def rows(figures: Figures) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured; one for each program and size."""
    made = []
    for number in (key.removesuffix("_ratio") for key in figures if key.endswith("_ratio")):
        unknowns = f"{int(number):,}".replace(",", " ")
        block = f"block of {unknowns} displacement unknowns, faster than"
        asked = f"{TARGETS[int(number)]:g} times" if int(number) in TARGETS else "-"
        felupe = f"{figures[f'{number}_ratio']:.1f} times ({_times(figures, number, 'felupe')})"
        made.append((f"{block} FElupe {figures[f'{number}_felupe_version']} by", asked, felupe))
        made += [
            (f"{block} {_named(figures, number, program)} by", "beside it", _beside(figures, number, program))
            for program in NAMES
        ]
    difference = f"{100 * float(figures['agreement_largest_difference']):.4f} %"
    return [*made, ("reaction and nine pressures, difference from FElupe, both mixed", f"{100 * AGREEMENT:g} %", difference)]


def _named(figures: Figures, number: str, program: str) -> str:
    """A program with its version, if it is installed."""
    return f"{NAMES[program]} {figures.get(f'{number}_{program}_version', '')}".strip()


def _times(figures: Figures, number: str, program: str) -> str:
    """Seconds of tactsim and of another program."""
    ours, theirs = (float(figures[f"{number}_{name}_seconds"]) for name in ("tactsim", program))
    return f"{ours:.1f} against {theirs:.1f} s"


def _beside(figures: Figures, number: str, program: str) -> str:
    """How many times faster tactsim is than a program that may be absent, or why there is no figure."""
    name = f"{number}_{program}"
    if name in figures:
        return str(figures[name])
    ratio = float(figures[f"{name}_seconds"]) / float(figures[f"{number}_tactsim_seconds"])
    difference = float(figures[f"{name}_difference_from_felupe"])
    return f"{ratio:.1f} times ({_times(figures, number, program)}), {difference:.0e} off FElupe's displacement form"


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
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds after which CalculiX, GetFEM or FEniCSx is stopped")
    options = vars(parser.parse_args())
    figures = measure(options.pop("cells"), **options)
    sys.stdout.write(f"{json.dumps(figures, indent=2)}\n\n{table(figures)}\n")


if __name__ == "__main__":
    main()
