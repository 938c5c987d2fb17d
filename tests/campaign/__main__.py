"""``scripts/campaign``: random cases until the time is up, then damage to every file, kills, full disks and two writers."""

from __future__ import annotations

import argparse
import gc
import itertools
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from campaign.families import FEW_TRIALS, all_families
from campaign.record import ANSWERS, as_line, first_runs, last_runs, read_record
from campaign.report import page, table_text
from campaign.trials import PATIENCE, Ended, Running, Trial, tried

FAULTS = Path(__file__).parents[1] / "faults"
INPUTS_PER_MINUTE = 1500
"""Random inputs of the readers that a core tries in a minute."""
WARMING = (Trial("indentation", 3, 3, 60.0), Trial("grasp", 3, 1, 60.0))
"""Short cases that load what most others need."""


def main() -> int:
    """Exit code: 0 if nothing is wrong and nothing hangs."""
    arguments = _arguments()
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))  # so that no child outlives this process
    if arguments.fresh:
        shutil.rmtree(arguments.out, ignore_errors=True)
    arguments.out.mkdir(parents=True, exist_ok=True)
    record = read_record(arguments.out / "trials.jsonl")
    if others := sorted({one.seed for one in record} - {arguments.seed}):
        sys.exit(f"{arguments.out} holds a campaign of the seed {others[0]}; take another --out, or --fresh to begin anew")
    if arguments.minutes != 0:
        with tempfile.TemporaryDirectory() as place:
            _warm(Path(place))
        _random_cases(arguments, record)
    text = table_text(first_runs(record))
    (arguments.out / "table.md").write_text(text, encoding="utf-8")
    sys.stdout.write(text)
    if arguments.report:
        arguments.report.write_text(_page(arguments, record), encoding="utf-8")
    broken = 0 if arguments.no_faults else _damage(arguments)
    return 1 if broken or any(one.outcome in ("wrong", "hung") for one in last_runs(record).values()) else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/campaign", description=__doc__)
    parser.add_argument("kinds", metavar="KIND", nargs="*", help="kinds of cases, and harder families of some; all by default")
    parser.add_argument("--seed", type=int, default=1, help="case k of a seed is the same everywhere; default: %(default)s")
    parser.add_argument("--cases", type=int, help="cases of each kind; by default as many as the time allows")
    parser.add_argument("--minutes", type=float, help="time for the random cases, 0 for none; with neither, 10 minutes")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds that a case may take; default: %(default)s")
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)), help="processes; default: one a core")
    parser.add_argument("--out", type=Path, default=Path("results", "campaign"), help="what stands there is gone on with")
    parser.add_argument("--fresh", action="store_true", help="forget what stands in --out")
    parser.add_argument("--again", action="store_true", help="only run again what was not answered")
    parser.add_argument("--report", type=Path, metavar="FILE", help="write a page of what the campaign says")
    parser.add_argument("--no-faults", action="store_true", help="random cases only, no damage to files and no kills")
    arguments = parser.parse_args()
    if arguments.cases is None and arguments.minutes is None:
        arguments.minutes = 10.0
    return arguments


def _page(arguments: argparse.Namespace, record: list[Ended]) -> str:
    return page(record, asked=arguments.cases, limit=arguments.limit, patience=PATIENCE)


def _warm(place: Path) -> None:
    """Run a grasp and an indentation in this process, so that children are forked with all modules and compiled loops."""
    from tactsim.cli import main as command

    for trial in WARMING:
        tried(trial, place)  # writes the case, and compiles the loops into the cache
        case = place / f"{trial.kind}_{trial.number}"
        command(["run", str(case / "case.yaml"), "--out", str(case / "warm"), "--figures", "none", "--quiet"])
    import numba

    if numba.threading_layer() == "omp":
        sys.exit("the threads of OpenMP do not survive a fork; set NUMBA_THREADING_LAYER=workqueue, as scripts/campaign does")
    gc.collect()
    gc.freeze()  # a collection in a child would copy every page


def _random_cases(arguments: argparse.Namespace, record: list[Ended]) -> None:
    """Trials of every kind by turns, added to the record; what was answered is removed, everything else stays with its case."""
    until = time.monotonic() + 60 * arguments.minutes if arguments.minutes is not None else float("inf")
    trials = _again(arguments, record) if arguments.again else _trials(arguments, record)
    running: list[Running] = []
    with (arguments.out / "trials.jsonl").open("a", encoding="utf-8") as lines:
        try:
            for trial in itertools.takewhile(lambda _: time.monotonic() < until, trials):
                running.append(Running(trial, arguments.out / "cases"))
                while len(running) >= arguments.workers:
                    running = _waited(running, record, lines)
            while running:
                running = _waited(running, record, lines)
        finally:
            for one in running:
                one.kill()


def _trials(arguments: argparse.Namespace, record: list[Ended]) -> Iterator[Trial]:
    """Those that the record does not hold yet."""
    done = set(last_runs(record))
    for number in itertools.count() if arguments.cases is None else range(arguments.cases):
        for kind in arguments.kinds or all_families():
            part = 1.0 if arguments.kinds else FEW_TRIALS.get(kind, 1.0)
            if (part == 1.0 or number * part % 1.0 < part) and (kind, number) not in done:
                yield Trial(kind, arguments.seed, number, arguments.limit)


def _again(arguments: argparse.Namespace, record: list[Ended]) -> Iterator[Trial]:
    """Those whose last run was no answer."""
    for (kind, number), one in last_runs(record).items():
        if one.outcome not in ANSWERS and (not arguments.kinds or kind in arguments.kinds):
            yield Trial(kind, arguments.seed, number, arguments.limit)


def _waited(running: list[Running], record: list[Ended], lines) -> list[Running]:
    """Waits a moment and notes what has ended; those that run still."""
    time.sleep(0.02)
    still = []
    for one in running:
        if (ended := one.ended()) is None:
            still.append(one)
            continue
        record.append(ended)
        lines.write(as_line(ended))
        lines.flush()
        shutil.rmtree(one.place if ended.outcome in ANSWERS else one.place / "result", ignore_errors=True)
        sys.stderr.write(f"{len(record)}  {ended.kind} {ended.number}: {ended.outcome}, {ended.seconds:.1f} s\n")
    return still


def _damage(arguments: argparse.Namespace) -> int:
    """The tests of the faults with as many random inputs as the time allows: files, stores, kills, full disks, two writers."""
    inputs = str(round(INPUTS_PER_MINUTE * (arguments.minutes or 10.0)))
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "slow or not slow", str(FAULTS)]
    return subprocess.run(command, env={**os.environ, "TACTSIM_FUZZ": inputs}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
