"""One trial: a case as a command in a process forked from this one, and what may be said of how it ended."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from campaign.random_cases import random_case
from tactsim.case.writing import yaml_text
from tactsim.code_identity import code_identity

OUTCOMES = ("converged", "no threshold", "refused", "failed with reason", "stopped by time", "wrong", "hung")
REASONS = {"took longer than": "stopped by time", "the threshold was not reached": "no threshold"}
"""Beginnings of reasons that say more than that a run failed; a threshold beyond the displacement is an answer."""
CODES = {0: "converged", 2: "refused", 3: "failed with reason"}
PATIENCE = 30.0
"""Seconds beyond its own limit after which a run counts as hung."""
BALANCE = 1e-6
"""Largest difference of a sum of forces from its parts over the larger: round-off of a hundred thousand terms."""
LEAST_VOLUME = 0.0
"""A volume ratio at or below it is a body turned inside out."""


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
        case = self.place / "case.yaml"
        case.write_text(yaml_text(random_case(trial.kind, trial.seed, trial.number)), encoding="utf-8")
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
            outcome, reason = judged(os.waitstatus_to_exitcode(status), self.place)
        else:
            used = self.kill()
            outcome, reason = "hung", f"no end after {limit:g} s"
        processor = round(used.ru_utime + used.ru_stime, 2)
        trial = self.trial
        return Ended(trial.kind, trial.seed, trial.number, outcome, reason, round(seconds, 2), processor, code_identity())

    def kill(self):
        """Ends the child; what it used."""
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


def judged(code: int, place: Path) -> tuple[str, str]:
    """The outcome and its reason; wrong is what contradicts itself, however it ended."""
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
        faults = contradictions({name: quantity["value"] for name, quantity in result["quantities"].items()})
        return ("wrong", "; ".join(faults)) if faults else ("converged", result["reason"])
    named = (outcome for beginning, outcome in REASONS.items() if result["reason"].startswith(beginning))
    return next(named, CODES[code]), result["reason"]


def contradictions(quantities: dict[str, Any]) -> list[str]:
    """What a converged result must not say: values that are not finite, forces out of balance, volumes turned inside out."""
    faults = [
        f"{name} is not finite" for name, value in quantities.items() if isinstance(value, float) and not math.isfinite(value)
    ]
    if "taxel_force_upper" in quantities and "reaction_force" in quantities:
        taxels = sum(sum(row) for row in quantities["taxel_force_upper"])
        parts = taxels + quantities["gap_force_upper"] + quantities["outside_force_upper"]
        whole = quantities["reaction_force"]
        if abs(parts - whole) > BALANCE * max(abs(parts), abs(whole)):
            faults.append(f"taxels, gaps and outside of the upper jaw are {parts:g} N, the reaction {whole:g} N")
    if quantities.get("min_volume_ratio", 1.0) <= LEAST_VOLUME:
        faults.append(f"a volume ratio of {quantities['min_volume_ratio']:g}")
    threshold = quantities.get("threshold_force")
    if isinstance(threshold, float) and threshold <= 0:
        faults.append("a threshold force that pulls")
    return faults
