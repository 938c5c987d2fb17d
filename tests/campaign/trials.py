"""One trial: a case as a command in a process forked from this one, and what may be said of how it ended."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from campaign.contradictions import contradictions
from campaign.families import random_case
from campaign.random_cases import Case
from tactsim.case.writing import yaml_text
from tactsim.code_identity import code_identity

OUTCOMES = ("converged", "no threshold", "refused", "failed with reason", "stopped by time", "wrong", "hung")
REASONS = {"took longer than": "stopped by time", "the threshold was not reached": "no threshold"}
"""Beginnings of reasons that say more than that a run failed; a threshold beyond the displacement is an answer."""
CODES = {0: "converged", 2: "refused", 3: "failed with reason"}
PATIENCE = 30.0
"""Seconds beyond its own limit after which a run counts as hung."""


@dataclass(frozen=True)
class Trial:
    """Which case, and for how long."""

    kind: str
    seed: int
    number: int
    seconds: float


@dataclass(frozen=True)
class Ended:
    """How a trial ended, after how many seconds by the clock and of the processor, and with which program."""

    kind: str
    seed: int
    number: int
    outcome: str
    reason: str
    seconds: float
    processor_seconds: float
    program: str


class Running:
    """A case that runs in a child of this process, which has loaded what the child needs; its memory goes with it."""

    def __init__(self, trial: Trial, folder: Path):
        self.trial, self.place = trial, folder / f"{trial.kind}_{trial.number}"
        shutil.rmtree(self.place, ignore_errors=True)
        self.place.mkdir(parents=True)
        case, document = self.place / "case.yaml", random_case(trial.kind, trial.seed, trial.number)
        case.write_text(yaml_text(document), encoding="utf-8")
        self._experiment: Case = document["experiment"]
        self._begun = time.monotonic()
        self._child = os.fork()
        if not self._child:
            _command(case.name, trial.seconds, self.place)

    def ended(self) -> Ended | None:
        """How it ended, the files in its folder judged; None as long as it runs. Past its limit and patience it is killed."""
        child, status, used = os.wait4(self._child, os.WNOHANG)
        seconds, limit = time.monotonic() - self._begun, self.trial.seconds + PATIENCE
        if not child and seconds <= limit:
            return None
        if child:
            self._child = 0  # its number may soon be that of another process
            outcome, reason = judged(os.waitstatus_to_exitcode(status), self.place, self._experiment)
        else:
            used = self.kill()
            outcome, reason = "hung", f"no end after {limit:g} s"
        processor = round(used.ru_utime + used.ru_stime, 2)
        trial = self.trial
        return Ended(trial.kind, trial.seed, trial.number, outcome, reason, round(seconds, 2), processor, code_identity())

    def kill(self):
        """Ends the child if it runs still; what it used."""
        if not self._child:
            return None
        os.kill(self._child, signal.SIGKILL)
        return os.wait4(self._child, 0)[2]


def tried(trial: Trial, folder: Path) -> Ended:
    """Runs a case to its end; its case file and its result stay in the folder."""
    running = Running(trial, folder)
    while (ended := running.ended()) is None:
        time.sleep(0.02)
    return ended


def _command(case: str, seconds: float, place: Path) -> None:
    """``tactsim run`` with its output in files; the life of a child, which ends here whatever happens."""
    code = 1
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        from tactsim.cli import main

        os.chdir(place)
        with open("stderr", "w", encoding="utf-8") as errors:
            os.dup2(errors.fileno(), 2)
            sys.stderr = errors
            arguments = ["run", case, "--out", "result", "--time-limit", f"{seconds:g} s", "--figures", "none", "--quiet"]
            code = main(arguments)
            errors.flush()
    finally:
        os._exit(code)


def judged(code: int, place: Path, experiment: Case | None = None) -> tuple[str, str]:
    """The outcome and its reason; wrong is what contradicts itself or the ``experiment`` of its case, however it ended."""
    words = (place / "stderr").read_text(encoding="utf-8", errors="replace").strip()
    if code not in CODES:
        return "wrong", f"exit code {code}: {words[-300:]}"
    if "Traceback" in words or "Warning:" in words:
        return "wrong", f"raw output: {words[-300:]}"
    if code == 2:
        return ("refused", words[-300:]) if words else ("wrong", "refused without a word")
    document = place / "result" / "result.json"
    if not document.exists():
        return ("failed with reason", words[-300:]) if code == 3 and words else ("wrong", "no result")
    result = json.loads(document.read_text(encoding="utf-8"))
    if (result["status"] == "converged") != (code == 0):
        return "wrong", f"exit code {code} with the status {result['status']}"
    if code == 0:
        faults = contradictions(result, experiment)
        return ("wrong", "; ".join(faults)) if faults else ("converged", result["reason"])
    named = (outcome for beginning, outcome in REASONS.items() if result["reason"].startswith(beginning))
    return next(named, CODES[code]), result["reason"]
