"""``tactsim sweep``: turns a case with ranges into a data set."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from tactsim.cli import console
from tactsim.cli.interruption import interruptible
from tactsim.errors import INTERRUPTED, ConvergenceError, InputError

if TYPE_CHECKING:
    from tactsim.dataset.running.executors import Executor
    from tactsim.dataset.running.run import SweepRun, Tally
    from tactsim.dataset.sampling.sweep import Sweep

NAME = "sweep"
SUMMARY = "compute a data set from a case with ranges"
DESCRIPTION = """\
Draws samples from a sweep file (a case in which numbers are ranges or distributions), computes
each and writes them into a Zarr store that xarray.open_zarr reads. README.md in the store says
what is in it.

Samples are computed by --workers processes of this machine, one thread each, or by the Dask
cluster whose scheduler answers at --scheduler:

  dask scheduler                                   # prints its address
  dask worker tcp://HOST:8786 --nthreads 1 --nworkers 8
  tactsim sweep CASE --out STORE --scheduler tcp://HOST:8786

On SLURM, dask-jobqueue starts the workers. What was computed survives a kill at any moment:
the same command with --resume goes on, after it has verified every sample that is there;
damaged ones are computed again. A worker that dies costs its samples one try; after
three they are marked failed, with the reason. If a sample failed the exit code is 3.
"""
EXAMPLES = """\
examples:
  tactsim sweep sweep_closed_form --out fast.zarr
  tactsim sweep sweep_lumps --out lumps.zarr --samples 200 --workers 2
  tactsim sweep sweep_lumps --out lumps.zarr --resume
"""
PROGRESS_SECONDS = 5.0
"""Between lines of progress."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("case", metavar="CASE", type=Path, help="sweep file (YAML), or the name of a shipped sweep")
    parser.add_argument("--out", metavar="STORE", type=Path, required=True, help="folder of the data set, such as lumps.zarr")
    parser.add_argument("--samples", metavar="N", type=int, help="number of samples (default: that of the file)")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--workers", metavar="N", type=int, help="processes of this machine (default: one per core, if it pays)")
    place.add_argument("--scheduler", metavar="ADDRESS", help="address of a Dask scheduler, such as tcp://host:8786")
    parser.add_argument("--resume", action="store_true", help="go on with the data set in --out")
    parser.add_argument(
        "--accept-changed-code", action="store_true", help="resume by another version of tactsim; its samples are marked"
    )
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="set path.to.key; may be repeated")
    loudness = parser.add_mutually_exclusive_group()
    loudness.add_argument("--quiet", action="store_true", help="write no progress and no summary, only errors")
    loudness.add_argument("--progress", action="store_true", help="report progress even where nobody watches")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    TactsimError
        Whatever ends the command with an exit code of its own, such as options that do not go together.
    """
    from tactsim.dataset.running.resuming import opened_run
    from tactsim.dataset.running.whole import card, compute, finish
    from tactsim.dataset.sampling.sweep import load_sweep

    for name in ("samples", "workers"):
        given = getattr(arguments, name)
        if given is not None and given < 1:
            raise InputError(f"--{name} {given} is out of range; must be at least 1")
    with interruptible() as interruption:
        sweep = load_sweep(arguments.case, tuple(arguments.set), arguments.samples, option="--set")
        _check_inputs(sweep)
        executor = _executor(sweep, arguments)  # before anything is written: a scheduler may not answer
        changes = {"resume": arguments.resume, "accept_changes": arguments.accept_changed_code}
        with closing(executor), opened_run(sweep, arguments.out, **changes) as going:
            _warn(card(going))
            stopped = compute(going, executor, _progress(arguments))
            with interruption.deferred():
                _warn(finish(going))
                return _finish(going, arguments, stopped or interruption.requested)


def _warn(troubles: Iterable[str]) -> None:
    for trouble in troubles:
        console.note(f"warning: {trouble}")


def _check_inputs(sweep: Sweep) -> None:
    """Looks for the files that the sweep names, by its first possible case, before anything is computed."""
    from tactsim.case.inputs import check_inputs
    from tactsim.dataset.sampling.layout import first_case

    for line in check_inputs(first_case(sweep), sweep.document, sweep.where):
        console.note(f"warning: {line}")


def _executor(sweep: Sweep, arguments: argparse.Namespace) -> Executor:
    if arguments.scheduler:
        from tactsim.dataset.running.executors import Cluster

        return Cluster(sweep.text, arguments.scheduler, folder=sweep.folder)
    from tactsim.dataset.running.executors import LocalWorkers

    return LocalWorkers.of(sweep, arguments.workers)


def _progress(arguments: argparse.Namespace) -> Callable[[Tally], None]:
    if arguments.quiet or not (arguments.progress or console.notes_are_watched()):
        return lambda tally: None
    last = -PROGRESS_SECONDS

    def report(tally: Tally) -> None:
        nonlocal last
        if time.monotonic() - last >= PROGRESS_SECONDS:
            console.note(tally.line())
            last = time.monotonic()

    return report


def _finish(going: SweepRun, arguments: argparse.Namespace, stopped: bool) -> int:
    from tactsim.dataset.store.arrays import FAILED
    from tactsim.dataset.use.card import absent_lines

    failed = int((going.store.read("status") == FAILED).sum())
    if not arguments.quiet:
        for line in going.tally.summary():
            console.out(line)
        if left := len(going.store.pending()):
            console.out(f"{left} samples are left; go on with: {_resuming(arguments)}")
        else:
            for line in absent_lines(going.store, going.sweep):
                console.note(line)
        console.out(f"data set {arguments.out}; check it with: {console.command('data', 'check', arguments.out)}")
    if stopped:
        return INTERRUPTED
    return ConvergenceError.exit_code if failed else 0


def _resuming(arguments: argparse.Namespace) -> str:
    """The command that goes on with the data set: with the samples and keys that make it the same sweep."""
    samples = () if arguments.samples is None else ("--samples", arguments.samples)
    changes = [word for change in arguments.set for word in ("--set", change)]
    return console.command("sweep", arguments.case, *samples, *changes, "--out", arguments.out, "--resume")
