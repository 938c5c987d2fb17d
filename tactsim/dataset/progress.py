"""How far a sweep is: counts, rate, time left, failures by reason."""

from __future__ import annotations

import re
import time
from collections import Counter
from dataclasses import dataclass, field

from tactsim.outside.text import one_line


@dataclass
class Tally:
    """Counts of a sweep that goes on; ``before`` samples were computed by an earlier one."""

    samples: int
    before: int = 0
    done: int = 0
    failed: int = 0
    reasons: Counter[str] = field(default_factory=Counter)
    begin: float = field(default_factory=time.monotonic)
    damaged: dict[str, int] = field(default_factory=dict)
    """Why samples of an earlier sweep are computed again -> how many; a sample may have several reasons."""
    again: int = 0
    """How many samples these are in all."""

    def add(self, done: int, reasons: list[str]) -> None:
        """Counts new samples: those that are done, and the reasons of those that failed."""
        self.done += done
        self.failed += len(reasons)
        self.reasons.update(kind_of(reason) for reason in reasons)

    @property
    def rate(self) -> float:
        """Samples per second of this sweep."""
        return (self.done + self.failed) / max(time.monotonic() - self.begin, 1e-9)

    def line(self) -> str:
        """One line of progress."""
        now = self.before + self.done + self.failed
        left = (self.samples - now) / self.rate if self.done + self.failed else None
        told = f"{now} of {self.samples} samples, {self.failed} failed, {_per_time(self.rate)}"
        return told if left is None else f"{told}, {_duration(left)} left"

    def summary(self) -> list[str]:
        """Lines at the end: counts, rate, and failures by reason."""
        seconds = time.monotonic() - self.begin
        told = [f"{self.done} samples done, {self.failed} failed in {_duration(seconds)} ({_per_time(self.rate)})"]
        if self.before:
            told.append(f"{self.before} samples were there before")
        if self.damaged:
            told.append(f"{self.again} samples were there and damaged; they were marked pending, to be computed again:")
            told += [f"  {count} x {one_line(reason, 160)}" for reason, count in self.damaged.items()]
        return told + [f"  {count} x {one_line(reason)}" for reason, count in self.reasons.most_common(20)]


def kind_of(reason: str) -> str:
    """A reason without its numbers, so that equal faults count as one."""
    return re.sub(r"[-+]?\d+(\.\d+)?([eE][-+]?\d+)?", "#", reason)[:160]


def _per_time(rate: float) -> str:
    return f"{rate:.3g} samples/s" if rate >= 1 else f"{3600 * rate:.3g} samples/h"


def _duration(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
