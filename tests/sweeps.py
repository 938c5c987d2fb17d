"""Small sweeps of the closed form for the tests of data sets, computed in this process."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tactsim.cli import command_sweep
from tactsim.dataset.running import computing
from tactsim.dataset.running.computing import computed
from tactsim.dataset.running.executors import Executor, TaskOutcome
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.running.run import SweepRun
from tactsim.dataset.sampling import stored
from tactsim.dataset.sampling import sweep as sampled
from tactsim.dataset.sampling.layout import layout_of
from tactsim.dataset.sampling.sweep import Sweep, load_sweep, sweep_of_text
from tactsim.dataset.store.opening import Store

TEXT = """\
schema: tactsim/sweep/1
title: A small sweep
experiment:
  kind: closed_form
  material: {kind: neo_hookean, c10: {log_uniform: [1 kPa, 20 kPa]}, relaxation: {fractions: [0.5], times: [1 s]}}
  inner_radius: {uniform: [1 mm, 2.5 mm]}
  outer_radius: {uniform: [2 mm, 4 mm]}
  loading:
    control: displacement
    pieces:
      - {kind: ramp, to: {uniform: [0.1 mm, 0.2 mm]}, duration: 1 s}
  points: 5
sweep:
  samples: 24
  samples_per_specimen: 3
  within_specimen: [experiment.loading.pieces.0.to]
  seed: 7
  times: 4
  reading: {chain: {sampling_rate: 200 Hz, noise: {white: 1 mV}}}
  splits:
    train: 0.5
    validation: 0.25
    out_of_distribution: {softer: {instantaneous_shear_modulus: {below: 4000}}}
"""


class Inline(Executor):
    """Computes in this process; may lose what it is told to lose."""

    def __init__(self, sweep: Sweep, *, losing: dict[int, int] | None = None, stop_after: int | None = None):
        self.sweep, self.losing, self.stop_after = sweep, dict(losing or {}), stop_after
        self.tasks: list[tuple[int, ...]] = []

    @property
    def slots(self) -> int:
        return 1

    def submit(self, samples: tuple[int, ...]) -> None:
        self.tasks.append(samples)

    def wait(self, seconds: float) -> list[TaskOutcome]:
        task = self.tasks.pop(0)
        if self.stop_after is not None:
            self.stop_after -= 1
            if self.stop_after < 0:
                raise KeyboardInterrupt
        unlucky = [number for number in task if self.losing.get(number, 0) > 0]
        if unlucky:
            self.losing[unlucky[0]] -= 1
            return [TaskOutcome(task, None, "its process ended (SIGKILL)")]
        return [TaskOutcome(task, computed(self.sweep.text, task))]

    def close(self) -> None:
        self.tasks = []


@cache
def _computed(text: str, samples: tuple[int, ...]) -> bytes:
    return computing.computed(text, samples)


_LOADED: dict[tuple[object, ...], Sweep] = {}


def load_once(path: Path, overrides: tuple[str, ...] = (), samples: int | None = None, **_: object) -> Sweep:
    """``load_sweep`` of a file that names no others; a text is read and laid out once, wherever it lies."""
    key = (path.read_text(encoding="utf-8"), overrides, samples)
    if key not in _LOADED:
        _LOADED[key] = load_sweep(path, overrides, samples)
    return _LOADED[key]


def compute_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same samples are computed here only once, and the texts of stores are read once, for sweeps that name no files."""
    monkeypatch.setattr("sweeps.computed", lambda text, samples: _computed(text, tuple(samples)))
    monkeypatch.setattr(stored, "sweep_of_text", lambda text, folder: sweep_of_text(text))


def compute_once_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """``tactsim sweep`` too computes in this process, and once."""
    compute_once(monkeypatch)
    monkeypatch.setattr(command_sweep, "_executor", lambda sweep, arguments: Inline(sweep))
    monkeypatch.setattr(sampled, "load_sweep", load_once)


def sweep_file(folder: Path, text: str = TEXT) -> Path:
    """The file of a sweep."""
    path = folder / "sweep.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def run_sweep(sweep: Sweep, place: Path, *, resume: bool = False, **options: object) -> SweepRun:
    """A sweep computed in this process."""
    with opened_run(sweep, place, resume=resume, accept_changes=resume) as going:
        going.compute(Inline(sweep, **options), lambda tally: None)  # type: ignore[arg-type]
    return going


def small_store(folder: Path, text: str = TEXT) -> Path:
    """The store of a whole sweep."""
    place = folder / "small.zarr"
    run_sweep(load_sweep(sweep_file(folder, text)), place)
    return place


def content(place: Path) -> dict[str, np.ndarray]:
    """Every variable but wall times and code."""
    store = Store.open(place)
    return {name: store.read(name) for name in store.described if name not in ("wall_time", "code")}


def assert_same(one: Path, other: Path, *, without: Collection[str] = ()) -> None:
    """Refuse two stores whose content differs, whatever the values of those ``without``."""
    first, second = content(one), content(other)
    assert first.keys() == second.keys()
    for name, values in first.items():
        if name not in without:
            np.testing.assert_array_equal(values, second[name], err_msg=name)


def main(file: str, store: str) -> None:
    """For every line that it reads, a fresh process that goes on with the store of a sweep's file, folding often.

    Each reports its number and then whether it begins; the last line is the exit code of the last.
    """
    import os
    import sys

    from tactsim.dataset.running import run as running

    running.FOLD_SAMPLES, running.MOST_IN_TASK = 6, 2
    sweep, place = load_sweep(file), Path(store)
    layout_of(sweep)
    for _ in sys.stdin:
        child = os.fork()
        if not child:
            sys.stdout.write(f"{os.getpid()}\n")
            sys.stdout.flush()
            run_sweep(sweep, place, resume=(place / "zarr.json").exists())
            os._exit(0)
        sys.stdout.write(f"{os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])}\n")
        sys.stdout.flush()
