"""``scripts/campaign``: random cases until the time is up, then damage to every file, kills, full disks and two writers."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from campaign.random_cases import FEW_TRIALS, all_kinds
from campaign.trials import OUTCOMES, Ended, Trial, as_line, tried

FAULTS = Path(__file__).parents[1] / "faults"
INPUTS_PER_MINUTE = 1500
"""Random inputs of the readers that a core tries in a minute."""


def main() -> int:
    """Exit code: 0 if nothing is wrong and nothing hangs."""
    arguments = _arguments()
    shutil.rmtree(arguments.out, ignore_errors=True)
    arguments.out.mkdir(parents=True)
    until = time.monotonic() + 60 * arguments.minutes if arguments.minutes else None
    ended = _random_cases(arguments, until)
    text = table_text(ended)
    (arguments.out / "table.md").write_text(text, encoding="utf-8")
    sys.stdout.write(text)
    broken = 0 if arguments.no_faults else _damage(arguments)
    return 1 if broken or any(one.outcome in ("wrong", "hung") for one in ended) else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/campaign", description=__doc__)
    parser.add_argument("kinds", metavar="KIND", nargs="*", help="kinds of cases; all by default")
    parser.add_argument("--seed", type=int, default=1, help="case k of a seed is the same everywhere; default: %(default)s")
    parser.add_argument("--cases", type=int, help="cases of each kind; by default as many as the time allows")
    parser.add_argument("--minutes", type=float, help="time for the random cases; with neither, 10 minutes")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds that a case may take; default: %(default)s")
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)), help="processes; default: one a core")
    parser.add_argument("--out", type=Path, default=Path("results", "campaign"), help="default: %(default)s")
    parser.add_argument("--no-faults", action="store_true", help="random cases only, no damage to files and no kills")
    arguments = parser.parse_args()
    if arguments.cases is None and arguments.minutes is None:
        arguments.minutes = 10.0
    return arguments


def _random_cases(arguments: argparse.Namespace, until: float | None) -> list[Ended]:
    """Trials of every kind by turns; what converged is removed, everything else is kept with its case."""
    ended: list[Ended] = []
    record = arguments.out / "trials.jsonl"
    with ThreadPoolExecutor(arguments.workers) as pool, record.open("w", encoding="utf-8") as lines:
        waiting: dict[Future[Ended], Trial] = {}
        for trial in _trials(arguments):
            if until is not None and time.monotonic() > until:
                break
            waiting[pool.submit(tried, trial, arguments.out / "cases")] = trial
            while len(waiting) >= arguments.workers + 1:
                for done in [future for future in waiting if future.done()]:
                    del waiting[done]
                    _noted(done.result(), ended, arguments.out, lines)
                time.sleep(0.05)
        for future in waiting:
            _noted(future.result(), ended, arguments.out, lines)
    return ended


def _trials(arguments: argparse.Namespace):
    names = arguments.kinds or all_kinds()
    number = 0
    while arguments.cases is None or number < arguments.cases:
        for kind in names:
            if number * FEW_TRIALS.get(kind, 1.0) % 1.0 < FEW_TRIALS.get(kind, 1.0) or arguments.kinds:
                yield Trial(kind, arguments.seed, number, arguments.limit)
        number += 1


def _noted(one: Ended, ended: list[Ended], out: Path, lines) -> None:
    ended.append(one)
    lines.write(as_line(one) + "\n")
    lines.flush()
    place = out / "cases" / f"{one.kind}_{one.number}"
    if one.outcome in ("converged", "no threshold"):
        shutil.rmtree(place)
    elif (place / "result").exists():
        shutil.rmtree(place / "result")
    sys.stderr.write(f"{len(ended)}  {one.kind} {one.number}: {one.outcome}, {one.seconds:.1f} s\n")


def table_text(ended: list[Ended]) -> str:
    """Markdown: kinds and how many of their cases ended in which way."""
    counts = Counter((one.kind, one.outcome) for one in ended)
    lines = [
        "| kind | cases | " + " | ".join(OUTCOMES) + " | answered of those not refused |",
        "|---" * (len(OUTCOMES) + 3) + "|",
    ]
    for kind in sorted({one.kind for one in ended}):
        numbers = [counts[kind, outcome] for outcome in OUTCOMES]
        tried_in_earnest = sum(numbers) - counts[kind, "refused"]
        answered = counts[kind, "converged"] + counts[kind, "no threshold"]
        share = f"{answered / tried_in_earnest:.1%}" if tried_in_earnest else "-"
        lines.append(f"| {kind} | {sum(numbers)} | " + " | ".join(map(str, numbers)) + f" | {share} |")
    return "\n".join(lines) + "\n"


def _damage(arguments: argparse.Namespace) -> int:
    """The tests of the faults with as many random inputs as the time allows: files, stores, kills, full disks, two writers."""
    inputs = str(round(INPUTS_PER_MINUTE * (arguments.minutes or 10.0)))
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "slow or not slow", str(FAULTS)]
    return subprocess.run(command, env={**os.environ, "TACTSIM_FUZZ": inputs}, check=False).returncode


def read_record(path: Path) -> list[Ended]:
    """Trials of an earlier campaign."""
    return [Ended(**json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines()]


if __name__ == "__main__":
    sys.exit(main())
